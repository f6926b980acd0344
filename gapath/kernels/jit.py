"""The only import of numba: the `kernel` decorator, its cache folder, and what vectors need.

numba's own cache does not notice that a function called from another file was edited,
so the folder is keyed by a hash of every file that holds kernels: gapath's own, and those of the
package that a function belongs to. Where no folder can be written, kernels are compiled anew in
each process instead of failing at import.
"""

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterable
from functools import cache, partial
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, overload

import numba
from numba import extending
from numba import types as types

P = ParamSpec("P")
R = TypeVar("R")

_OWN = __name__.partition(".")[0]


def _package_sources(package: str) -> Iterable[Path]:
    """Find the files of a package, or of a module that is in none and of those beside it."""
    if package == _OWN:  # what else is in gapath calls kernels, but is none
        return Path(__file__).parent.rglob("*.py")
    module = sys.modules.get(package)
    folders = [Path(folder) for folder in getattr(module, "__path__", ())]
    if folders:
        return (path for folder in folders for path in folder.rglob("*.py"))
    file = getattr(module, "__file__", None)
    return Path(file).parent.glob("*.py") if file else []  # a notebook has no file


def cache_root() -> Path:
    """Give the folder of all caches of kernels; raises RuntimeError without a home directory."""
    if "NUMBA_CACHE_DIR" in os.environ:
        return Path(os.environ["NUMBA_CACHE_DIR"])
    user = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(user) / "gapath" / "kernels"


@cache
def _cache_folder(package: str) -> str | None:
    """Return the folder for a package's compiled kernels, or None where none can be written."""
    try:
        sources = [sorted(_package_sources(name)) for name in sorted({_OWN, package})]
        key = hashlib.sha256(b"\0".join(path.read_bytes() for part in sources for path in part))
        folder = cache_root() / key.hexdigest()[:16]
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return str(folder)
    except (OSError, RuntimeError):  # RuntimeError: no home directory
        return None


JIT: bool = not numba.config.DISABLE_JIT  # type: ignore[attr-defined]
"""Whether kernels are compiled; `intrinsic` gives nothing that Python could run."""

# A division by zero is nobody's way of control: without its test more loops become vectors.
# Nothing in a kernel touches Python's objects, so other threads may run beside it. Nobody calls
# kernels from C: without an entry for that they take about a tenth less time to compile.
_OPTIONS = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}


@overload
def kernel(function: Callable[P, R], /) -> Callable[P, R]: ...
@overload
def kernel(*, inner: bool) -> Callable[[Callable[P, R]], Callable[P, R]]: ...
def kernel(function: Callable[..., Any] | None = None, /, *, inner: bool = False) -> Any:
    """Compile a free function on arrays and NamedTuples to machine code.

    To be written ``@kernel`` or ``@kernel(inner=True)``. Never `fastmath`: it changed results in
    nine of seventeen environments.

    Parameters
    ----------
    function : callable
        A function that only numba's nopython mode needs to understand.
    inner : bool
        Only kernels call it: without an entry for Python it takes less time to compile.

    Returns
    -------
    callable
        The compiled function, with the same signature.
    """
    if function is None:
        return partial(kernel, inner=inner)
    options = _OPTIONS | {"no_cpython_wrapper": inner}
    module = function.__globals__.get("__package__") or function.__module__  # python -m: __main__
    folder = _cache_folder(module.partition(".")[0])
    if folder is None:
        return numba.njit(function, **options)
    # numba reads CACHE_DIR while it decorates; other people's kernels keep their own.
    before = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    numba.config.CACHE_DIR = folder  # type: ignore[attr-defined]
    try:
        return numba.njit(function, cache=True, **options)
    finally:
        numba.config.CACHE_DIR = before  # type: ignore[attr-defined]


def intrinsic(function: Callable[..., Any]) -> Callable[..., Any]:
    """Make a function of kernels out of one that gives its signature and its LLVM code."""
    return extending.intrinsic(function)  # type: ignore[no-any-return]
