"""A crate that may come from anywhere: what it says, and whether its files are those it says.

Nothing is read that does not lie in its folder, and no link is followed.
"""

import hashlib
import os
import re
import stat
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote

from gapath.errors import InputError, require
from gapath.recorders.mcap import FILE
from gapath.store.durable import open_regular
from gapath.store.status import contents, parsed

METADATA = "ro-crate-metadata.json"

PROFILE = "https://w3id.org/ro/wfrun/process/"
"""What every version of the profile's address begins with."""

MOST_METADATA = 1 << 24
"""Bytes of the largest description that is read."""

_SHA256 = re.compile(r"[0-9a-f]{64}")
_WEB = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")


class PackedRun(NamedTuple):
    """A run of a crate, as it was found.

    Parameters
    ----------
    name : str
        ``<experiment>/<key>``.
    log : Path or None
        Its log; None of a run without one.
    """

    name: str
    log: Path | None


def unpack(place: Path) -> list[PackedRun]:
    """Read a crate, and check all of its files.

    Parameters
    ----------
    place : Path
        Its folder.

    Returns
    -------
    list of PackedRun
        Its runs, as it names them, at least one.

    Raises
    ------
    InputError
        If it is none, is too large, or a file is missing, another one, or lies elsewhere.
    """
    require(place.is_dir(), place, "no such folder", "the folder of a crate")
    folder = place.resolve()
    right = "the folder of a crate, which has one"
    require(os.path.lexists(folder / METADATA), place, f"no {METADATA} in it", right)
    try:
        entities = _entities(parsed(contents(folder, METADATA, MOST_METADATA), METADATA))
        files = {
            name: _checked(folder, name, entity)
            for name, entity in entities.items()
            if "File" in _all(entity, "@type") and not _WEB.match(name)
        }
        root = entities.get("./", {})
        profiles = (name.startswith(PROFILE) for name in _named(root, "conformsTo"))
        require(any(profiles), f"{METADATA}, conformsTo", _named(root, "conformsTo"), PROFILE)
        actions = [e for e in entities.values() if "CreateAction" in _all(e, "@type")]
        require(bool(actions), METADATA, "no CreateAction", "a run of gapath at least")
        return [_run(action, files) for action in actions]
    except InputError as error:
        raise InputError(f"{place}, {error.where}", error.value, error.expected) from error


def _entities(content: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    graph = content.get("@graph")
    where = f"{METADATA}, @graph"
    require(isinstance(graph, list), where, type(graph).__name__, "a list of entities")
    found: dict[str, dict[str, Any]] = {}
    for entity in graph or ():
        name = entity.get("@id") if isinstance(entity, dict) else None
        require(isinstance(name, str), where, str(entity)[:80], "entities with an @id")
        require(name not in found, where, name, "each entity once")
        found[str(name)] = entity
    return found


def _all(entity: Mapping[str, Any], name: str) -> list[Any]:
    """Give the values of a property: JSON-LD writes a single one without a list."""
    value = entity.get(name, [])
    return value if isinstance(value, list) else [value]


def _named(entity: Mapping[str, Any], name: str) -> list[str]:
    """Give the names of the entities to which a property refers."""
    values = _all(entity, name)
    return [str(value.get("@id")) for value in values if isinstance(value, dict)]


def _checked(folder: Path, name: str, entity: Mapping[str, Any]) -> Path:
    """Check that a file lies in the crate and is the one it says; gives its path."""
    path, said = folder, entity.get("sha256")
    parts = unquote(name).removeprefix("./").split("/")
    plain = not {"", ".", ".."}.intersection(parts) and not {"\0", "\\"}.intersection(unquote(name))
    require(plain, "a file", name, "one within the crate, named by its path in it")
    known = isinstance(said, str) and bool(_SHA256.fullmatch(said))
    require(known, f"{name}, sha256", said, "64 hexadecimal digits")
    try:
        for part in parts[:-1]:
            path /= part
            require(stat.S_ISDIR(path.lstat().st_mode), name, f"{part}, no folder", "a file in one")
        path /= parts[-1]
        with open_regular(path) as file:
            found = hashlib.file_digest(file, "sha256").hexdigest()
    except FileNotFoundError as error:
        raise InputError(name, "no file", "every file that the crate names") from error
    except OSError as error:
        raise InputError(name, error.strerror, "a regular file that can be read") from error
    require(found == said, name, f"SHA-256 {found}", f"{said}: the file was changed")
    return path


def _run(action: Mapping[str, Any], files: Mapping[str, Path]) -> PackedRun:
    name = unquote(str(action["@id"])).removeprefix("#")
    logs = [n for n in _named(action, "result") if unquote(n).rpartition("/")[2] == FILE]
    require(len(logs) <= 1, name, f"{len(logs)} logs", "one, or none")
    for log in logs:
        require(log in files, name, log, "a log that the crate has as a file")
    return PackedRun(name, files[logs[0]] if logs else None)
