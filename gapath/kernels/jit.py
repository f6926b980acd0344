"""The only import of numba: the `kernel` decorator, its cache folder, and what vectors need.

numba's own cache does not notice that a function called from another file was edited,
so the folder is keyed by a hash of every file that holds kernels. Where no folder can
be written, kernels are compiled anew in each process instead of failing at import.
"""

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numba
from numba import extending
from numba import types as types

P = ParamSpec("P")
R = TypeVar("R")


def _kernel_sources() -> list[Path]:
    return sorted(Path(__file__).parent.rglob("*.py"))


def _user_cache() -> Path:
    if "XDG_CACHE_HOME" in os.environ:
        return Path(os.environ["XDG_CACHE_HOME"])
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", tempfile.gettempdir()))
    return Path.home() / ".cache"


def _cache_folder() -> str | None:
    """Return the folder for compiled kernels, or None where none can be written."""
    key = hashlib.sha256(b"\0".join(path.read_bytes() for path in _kernel_sources()))
    try:
        root = os.environ.get("NUMBA_CACHE_DIR") or _user_cache() / "gapath" / "kernels"
        folder = Path(root) / key.hexdigest()[:16]
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return str(folder)
    except (OSError, RuntimeError):  # RuntimeError: no home directory
        return None


_FOLDER = _cache_folder()

JIT: bool = not numba.config.DISABLE_JIT  # type: ignore[attr-defined]
"""Whether kernels are compiled; `intrinsic` gives nothing that Python could run."""

# A division by zero is nobody's way of control: without its test more loops become vectors.
# Nothing in a kernel touches Python's objects, so other threads may run beside it. Nobody calls
# kernels from C: without an entry for that they take about a tenth less time to compile.
_OPTIONS = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a free function on arrays and NamedTuples to machine code.

    Only kernels can call one whose name begins with an underscore: without an entry for Python
    it takes less time to compile. Never `fastmath`: it changed results in nine of seventeen
    environments.

    Parameters
    ----------
    function : callable
        A function that only numba's nopython mode needs to understand.

    Returns
    -------
    callable
        The compiled function, with the same signature.
    """
    options = _OPTIONS | {"no_cpython_wrapper": function.__name__.startswith("_")}
    if _FOLDER is None:
        return numba.njit(function, **options)  # type: ignore[no-any-return]
    # numba reads CACHE_DIR while it decorates; other people's kernels keep their own.
    before = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    numba.config.CACHE_DIR = _FOLDER  # type: ignore[attr-defined]
    try:
        return numba.njit(function, cache=True, **options)  # type: ignore[no-any-return]
    finally:
        numba.config.CACHE_DIR = before  # type: ignore[attr-defined]


def intrinsic(function: Callable[..., Any]) -> Callable[..., Any]:
    """Make a function of kernels out of one that gives its signature and its LLVM code."""
    return extending.intrinsic(function)  # type: ignore[no-any-return]
