"""Compiled kernels are kept, but never beyond an edit of what they call, nor damaged."""

import os
import resource
import subprocess
import sys

import pytest

from gapath.kernels.jit import JIT

pytestmark = pytest.mark.skipif(not JIT, reason="nothing is kept without the compiler")

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
CALL = "from {} import outer; print(outer({}), len(outer.stats.cache_hits))"


def call(folder, prefix="", argument=1, before=None):
    """Call `outer` in a process of its own; give its result and how many caches served it."""
    process = subprocess.run(
        [sys.executable, "-c", CALL.format(f"{prefix}planner", argument)],
        env=os.environ | {"NUMBA_CACHE_DIR": str(folder / "cache")},
        cwd=folder,
        capture_output=True,
        text=True,
        preexec_fn=before,
    )
    return process.stdout.split() or process.stderr or process.returncode


@pytest.fixture
def kernels(tmp_path):
    (tmp_path / "planner.py").write_text(OUTER.format("helpers"))
    (tmp_path / "helpers.py").write_text(HELPER.format(1))
    return tmp_path


@pytest.mark.parametrize("package", ["", "plugin"])
def test_an_edited_helper_of_a_plug_in_is_noticed(tmp_path, package):
    folder, prefix = tmp_path / package, f"{package}." if package else ""
    folder.mkdir(exist_ok=True)
    (folder / "planner.py").write_text(OUTER.format(f"{prefix}helpers"))
    (folder / "helpers.py").write_text(HELPER.format(1))
    assert [call(tmp_path, prefix), call(tmp_path, prefix)] == [["4", "0"], ["4", "1"]]
    (folder / "helpers.py").write_text(HELPER.format(2))
    assert call(tmp_path, prefix) == ["6", "0"]


def flipped(content):
    """Change a bit in each of a thousand places: in the pickle, and in the machine code in it."""
    changed = bytearray(content)
    for place in range(len(content) % 997, len(content), max(1, len(content) // 1000)):
        changed[place] ^= 1 << place % 8
    return bytes(changed)


@pytest.mark.parametrize(
    ("ending", "damage"),
    [
        ("nb?", lambda _: b""),
        ("nbi", lambda content: content[:-9]),
        ("nbc", lambda content: content[:-9]),
        ("nbi", flipped),
        ("nbc", flipped),
    ],
)
def test_a_damaged_file_is_compiled_and_written_again(kernels, ending, damage):
    assert call(kernels) == ["4", "0"]
    files = list((kernels / "cache").rglob(f"*.{ending}"))
    assert files
    for file in files:
        file.write_bytes(damage(file.read_bytes()))
    assert [call(kernels), call(kernels)] == [["4", "0"], ["4", "1"]]


def test_a_lost_index_gives_no_signature_the_code_of_another(kernels):
    assert call(kernels, argument=1.5) == ["5.0", "0"]
    (code,) = (kernels / "cache").rglob("planner.outer*.nbc")
    before = code.read_bytes()
    for index in (kernels / "cache").rglob("*.nbi"):
        index.unlink()
    assert call(kernels, argument=1) == ["4", "0"]
    code.write_bytes(before)  # as if the disk had been full after the index was written
    assert call(kernels, argument=1) == ["4", "0"]


def test_a_cache_that_cannot_be_written_is_no_error(kernels):
    def full():
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))

    assert [call(kernels, before=full)] * 2 == [["4", "0"]] * 2
    assert not [path for path in (kernels / "cache").rglob("*") if path.is_file()]
    (kernels / "cache").rename(kernels / "old")
    (kernels / "cache").write_text("no folder")
    assert [call(kernels)] * 2 == [["4", "0"]] * 2
