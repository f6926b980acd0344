"""What a run that was cut short has done, and how the same run goes on after it.

Beside what recorders write a run keeps `PROGRESS`: a line for each trial that is done, with a
checksum over it and all lines before. The same command, whose run has the same key and versions,
takes up the trials that are whole there and in the log; the last of them is done again and must
come to the same. Their events are given to new recorders, so that all files are made anew.
"""

import contextlib
import hashlib
import io
import itertools
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import IO, Any, NamedTuple

from gapath.errors import InputError
from gapath.events import Event, Finished, RunFinished, RunStarted
from gapath.running.config import Run
from gapath.store.durable import named, new_file, open_regular
from gapath.store.inputs import Inputs, unchanged
from gapath.store.keys import versions
from gapath.store.runfolder import PROGRESS, RunFolder
from gapath.task import Trial, columns

_TIME = "_s"  # columns of times, in seconds, end so


class Done(NamedTuple):
    """A trial that was done, as it stands in `PROGRESS`."""

    found: bool
    steps: int
    late: Inputs
    """What was read while it was done, and by no trial before it."""
    values: list[Any]
    """A value for each column of its row, in their order."""


class Journal:
    """Writes `PROGRESS`, so that a trial is in it once it is done, even if the process is killed.

    Parameters
    ----------
    folder : RunFolder
        The folder of the run under way.
    run : Run
        What is done.

    Raises
    ------
    InputError
        If it cannot be written.
    """

    def __init__(self, folder: RunFolder, run: Run) -> None:
        self._path, self._chain = folder.path / PROGRESS, _Chain()
        with named(self._path):
            self._file: IO[bytes] = new_file(self._path)
        self._write(_head(folder, run))

    def add(self, done: Done) -> None:
        """Add a trial; raises InputError if it cannot be written."""
        self._write(done)

    def _write(self, content: object) -> None:
        text = json.dumps(content).encode()
        with named(self._path):
            self._file.write(self._chain.next(text) + b" " + text + b"\n")
            self._file.flush()

    def close(self) -> None:
        """Let go of the file."""
        with contextlib.suppress(OSError):  # what was not written then is told already
            self._file.close()


class _Chain:
    """Checksums of lines, each over all lines so far."""

    def __init__(self) -> None:
        self._sum = hashlib.sha256()

    def next(self, line: bytes) -> bytes:
        self._sum.update(line + b"\n")
        return self._sum.hexdigest()[:16].encode()


def _head(folder: RunFolder, run: Run) -> dict[str, object]:
    """Give the first line: what the run is, and whether all of its trials are done anew."""
    key, names = folder.path.parent.name, [*columns(run.task.row)]
    return {"key": key, "versions": versions(), "columns": names, "force": run.force}


def _may_take_up(content: object, head: dict[str, object]) -> bool:
    """Tell whether a run with this first line may go on from one with that.

    Who asks for all to be done anew gets what was done since that was asked, not from before.
    """
    return content in (head, head | {"force": True})


@dataclass(frozen=True)
class Earlier:
    """What a run did before it was cut short.

    Parameters
    ----------
    folder : RunFolder
        Where that lies.
    count : int
        How many trials, the first ones, have whole rows and events.
    steps : int
        Steps of the log that those before the last of them take.
    last : Done or None
        The last of them.
    events : list of Event
        Its events, if they were recorded.
    """

    folder: RunFolder
    count: int = 0
    steps: int = 0
    last: Done | None = None
    events: list[Event] = field(default_factory=list)

    def agrees(self, run: Run, trial: Trial, started: RunStarted) -> bool:
        """Tell whether the last trial comes to the same again.

        Parameters
        ----------
        run : Run
            The run.
        trial : Trial
            The one that was done again.
        started : RunStarted
            The run's first event.

        Returns
        -------
        bool
            Whether its row but for times, and its messages in the log, are equal.
        """
        kinds = columns(run.task.row)
        now, last = done_of(trial, {}, kinds), self.last
        if last is None or _untimed(now, kinds) != _untimed(last, kinds):
            return False
        if not self.events:
            return True
        from gapath.recorders.mcap.format import LOG_VERSION, Form
        from gapath.recorders.mcap.messages import Messages

        form = Form(LOG_VERSION, step_ns=1)  # the same for both
        was, now_is = Messages(started, form), Messages(started, form)
        told = [record for event in self.events for record in was.records(event)]
        again = trial.events(self.steps)
        return told == [record for event in again for record in now_is.records(event)]

    def trials(self, run: Run) -> Iterator[tuple[Done, list[Event]]]:
        """Give all trials but the last one, with their events; none each if nobody recorded."""
        count = max(self.count - 1, 0)
        done = itertools.islice(_journaled(self.folder, run), count)
        told = itertools.islice(_logged(self.folder, run), count)
        return zip(done, told if run.recorders else itertools.repeat([], count), strict=True)


def earlier(folder: RunFolder, run: Run) -> Earlier:
    """Find what can be taken up of a run that was cut short.

    Parameters
    ----------
    folder : RunFolder
        The folder, which is held.
    run : Run
        The same run, by its key.

    Returns
    -------
    Earlier
        Of two that were cut short one after the other the one that came further.
    """
    return max((_read(each, run) for each in (folder.before, folder.work)), key=_count)


def _count(found: Earlier) -> int:
    return found.count


def _read(folder: RunFolder, run: Run) -> Earlier:
    found = Earlier(folder)
    if folder.path.is_symlink():
        return found
    told = _logged(folder, run) if run.recorders else itertools.repeat(list[Event]())
    count, steps, late = 0, 0, dict[str, str]()
    last, events = None, list[Event]()
    for done, events_of_it in zip(_journaled(folder, run), told, strict=False):
        steps += last.steps if last else 0
        count, last, events = count + 1, done, events_of_it
        late |= done.late
    return Earlier(folder, count, steps, last, events) if unchanged(late) else found


def _journaled(folder: RunFolder, run: Run) -> Iterator[Done]:
    """Give the trials of `PROGRESS`, up to the first line that is not as it was written."""
    chain, head = _Chain(), True
    with (
        contextlib.suppress(OSError, ValueError, TypeError),  # no such file, or not as ours
        open_regular(folder.path / PROGRESS) as raw,
        io.BufferedReader(raw) as file,
    ):
        for line in file:
            checksum, _, text = line.partition(b" ")
            if not text.endswith(b"\n") or checksum != chain.next(text[:-1]):
                return
            content = json.loads(text)
            if head:
                if not _may_take_up(content, _head(folder, run)):
                    return
                head = False
                continue
            yield Done(*content)


def _logged(folder: RunFolder, run: Run) -> Iterator[list[Event]]:
    """Give the events of the trials that are whole in the log, trial 0 first."""
    from gapath.recorders import mcap

    log = next((each for each in run.recorders if isinstance(each, mcap.Recorder)), None)
    if log is None:
        return
    count, trial = 0, list[Event]()
    with contextlib.suppress(InputError):  # not even its first event is whole
        for event in log.recorded(str(folder.path)):
            if isinstance(event, RunStarted):
                continue
            if isinstance(event, RunFinished):
                return
            trial.append(event)
            if isinstance(event, Finished):
                if event.trial != run.first + count:
                    return
                yield trial
                count, trial = count + 1, []


def done_of(trial: Trial, late: Inputs, kinds: Mapping[str, type]) -> Done:
    """Give a trial as it is written down.

    Parameters
    ----------
    trial : Trial
        It was done.
    late : mapping of str to str
        What was read meanwhile, and by no trial before it.
    kinds : mapping of str to type
        `gapath.task.columns` of its row.

    Returns
    -------
    Done
        Its values are of these types, not of NumPy's.
    """
    values = trial.row.values()
    typed = [kind(values[name]) for name, kind in kinds.items()]
    return Done(bool(trial.found), int(trial.steps), dict(late), typed)


def _untimed(done: Done, kinds: Mapping[str, type]) -> str:
    kept = [v for name, v in zip(kinds, done.values, strict=True) if not name.endswith(_TIME)]
    return json.dumps([done.found, done.steps, kept])
