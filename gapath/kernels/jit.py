"""The only import of numba: the `kernel` decorator, its cache, and what vectors need.

numba's own cache does not notice that a function called from another file was edited,
so the folder is keyed by a hash of every file that holds kernels: gapath's own, and those of the
package that a function belongs to. Nor does it notice a damaged file, whose machine code would end
the process: here a hash stands behind each file, and one that does not fit counts as none. What
cannot be written, to a full disk for example, is compiled anew in each process.
"""

import hashlib
import io
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, partial
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, overload

import numba
from numba import extending
from numba import types as types
from numba.core import caching

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


def _package_of(function: Callable[..., Any]) -> str:
    module = function.__globals__.get("__package__") or function.__module__  # python -m: __main__
    return str(module.partition(".")[0])


@cache
def _cache_folder(package: str) -> Path | None:
    """Return the folder for a package's compiled kernels, or None where there can be none."""
    try:
        sources = [sorted(_package_sources(name)) for name in sorted({_OWN, package})]
        key = hashlib.sha256(b"\0".join(path.read_bytes() for part in sources for path in part))
        return cache_root() / key.hexdigest()[:16]
    except (OSError, RuntimeError):  # RuntimeError: no home directory
        return None


class _Files(caching.IndexDataCacheFile):  # type: ignore[misc]
    """A function's files, as numba has them: an index, and one with the code for each signature.

    Behind each stands the SHA-256 of it and of numba's version: numba reads none that does not
    fit. The one with code says what signature it is for: an index that was lost is begun anew, and
    until its first file is replaced that would be another's code.
    """

    def load(self, key: object) -> Any:
        """Give what was saved for a key; None if there is nothing, or nothing whole."""
        of, data = super().load(key) or (None, None)
        return data if of == key else None

    def save(self, key: object, data: object) -> None:
        """Save it; raises OSError if it cannot be written."""
        super().save(key, (key, data))

    def _load_index(self) -> Any:
        return super()._load_index() if _is_whole(self._index_path) else {}

    def _load_data(self, name: str) -> Any:
        path = self._data_path(name)
        return super()._load_data(name) if _is_whole(path) else None

    @contextmanager
    def _open_for_write(self, path: str) -> Iterator[io.BytesIO]:
        with super()._open_for_write(path) as file:
            content = io.BytesIO()
            yield content
            file.write(content.getvalue() + _seal(content.getvalue()))


def _is_whole(path: str) -> bool:
    try:
        content = Path(path).read_bytes()
    except OSError:
        return False
    return content[-_SEAL:] == _seal(content[:-_SEAL])


def _seal(content: bytes) -> bytes:
    return hashlib.sha256(numba.__version__.encode() + content).digest()


_SEAL = hashlib.sha256().digest_size


class _Place(caching.UserProvidedCacheLocator):  # type: ignore[misc]
    """Where a function's files are: a folder that is made when something is saved."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        super().__init__(function, file)
        folder = _cache_folder(_package_of(function))
        self._cache_path = str(folder / self.get_suitable_cache_subpath(file)) if folder else ""

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> "_Place | None":
        """Give the place; None if there can be none, or if the function is in no file."""
        place = cls(function, file)
        return place if place.get_cache_path() and Path(file).exists() else None


class _Results(caching.CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (_Place,)  # and none of numba's, beside sources and whatever they call


class _Cache(caching.FunctionCache):  # type: ignore[misc]
    """A function's cache, of checked files; raises RuntimeError if there is no place for it."""

    _impl_class = _Results

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = _Files(self.cache_path, self._impl.filename_base, stamp)

    def load_overload(self, signature: object, context: object) -> Any:
        """Give what was compiled before; None if it has to be now, which takes its time."""
        found = super().load_overload(signature, context)
        if found is None:
            _tell()
        return found

    def save_overload(self, signature: object, result: object) -> None:
        """Save what was compiled, if that can be: it is there to be used anyway."""
        with suppress(OSError):
            super().save_overload(signature, result)


def _call_template(template: Callable[..., Any], args: Iterable[Any], kws: Any) -> Any:
    """Type a kernel's call of another by the kinds of its arguments alone.

    numba would compile the same kernel again for each constant that it is called with, which LLVM
    folds where it pays.
    """
    return template(
        tuple(map(types.unliteral, args)), {k: types.unliteral(v) for k, v in kws.items()}
    )


@cache
def _tell() -> None:
    """Tell who sits at a terminal, once, what there is to wait for."""
    if sys.stderr and sys.stderr.isatty():  # a bar that stands there is drawn again below
        told = "\r\x1b[Kgapath: compiling kernels, up to a minute; they are kept for the next time"
        print(told, file=sys.stderr, flush=True)


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
    compiled = numba.njit(function, **options)
    if JIT:
        compiled.get_call_template = partial(_call_template, compiled.get_call_template)
        with suppress(RuntimeError):
            compiled._cache = _Cache(function)
    return compiled


def intrinsic(function: Callable[..., Any]) -> Callable[..., Any]:
    """Make a function of kernels out of one that gives its signature and its LLVM code."""
    return extending.intrinsic(function)  # type: ignore[no-any-return]
