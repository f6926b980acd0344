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
CALLS = """
import sys
from importlib import import_module
for argument in {}:
    outer = import_module("{}planner").outer
    print(outer(argument), len(outer.stats.cache_hits))
    del sys.modules["{}planner"], sys.modules["{}helpers"]
"""


def call(folder, prefix="", arguments=(1,), before=None, stderr=subprocess.PIPE):
    """Call `outer` in a process of its own, each time read anew from the files.

    Gives its results, each with how many caches served it.
    """
    # Python takes a file of the same second and size for the same.
    own = {"NUMBA_CACHE_DIR": str(folder / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    process = subprocess.run(
        [sys.executable, "-c", CALLS.format(arguments, prefix, prefix, prefix)],
        env=os.environ | own,
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=stderr,
        text=True,
        preexec_fn=before,
    )
    return (
        [line.split() for line in process.stdout.splitlines()]
        or process.stderr
        or process.returncode
    )


def write_kernels(folder, prefix=""):
    (folder / "planner.py").write_text(OUTER.format(f"{prefix}helpers"))
    (folder / "helpers.py").write_text(HELPER.format(1))
    return folder


@pytest.fixture
def kernels(tmp_path):
    return write_kernels(tmp_path)


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """Kernels that were compiled once, and are whole again after each test."""
    folder = write_kernels(tmp_path_factory.mktemp("kept"))
    assert call(folder) == [["4", "0"]]
    return folder


def test_who_waits_at_a_terminal_is_told_once(kernels):
    for kept in (0, 1):
        ours, terminal = os.openpty()
        try:
            assert call(kernels, stderr=terminal) == [["4", str(kept)]]
            os.write(terminal, b"end\n")  # or there would be nothing to read
            text = b""
            while not text.endswith(b"end\r\n"):
                text += os.read(ours, 4096)
        finally:
            os.close(ours)
            os.close(terminal)
        line = b"gapath: compiling kernels, up to a minute; they are kept for the next time\r\n"
        assert text == (b"" if kept else b"\r\x1b[K" + line) + b"end\r\n"


@pytest.mark.parametrize("package", ["", "plugin"])
def test_an_edited_helper_of_a_plug_in_is_noticed(tmp_path, package):
    folder, prefix = tmp_path / package, f"{package}." if package else ""
    folder.mkdir(exist_ok=True)
    write_kernels(folder, prefix)
    assert call(tmp_path, prefix, (1, 1)) == [["4", "0"], ["4", "1"]]
    (folder / "helpers.py").write_text(HELPER.format(2))
    assert call(tmp_path, prefix) == [["6", "0"]]


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
def test_a_damaged_file_is_compiled_and_written_again(kept, ending, damage):
    files = list((kept / "cache").rglob(f"*.{ending}"))
    assert files
    for file in files:
        file.write_bytes(damage(file.read_bytes()))
    assert call(kept, arguments=(1, 1)) == [["4", "0"], ["4", "1"]]


def test_a_lost_index_gives_no_signature_the_code_of_another(kernels):
    assert call(kernels, arguments=(1.5,)) == [["5.0", "0"]]
    (code,) = (kernels / "cache").rglob("planner.outer*.nbc")
    before = code.read_bytes()
    for index in (kernels / "cache").rglob("*.nbi"):
        index.unlink()
    assert call(kernels) == [["4", "0"]]
    code.write_bytes(before)  # as if the disk had been full after the index was written
    assert call(kernels) == [["4", "0"]]


def test_a_cache_that_cannot_be_written_is_no_error(kernels):
    def full():
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))

    assert call(kernels, arguments=(1, 1), before=full) == [["4", "0"]] * 2
    assert not [path for path in (kernels / "cache").rglob("*") if path.is_file()]
    (kernels / "cache").rename(kernels / "old")
    (kernels / "cache").write_text("no folder")
    assert call(kernels, arguments=(1, 1)) == [["4", "0"]] * 2
