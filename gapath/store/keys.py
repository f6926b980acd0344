"""What a run is named by: everything that its results depend on."""

import hashlib
import os
from collections.abc import Iterable
from functools import lru_cache
from importlib import metadata
from pathlib import Path

from gapath.discovery import other_files, other_packages
from gapath.problem import Problem
from gapath.store.inputs import Inputs, contents, without_paths
from gapath.store.settings import Flat, text_of

VERSIONED = ("gapath", "numpy", "numba", "mcap", "zstandard", "rosbags", "hydra-core", "pyarrow")
"""What decides results, logs and rows. A recording is made from the log, with whatever Rerun."""

_NO_SETTING = ("trials", "shard", "shards", "recorder", "map")
"""What makes no other setting: it changes no trial, or is told by what it comes to, the map."""


_NO_CODE = ("conf", "maps", "pipelines")
"""Parts of the package that change no run but by its settings and its map."""


@lru_cache
def code_hash() -> str:
    """Hash the sources of gapath, and of installed packages that add components.

    Returns
    -------
    str
        Sixteen hexadecimal digits; the same for a checkout and a wheel of the same sources, and
        for as long as a process lives.
    """
    return code_now()


def code_now() -> str:
    """Hash the sources as `code_hash` does, as they are now: edited ones are others."""
    own = []
    for place, folders, names in os.walk(_PACKAGE):
        within = place[len(_PACKAGE) + 1 :]
        if not within:
            folders[:] = [name for name in folders if name not in _NO_CODE]
        own += [(f"{within}/{n}".lstrip("/"), f"{place}/{n}") for n in names if n.endswith(".py")]
    files = [*sorted(own), *((name, str(path)) for name, path in other_files())]
    return _hash_of(tuple((name, path, *_written(path)) for name, path in files))


def edited(code: str) -> bool:
    """Tell whether the sources are others now than those of a `code_hash`."""
    try:
        return code_now() != code
    except OSError:  # an editor is at it
        return True


_PACKAGE = str(Path(__file__).parents[1])


def _written(path: str) -> tuple[int, int, int]:
    """Tell when a file was written: who edits it changes one of these, so it is not read again."""
    found = Path(path).stat()
    return found.st_mtime_ns, found.st_size, found.st_ino


@lru_cache(maxsize=2)
def _hash_of(sources: tuple[tuple[str, str, int, int, int], ...]) -> str:
    digest = hashlib.sha256()
    for name, path, *_ in sources:
        digest.update(name.encode() + b"\0" + Path(path).read_bytes())
    return digest.hexdigest()[:16]


@lru_cache
def versions() -> dict[str, str]:
    """Give the versions of gapath, of Python, and of what decides results and files.

    Returns
    -------
    dict of str to str
        Name -> version; "code" is `code_hash`.
    """
    import platform

    found = {name: metadata.version(name) for name in VERSIONED}
    others = other_packages()
    return {"python": platform.python_version(), "code": code_hash(), **found, **others}


def setting_hash(settings: Flat, problem: Problem, inputs: Inputs) -> str:
    """Hash what two runs must share to try the same thing, with whatever code and however often.

    Parameters
    ----------
    settings : mapping
        The run's settings, flat.
    problem : Problem
        Map, start, target: what the files named by the settings came to.
    inputs : mapping
        The files that it reads: path -> SHA-256.

    Returns
    -------
    str
        Sixteen hexadecimal digits.
    """
    kept = without_paths(settings, inputs).items()
    tried = {key: value for key, value in kept if key.partition(".")[0] not in _NO_SETTING}
    return _hash([text_of(dict(sorted(tried.items()))), *_posed(problem), *contents(inputs)])


def run_key(settings: Flat, problem: Problem, inputs: Inputs) -> str:
    """Name a run by everything that its results depend on.

    Parameters
    ----------
    settings : mapping
        The run's settings, flat.
    problem : Problem
        Map, start, target: what the files named by the settings came to.
    inputs : mapping
        The files that it reads: path -> SHA-256.

    Returns
    -------
    str
        Sixteen hexadecimal digits.
    """
    code = [code_hash(), metadata.version("gapath")]
    return _hash([text_of(settings), *_posed(problem), *contents(inputs), *code])


def _posed(problem: Problem) -> list[str]:
    others = [f"{name} {grid.digest}" for name, grid in sorted(problem.maps.items())]
    queries = [] if problem.queries is None else [problem.queries.digest]
    return [problem.map.digest, f"{problem.start} {problem.target}", *others, *queries]


def _hash(parts: Iterable[str]) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]
