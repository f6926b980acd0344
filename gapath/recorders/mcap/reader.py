"""Reading a log, which may come from anywhere.

Whatever is wrong is one `InputError` that names the file.
"""

import contextlib
from collections import Counter, deque
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, TypeVar

from mcap.records import Channel, Message, Metadata

from gapath.errors import InputError, require
from gapath.events import Called, Event, RunStarted, TrialFinished
from gapath.problem import Answer
from gapath.recorders.mcap import description
from gapath.recorders.mcap.file.stored import Stored
from gapath.recorders.mcap.file.walk import LARGE, Limits, Walk, opened
from gapath.recorders.mcap.format import Form
from gapath.recorders.mcap.messages import event

WHOLE = "a whole log of gapath"
BEGUN = "a log of gapath that is whole at least up to the first message"

T = TypeVar("T")


class Head:
    """What a log says of its run, gathered entry by entry.

    Parameters
    ----------
    text : dict of str to str
        The metadata.
    form : Form
        The log's, once its metadata are there.
    lost : Lost
        What is not in the log, of one that was saved.
    """

    form: Form

    def __init__(self) -> None:
        self.text: dict[str, str] = {}
        self.lost = description.NOTHING
        self._files: dict[str, Stored] = {}

    def take(self, entry: Metadata | Stored) -> RunStarted | None:
        """Take metadata or an attachment; the last of them makes the run's first event."""
        if isinstance(entry, Stored):
            name, files = entry.name, self._files
            require(name not in files, f"attachment {name}", "twice", "once")
            files[name] = entry
            last = name == description.OPTIMAL_PATH
            return description.run_started(self.text, [*files.values()]) if last else None
        if entry.name == description.NAME:
            self.text, self.form = entry.metadata, description.form_of(entry.metadata)
        elif entry.name == description.LOST:
            self.lost = description.Lost.of(entry.metadata)
        return None


def read_events(path: str | Path, limits: Limits = LARGE) -> Iterator[Event]:
    """Read a whole log.

    The file is checked from end to end before the first event is given.

    Parameters
    ----------
    path : str or Path
        A log written by `Recorder`.
    limits : Limits
        What it may take.

    Yields
    ------
    Event
        The very events that were recorded.

    Raises
    ------
    InputError
        If the file cannot be read, is not a log of gapath, has another version, is cut
        off or damaged, has anything in it that gapath does not write, or exceeds the limits.
    """
    with suggesting(path, limits), refusing(path, WHOLE), opened(path) as file:
        deque(_events(file, limits, lambda topic: False), maxlen=0)  # keeps no map meanwhile
        yield from _events(file, limits)


@contextlib.contextmanager
def suggesting(path: str | Path, limits: Limits) -> Iterator[None]:
    """Say of a log that cannot be read how to save the rest, if there is any."""
    try:
        yield
    except InputError as error:
        if not _has_begun(path, limits):
            raise
        expected = f"{error.expected}; to save the rest: gapath-log salvage {path}"
        raise InputError(error.where, error.value, expected) from error


def read_prefix(path: str | Path, limits: Limits = LARGE) -> Iterator[Event]:
    """Read a log up to where it is cut off or damaged.

    Parameters
    ----------
    path : str or Path
        A log written by `Recorder`, or what was left of one.
    limits : Limits
        What it may take.

    Yields
    ------
    Event
        The events that are whole, in order, none missing in between.

    Raises
    ------
    InputError
        If not even the first event is whole.
    """
    with refusing(path, BEGUN), opened(path) as file:
        yield from _until_damage(_events(file, limits))


def look(path: str | Path, limits: Limits, seen: Counter[str]) -> Iterator[Event]:
    """Read only how a run began and how each of its trials ended, but check the whole log.

    Parameters
    ----------
    path : str or Path
        A log written by `Recorder`, or what was left of one.
    limits : Limits
        What it may take.
    seen : Counter of str
        Counts the messages of each topic, up to where the log is cut off or damaged.

    Yields
    ------
    RunStarted, Finished or RunFinished
        Those events alone.

    Raises
    ------
    InputError
        As `read_events`, when the place is reached.
    """

    def wanted(topic: str) -> bool:
        seen[topic] += 1
        return topic in (*ENDS, RUN_END)

    with refusing(path, WHOLE), opened(path) as file:
        yield from _events(file, limits, wanted)


def answers(path: str | Path, limits: Limits) -> Iterator[Answer]:
    """Give what planners answered, up to where a log is cut off or damaged.

    Parameters
    ----------
    path : str or Path
        A log written by `Recorder`, or what was left of one.
    limits : Limits
        What it may take.

    Yields
    ------
    Answer
        Of each trial that ended, and of each call in a drive.

    Raises
    ------
    InputError
        If not even the run's first event is whole.
    """
    with refusing(path, BEGUN), opened(path) as file:
        for event in _until_damage(_events(file, limits, _ANSWERS.__contains__)):
            if isinstance(event, TrialFinished | Called):
                yield event.answer


RUN_END = "/run_end"
ENDS = ("/result", "/drive_end")
"""Topics of the last messages of a run, and of trials."""

_ANSWERS = ("/result", "/planner_call")


def _has_begun(path: str | Path, limits: Limits) -> bool:
    """Tell whether a log is whole up to its first message, so that there is something to save."""
    try:
        return next(read_prefix(path, limits), None) is not None
    except InputError:
        return False


def _events(
    file: IO[bytes], limits: Limits, wanted: Callable[[str], bool] = lambda topic: True
) -> Iterator[Event]:
    """Give the run's first event, then those of all messages of wanted topics."""
    head, topics = Head(), dict[int, str]()
    started, count = False, 0
    for entry in Walk(file, limits).entries():
        if isinstance(entry, Message):
            require(started, "metadata", "none before the first message", "a run's description")
            if entry.sequence != count:
                missing = (count, entry.sequence - 1)
                good = missing in head.lost.messages
                require(good, "message", entry.sequence, f"number {count}")
            count = entry.sequence + 1
            topic = topics[entry.channel_id]
            if wanted(topic):
                found = event(topic, entry.log_time // head.form.step_ns, entry.data)
                if found is not None and getattr(found, "trial", None) not in head.lost.trials:
                    yield found
        elif isinstance(entry, Channel):
            topics[entry.id] = entry.topic
        elif isinstance(entry, Metadata | Stored):
            run = head.take(entry)
            if run is not None:
                started = True
                yield run
    require(started, "metadata", "none", "a run's description")


def _until_damage(items: Iterator[T]) -> Iterator[T]:
    yield next(items)  # without a first event there is nothing to read
    with contextlib.suppress(Exception):
        yield from items


@contextlib.contextmanager
def refusing(path: str | Path, expected: str) -> Iterator[None]:
    """Turn whatever the libraries raise at a bad file into one `InputError`."""
    try:
        yield
    except InputError as error:
        raise error.within(path) from error
    except OSError as error:
        raise InputError(path, error.strerror or error, "a readable file") from error
    except Exception as error:
        raise InputError(path, f"{type(error).__name__} {error}".strip(), expected) from error
