"""numba-cuda's simulator: it is chosen before anything is imported, so in a process of its own."""

import os
import subprocess
import sys
from importlib.util import find_spec

import pytest

SIMULATED = {"NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1", "PYTHONWARNINGS": "ignore"}

needs_numba_cuda = pytest.mark.skipif(
    find_spec("numba_cuda") is None, reason="numba-cuda is not installed (requirements.lock has it)"
)


def simulate(*words, **how):
    """Run Python with some words in the simulator."""
    return subprocess.run(
        [sys.executable, *words], capture_output=True, text=True, env=os.environ | SIMULATED, **how
    )
