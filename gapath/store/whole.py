"""A run is in its folder whole or not at all: how that is told, and how a run comes to be there.

All that a run writes lies in the folder `WORK` within its own until it is whole and durable:
settings, trials, what recorders made, the manifest, which has the hashes of these, and a status,
which has that of the manifest. Then

1. the status takes its place in the run's folder. From this one step on the new run counts;
2. the files take their places, what only the run before had goes, and the manifest lies beside
   its place;
3. the folder `WORK` goes, and that of a run which was cut short and taken up, `BEFORE`;
4. the manifest takes its place: now nothing is left to be done.

Before step 1 a run that was there before is untouched. Whoever is killed after it leaves a status
that speaks of a manifest that is not in its place: whoever takes the lock next finishes the other
steps (`settle`), which may be done any number of times. Nothing else in the folder is touched; a
file that the run before had not written, and that has a name of the new one's, gets another name.
"""

import itertools
import os
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from gapath.errors import InputError, require
from gapath.store.durable import named, part_of, publish, sync_folder
from gapath.store.inputs import unchanged
from gapath.store.records import CONFIG, MANIFEST, TRIALS, FileEntry, Manifest
from gapath.store.runfolder import RunFolder
from gapath.store.settings import Flat, text_of
from gapath.store.status import STATUS, TURN, WHOLE, Status


def is_whole(folder: RunFolder, settings: Flat) -> bool:
    """Tell whether a run was finished, and its files and those it read late are as they were.

    Parameters
    ----------
    folder : RunFolder
        The folder, named by the run's key.
    settings : mapping
        The run's settings, flat.

    Returns
    -------
    bool
        False also of another run's files.
    """
    try:
        status = Status.read(folder.path)
        known = Manifest.read(folder.path, status.manifest)
        own = known.key == folder.path.name and text_of(known.settings or {}) == text_of(settings)
        finished = status.state in WHOLE and known.files.keys() >= {CONFIG, TRIALS}
        return own and finished and _as_they_were(folder, known) and unchanged(known.late_inputs)
    except (OSError, InputError):
        return False


def _as_they_were(folder: RunFolder, known: Manifest) -> bool:
    return all(
        (folder.path / name).lstat().st_size == entry.bytes and folder.sha256(name) == entry.sha256
        for name, entry in known.files.items()
    )


def files_of(folder: RunFolder, sha256: str = "") -> dict[str, FileEntry]:
    """Give the files of a folder's manifest; none of one that cannot be read or is another."""
    try:
        return dict(Manifest.read(folder.path, sha256).files)
    except InputError:
        return {}


def check_places(folder: RunFolder, names: Iterable[str]) -> None:
    """Raise InputError if a folder has the name of one of these files, or of those of all runs."""
    for name in (CONFIG, TRIALS, *names, MANIFEST, STATUS):
        place = folder.path / name
        require(not place.is_dir() or place.is_symlink(), place, "a folder", "no folder there")


def finish(folder: RunFolder, manifest: Manifest, status: Status) -> None:
    """Put a run that is whole in the place of what was there before.

    Parameters
    ----------
    folder : RunFolder
        The folder, which is held; the files of the manifest lie in `RunFolder.work`.
    manifest : Manifest
        What was run.
    status : Status
        How it ended; gets the manifest's hash.

    Raises
    ------
    InputError
        If something cannot be written, or a folder has the name of a file.
    """
    check_places(folder, manifest.files)
    with TURN:
        replace(status, manifest=manifest.write(folder.work)).write(folder.work)
        publish(folder.work.path / STATUS, folder.path / STATUS)
        settle(folder)


def is_finished(folder: RunFolder) -> bool:
    """Tell whether the run in `RunFolder.work` counts already, and is only to take its place."""
    return _finished(folder) is not None


def settle(folder: RunFolder) -> None:
    """Finish what `finish` began, if anything; raises InputError if that cannot be done.

    Parameters
    ----------
    folder : RunFolder
        The folder, which is held.
    """
    manifest, work, last = _finished(folder), folder.work, part_of(folder.path / MANIFEST)
    if manifest is None:
        return
    before = files_of(folder)
    with named(folder.path):
        for name in manifest.files:
            if os.path.lexists(work.path / name):
                if before and name not in before:
                    _keep(folder.path / name)
                (work.path / name).replace(folder.path / name)
        for name in before.keys() - manifest.files.keys():
            (folder.path / name).unlink(missing_ok=True)
        if os.path.lexists(work.path / MANIFEST):
            (work.path / MANIFEST).replace(last)
        sync_folder(folder.path)
    folder.clear()
    publish(last, folder.path / MANIFEST)


def _keep(path: Path) -> None:
    """Give a file that no run has written another name, the first that is free."""
    if os.path.lexists(path):
        names = (path.with_name(f"{path.name}.{i}") for i in itertools.count(1))
        path.rename(next(name for name in names if not os.path.lexists(name)))


def _finished(folder: RunFolder) -> Manifest | None:
    work = folder.work.path
    status = Status.read(folder.path)
    if not status.manifest or status.state not in WHOLE or work.is_symlink():
        return None
    for path in (work / MANIFEST, part_of(folder.path / MANIFEST)):
        with suppress(InputError):
            return Manifest.read(path.parent, status.manifest, path.name)
    return None
