"""Logs of runs, as figures and tables read them."""

from collections.abc import Iterator

from gapath.errors import InputError
from gapath.events import Event, RunStarted
from gapath.recorders.mcap import FILE


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
