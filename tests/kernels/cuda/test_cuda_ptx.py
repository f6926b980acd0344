"""The GPU's kernels as its compiler writes them: whole numbers alone, and one counter of runs."""

import json
import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest


def has(package):
    try:
        return bool(metadata.version(package))
    except metadata.PackageNotFoundError:
        return False


@pytest.mark.skipif(
    not (has("numba-cuda") and has("nvidia-nvvm")),
    reason="the compiler of PTX is not installed: pip install 'gapath[cuda]', 530 MB",
)
@pytest.mark.parametrize("capability", [(8, 0), (9, 0)])
def test_kernels_decide_without_floats_and_count_runs_alone(capability):
    script = Path(__file__).with_name("assembling.py")
    command = [sys.executable, script, *map(str, capability)]
    around = {name: value for name, value in os.environ.items() if name != "NUMBA_DISABLE_JIT"}
    done = subprocess.run(command, capture_output=True, text=True, env=around)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert [*found] == ["True", "False"]
    for shared, counts in found.items():
        assert counts["target"] == "sm_{}{}".format(*capability)
        assert (counts["floats"], counts["calls"]) == (0, 0)
        assert counts["atomics"] == 2  # a thread's first run, and its next one
        assert (counts["shared"] > 0) is (shared == "True")
