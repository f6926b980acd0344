"""Runs that can go: which these are, and how one is removed and nothing else.

A run is removed while its lock is held, so that none at work goes. Of its folder go the files that
its manifest names, those that every run has, and what a run that was cut short left; what
somebody put beside them stays. Links are removed, never followed.
"""

import os
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from gapath.pipelines.reading.counted import superseded
from gapath.pipelines.reading.tags import UNSAID, read_said, say
from gapath.store.durable import named, part_of, sync_folder
from gapath.store.records import CONFIG, MANIFEST, TRIALS, RunRecord
from gapath.store.runfolder import BEFORE, LOCK, WORK, Busy, RunFolder
from gapath.store.status import STATUS, WHOLE, RunState, Status

_FAILED = (RunState.FAILED, RunState.INTERRUPTED)


class Why(NamedTuple):
    """What of runs is to go.

    Parameters
    ----------
    superseded : bool
        Runs in whose place another counts.
    failed : bool
        Runs that failed or were interrupted.
    tags : set of str
        Runs that have one of these tags.
    """

    superseded: bool
    failed: bool
    tags: set[str]


class Reason(NamedTuple):
    """A run, and why it goes, or stays."""

    run: RunRecord
    text: str


def choose(runs: Sequence[RunRecord], why: Why) -> tuple[list[Reason], list[Reason]]:
    """Choose the runs that go.

    A run is superseded if it can be used and another that can be used counts in its place
    (`gapath.pipelines.reading.counted.superseded`): of the same experiment, map, settings, seed
    and inputs, a newer one, or of the same versions one with more trials.

    Parameters
    ----------
    runs : sequence of RunRecord
        The runs.
    why : Why
        What is to go.

    Returns
    -------
    gone : list of Reason
        The runs that go.
    kept : list of Reason
        Those that would, but stay: links, what has other tags or a note, what another run
        supersedes by a clock that jumped.

    Raises
    ------
    InputError
        If an experiment's tags cannot be read: nobody knows then what is to stay.
    """
    every = {place: read_said(place) for place in {run.folder.parent for run in runs}}
    said = {id(run): every[run.folder.parent].get(run.folder.name, UNSAID) for run in runs}
    found = {}
    for run in runs:
        mine = sorted(why.tags.intersection(said[id(run)].tags))
        if mine:
            found[id(run)] = Reason(run, f"tagged {', '.join(mine)}")
        elif why.failed and run.state in _FAILED:
            found[id(run)] = Reason(run, str(run.state))
    if why.superseded:
        rest = [run for run in runs if id(run) not in found]  # what goes supersedes nothing
        for run, newer in superseded(rest):
            found[id(run)] = Reason(run, f"superseded by {newer.name}{_jumped(run, newer)}")
    gone, kept = list[Reason](), list[Reason]()
    for run in runs:
        if id(run) not in found:
            continue
        reason = found[id(run)]
        stays = ""
        if run.folder.is_symlink() or run.folder.parent.is_symlink():
            stays = "a link"
        elif said[id(run)] != UNSAID and not reason.text.startswith("tagged "):
            stays = "it has a tag or a note"
        elif _JUMPED in reason.text:
            stays = reason.text
        (kept if stays else gone).append(Reason(run, stays) if stays else reason)
    return gone, kept


_JUMPED = ", by a clock that jumped: "


def _jumped(*runs: RunRecord) -> str:
    """Tell which run's times cannot be, if any: then nobody knows which of them is newer."""
    for run in runs:
        dates = [run.status.started, run.status.date]
        times = list[datetime]()
        with suppress(ValueError):  # none, or of no clock of ours
            times = [datetime.fromisoformat(date) for date in dates]
        order = [time if time.tzinfo else time.replace(tzinfo=UTC) for time in times]
        if not order or not order[0] <= order[1] <= datetime.now(UTC):
            return f"{_JUMPED}{run.name} was from {dates[0]} to {dates[1]}"
    return ""


def size_of(run: RunRecord) -> int:
    """Add up the bytes of what is a run's own."""
    places = [run.folder / name for name in (WORK, BEFORE)]
    within = [Path(top, name) for place in places for top, _, names in os.walk(place)
              for name in names]  # fmt: skip
    total = 0
    for path in (*(run.folder / name for name in _own(run)), *within):
        with suppress(OSError):
            total += path.lstat().st_size
    return total


def remove(run: RunRecord) -> list[str] | None:
    """Remove a run.

    Parameters
    ----------
    run : RunRecord
        The run, as it was found.

    Returns
    -------
    list of str or None
        What is left in its folder, which is no part of the run; None if the run stays, since
        another process works on it, or did meanwhile.

    Raises
    ------
    InputError
        If something cannot be removed; the run is then interrupted, and can be removed again.
    """
    folder = RunFolder(run.folder)
    try:
        with folder.lock():
            found = Status.read(run.folder)
            if replace(found, state=run.state) != run.status:
                return None
            if run.state in WHOLE:  # should this process be killed, it is no more than half a run
                replace(found, state=RunState.INTERRUPTED, message=_GOING).write(folder)
            left = _emptied(folder, [*_own(run)])
    except Busy:
        return None
    if run.folder.name in read_said(run.folder.parent):
        say(run.folder, lambda said: UNSAID)
    return left


_GOING = "gapath-report prune was cut short"


def _own(run: RunRecord) -> Iterable[str]:
    files = run.manifest.files if run.manifest else ()
    plain = dict.fromkeys([*files, CONFIG, TRIALS, MANIFEST])
    parts = [part_of(run.folder / name).name for name in (MANIFEST, STATUS)]
    return [*plain, *parts, STATUS]  # the status last: as long as it is there, it is a run


def _emptied(folder: RunFolder, names: Iterable[str]) -> list[str]:
    """Remove files from a folder that is held, and the folder if nothing else is in it."""
    folder.clear()
    with named(folder.path):
        for path in (folder.path / name for name in (*names, LOCK)):
            if path.is_symlink() or not path.is_dir():
                path.unlink(missing_ok=True)
        left = sorted(path.name for path in folder.path.iterdir())
        if not left:
            folder.path.rmdir()
        sync_folder(folder.path.parent)
    return left
