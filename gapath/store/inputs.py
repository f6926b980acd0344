"""Which files a run reads: what they hold is part of its key.

Python itself tells of every file that is opened, so that no reader, planner or library can
forget to. What code in C or another process opens, or what is kept from an earlier reading, it
does not see.
"""

import hashlib
import os
import sys
import sysconfig
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import lru_cache
from importlib.machinery import all_suffixes
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeAlias

from gapath.discovery import conf_packages, other_folders
from gapath.store.durable import open_regular
from gapath.store.settings import Flat

Inputs: TypeAlias = Mapping[str, str]
"""The files that a run reads: path, as it was opened -> SHA-256 of the content."""

_SYSTEM = ("/proc", "/sys")

_LIBRARIES = ("site-packages", "dist-packages")
"""Folders of installed packages, on Python's path: of the environment, the user, a .pth."""

_COMPILED = (*all_suffixes(), ".nbi", ".nbc")
"""Endings of code: of modules and, the last two, of numba's cache."""

_opened: list[list[str]] = []
"""The paths that were opened for reading, for each `watched` that is under way."""


class Reads(dict[str, str]):
    """`Inputs`, as far as they were noted."""

    def __init__(self) -> None:
        super().__init__()
        self.opened: list[str] = []
        self._seen: set[str] = set()

    def note(self) -> Inputs:
        """Take in the files that were opened since, as they are now; gives those that are new."""
        count = len(self.opened)  # other threads may open more meanwhile
        if not count:
            return {}
        paths = dict.fromkeys(self.opened[:count])
        del self.opened[:count]
        unseen = paths.keys() - self._seen
        self._seen |= unseen
        new = {p: _sha256(p) for p in paths if p in unseen and _is_input(Path(p).resolve())}
        self.update(new)
        return new


@contextmanager
def watched() -> Iterator[Reads]:
    """Note the files that are read meanwhile.

    Left out are those that are no input: all code, files of Python, of libraries, of gapath but
    for its maps, of packages that add components (those are in the key anyway), and of the
    system.

    Yields
    ------
    Reads
        Noted when the context ends, at the latest.
    """
    _listen()
    found = Reads()
    _opened.append(found.opened)
    try:
        yield found
    finally:
        _opened.pop()
    found.note()


def contents(inputs: Inputs) -> list[str]:
    """Give names and hashes of files for a key: it does not matter in which folder they lie."""
    return sorted(f"{Path(path).name} {digest}" for path, digest in inputs.items())


def without_paths(settings: Flat, inputs: Inputs) -> Flat:
    """Leave out settings that name an input, of which its content says more."""
    return {key: value for key, value in settings.items() if value not in inputs}


def unchanged(inputs: Inputs) -> bool:
    """Tell whether files are there and hold what they held."""
    with suppress(OSError):
        return all(_sha256(path) == digest for path, digest in inputs.items())
    return False


def _sha256(path: str) -> str:
    with open_regular(path, links=True) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@lru_cache
def _listen() -> None:
    sys.addaudithook(_note)


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if event != "open" or not _opened:
        return
    path, _, flags = arguments
    reading = flags & (os.O_WRONLY | os.O_RDWR) == 0
    if reading and isinstance(path, str | bytes):  # else it is open already
        for paths in _opened:
            paths.append(os.fsdecode(path))


def _is_input(file: Path) -> bool:
    if not file.is_file() or file.name.endswith(_COMPILED):
        return False
    if any(part.endswith((".dist-info", ".egg-info")) for part in file.parts):
        return False
    if file.is_relative_to(_folder("gapath.maps")):  # which lies among the libraries, or not
        return True
    return not any(file.is_relative_to(place) for place in _no_inputs())


@lru_cache
def _no_inputs() -> list[Path]:
    library = sysconfig.get_paths()
    places = [library[name] for name in ("stdlib", "platstdlib")]
    places += [str(Path(os.__file__).parent), *_SYSTEM]  # the first: a virtual environment's base
    own = [_folder(package) for package in ("gapath", "gapath.pipelines", *conf_packages())]
    own += other_folders().values()
    for place in map(Path, sys.path):
        own += [place] if place.name in _LIBRARIES else _installed(place)
    return [Path(place).resolve() for place in places] + [place.resolve() for place in own]


def _installed(place: Path) -> list[Path]:
    """Find the packages in a folder on Python's path that pip fills, as `--target` names it."""
    if not any(place.glob("*.dist-info")):
        return []
    return [file.parent for file in place.glob("*/__init__.py")]


def _folder(package: str) -> Path:
    return Path(str(files(package))).resolve()
