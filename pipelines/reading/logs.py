"""Logs of runs, as figures and tables read them."""

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

from gapath.errors import InputError
from gapath.events import Event, RunStarted
from gapath.recorders.mcap import FILE, read_sound
from gapath.store.records import RunRecord

Read = TypeVar("Read")


def has_log(run: RunRecord) -> bool:
    """Tell whether a run kept its log."""
    return FILE in run.known.files


def events_of(run: RunRecord) -> Iterator[Event]:
    """Read a run's log; it has one. InputError is raised at what is damaged or makes no sense."""
    return read_sound(run.folder / FILE)


def read_logs(
    runs: Iterable[RunRecord], read: Callable[[RunRecord], Read]
) -> tuple[list[tuple[RunRecord, Read]], list[tuple[str, str]]]:
    """Read something from the log of each run that has one.

    Parameters
    ----------
    runs : iterable of RunRecord
        The runs; those without a log are passed over.
    read : callable
        Reads it; InputError where the log cannot be read.

    Returns
    -------
    read : list of (RunRecord, object)
        What was read, run by run.
    skipped : list of (str, str)
        Names of the runs whose log cannot be read, and why.
    """
    found, skipped = [], []
    for run in filter(has_log, runs):
        try:
            found.append((run, read(run)))
        except InputError as error:
            skipped.append((run.name, str(error)))
    return found, skipped


def run_start(events: Iterator[Event]) -> RunStarted:
    """Take the first event of a log.

    Parameters
    ----------
    events : iterator of Event
        A log's events; the rest is left for the caller.

    Returns
    -------
    RunStarted
        What the log says of its run.

    Raises
    ------
    InputError
        If the log does not begin with the run's start, or cannot be read.
    """
    start = next(events, None)
    if not isinstance(start, RunStarted):
        raise InputError(FILE, type(start).__name__, "RunStarted as the first event")
    return start
