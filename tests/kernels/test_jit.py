"""Compiled kernels are kept, but never beyond an edit of what they call."""

import os
import subprocess
import sys

import pytest

from gapath.kernels.jit import JIT

HELPER = "from gapath.kernels.jit import kernel\n@kernel\ndef helper(x):\n    return x + {}\n"
OUTER = """
from gapath.kernels.jit import kernel
from {} import helper

@kernel(inner=True)
def twice(x):
    return 2 * x

@kernel
def outer(x):
    return twice(helper(x))
"""
CALL = "from {} import outer; print(outer(1), len(outer.stats.cache_hits))"


@pytest.mark.skipif(not JIT, reason="nothing is kept without the compiler")
@pytest.mark.parametrize("package", ["", "plugin"])
def test_an_edited_helper_of_a_plug_in_is_noticed(tmp_path, package):
    def call():
        process = subprocess.run(
            [sys.executable, "-c", CALL.format(f"{prefix}planner")],
            env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")},
            cwd=tmp_path,
            capture_output=True,
            text=True,
        )
        return process.stdout.split() or process.stderr

    folder, prefix = tmp_path / package, f"{package}." if package else ""
    folder.mkdir(exist_ok=True)
    (folder / "planner.py").write_text(OUTER.format(f"{prefix}helpers"))
    (folder / "helpers.py").write_text(HELPER.format(1))
    assert [call(), call()] == [["4", "0"], ["4", "1"]]
    (folder / "helpers.py").write_text(HELPER.format(2))
    assert call() == ["6", "0"]
