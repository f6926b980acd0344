"""Whole runs into a crate: a folder of runs, with what they were made of and what they came to."""

import hashlib
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from gapath.crates.description import Credits, Packed, describe, library
from gapath.crates.plain import without_folders
from gapath.crates.reading import METADATA, MOST_METADATA
from gapath.errors import require
from gapath.store.durable import (
    make_folder,
    named,
    new_file,
    open_regular,
    publish,
    scratch,
    sync_folder,
)
from gapath.store.inputs import Inputs, contents
from gapath.store.records import MANIFEST, FileEntry, RunRecord
from gapath.store.runfolder import RunFolder
from gapath.store.status import STATUS

INPUTS = "inputs"
"""The folder in a crate of the files that runs were made from."""


def pack(runs: Sequence[RunRecord], target: Path, credit: Credits) -> list[Packed]:
    """Write a crate, whole or not at all; the same runs give the same bytes.

    Parameters
    ----------
    runs : sequence of RunRecord
        Whole runs, at least one.
    target : Path
        The folder that it becomes, which is not there yet, or empty.
    credit : Credits
        Who made it, and what others may do with it.

    Returns
    -------
    list of Packed
        What is in it.

    Raises
    ------
    InputError
        If a run's file is not as its manifest says, or the crate cannot be written.
    """
    free = not os.path.lexists(target) or (_is_folder(target) and not any(target.iterdir()))
    require(free, target, "something that is there", "a new folder, or an empty one")
    library()  # sooner than after copying
    with named(target.parent):
        make_folder(target.parent)
        with scratch(target.parent) as place:
            folder = place / "crate"
            folder.mkdir()
            packed = [_packed(run, folder) for run in runs]
            data = describe(packed, credit)
            right = f"at most {MOST_METADATA}: a crate of fewer runs"
            require(len(data) <= MOST_METADATA, METADATA, f"{len(data)} bytes", right)
            _write(folder / METADATA, data)
            for each, _, _ in os.walk(folder, topdown=False):
                sync_folder(Path(each))
            publish(folder, target)
    return packed


def _is_folder(path: Path) -> bool:
    return path.is_dir() and not path.is_symlink()


def _packed(run: RunRecord, folder: Path) -> Packed:
    known = run.known
    sources = {**known.map_inputs, **known.method_inputs}
    places, inputs = _inputs(sources, folder)
    typed = {value for value in run.settings.values() if isinstance(value, str)}

    def told(those: Inputs) -> dict[str, str]:
        """Name inputs by their places in the crate; what was typed stands in other files, too."""
        return {p if p in typed else places.get(p, Path(p).name): sha for p, sha in those.items()}

    manifest = replace(
        known,
        command=without_folders(known.command),
        provenance=without_folders(known.provenance),
        map_inputs=told(known.map_inputs),
        method_inputs=told(known.method_inputs),
        late_inputs=told(known.late_inputs),
    )
    own = RunFolder(folder / run.name)
    own.path.mkdir(parents=True)
    for name, entry in known.files.items():
        found = _copy(run.folder / name, own.path / name)
        expected = f"{entry.sha256}, as its manifest says: the command that made it mends it"
        require(found == entry, run.folder / name, found.sha256, expected)
    status = replace(run.status, manifest=manifest.write(own))
    _write(own.path / STATUS, status.sealed())
    made = {name: _entry((own.path / name).read_bytes()) for name in (MANIFEST, STATUS)}
    files = {f"{run.name}/{name}": entry for name, entry in {**known.files, **made}.items()}
    missing = {Path(path).name: sha for path, sha in sources.items() if path not in places}
    return Packed(replace(run, manifest=manifest, status=status), files, inputs, missing)


def _inputs(sources: Inputs, folder: Path) -> tuple[dict[str, str], dict[str, FileEntry]]:
    """Copy what a run was made from and is as it was: path -> place, and what lies there.

    What lay in one folder does so in the crate, since one file may name another.
    """
    places, found = dict[str, str](), dict[str, FileEntry]()
    for parent in sorted({str(Path(path).parent) for path in sources}):
        own = {p: sha for p, sha in sources.items() if str(Path(p).parent) == parent}
        group = hashlib.sha256("\n".join(contents(own)).encode()).hexdigest()[:16]
        for path, sha in own.items():
            place = f"{INPUTS}/{group}/{Path(path).name}"
            (folder / place).parent.mkdir(parents=True, exist_ok=True)
            with suppress(OSError):  # it may be gone, or another user's
                found[place] = _copy(Path(path), folder / place, links=True)
                places[path] = place
            if place in found and found[place].sha256 != sha:
                (folder / place).unlink()
                del found[place], places[path]
    return places, found


def _copy(source: Path, target: Path, links: bool = False) -> FileEntry:
    digest, size = hashlib.sha256(), 0
    with open_regular(source, links) as old, new_file(target) as new:
        while data := old.read(1 << 20):
            digest.update(data)
            size += len(data)
            new.write(data)
        new.flush()
        os.fsync(new.fileno())
    return FileEntry(digest.hexdigest(), size)


def _entry(data: bytes) -> FileEntry:
    return FileEntry(hashlib.sha256(data).hexdigest(), len(data))


def _write(path: Path, data: bytes) -> None:
    with new_file(path) as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
