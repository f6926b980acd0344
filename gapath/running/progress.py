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
from dataclasses import dataclass, field, fields
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
    """A trial that was done."""

    row: Any
    found: bool
    steps: int
    late: Inputs
    """What was read while it was done, and by no trial before it."""


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
        self._path, self._types = folder.path / PROGRESS, columns(run.task.row)
        self._chain = _Chain()
        with named(self._path):
            self._file: IO[bytes] = new_file(self._path)
        self._write(_head(folder, run))

    def add(self, done: Done) -> None:
        """Add a trial; raises InputError if it cannot be written."""
        row = [*_typed(done.row, self._types).values()]
        self._write([bool(done.found), int(done.steps), dict(done.late), row])

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
    trials : list of Done
        The first ones, in order, whose rows and events are whole.
    last : list of Event
        The events of the last of them, if they were recorded.
    """

    folder: RunFolder
    trials: list[Done] = field(default_factory=list)
    last: list[Event] = field(default_factory=list)

    def agrees(self, trial: Trial, started: RunStarted) -> bool:
        """Tell whether the last trial comes to the same again.

        Parameters
        ----------
        trial : Trial
            The one that was done again.
        started : RunStarted
            The run's first event.

        Returns
        -------
        bool
            Whether its row but for times, and its messages in the log, are equal.
        """
        *before, last = self.trials
        now = (bool(trial.found), trial.steps, _untimed(trial.row))
        if now != (last.found, last.steps, _untimed(last.row)):
            return False
        if not self.last:
            return True
        from gapath.recorders.mcap.messages import Messages

        again = trial.events(sum(done.steps for done in before))
        was, now_is = Messages(started), Messages(started)
        told = [record for event in self.last for record in was.records(event)]
        return told == [record for event in again for record in now_is.records(event)]

    def events(self, run: Run) -> Iterator[list[Event]]:
        """Give the events of all trials but the last one; none each if nobody recorded."""
        count = max(len(self.trials) - 1, 0)
        if not run.recorders:
            yield from ([] for _ in range(count))
        elif count:
            yield from itertools.islice(_logged(self.folder, run), count)


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
    return len(found.trials)


def _read(folder: RunFolder, run: Run) -> Earlier:
    nothing = Earlier(folder)
    if folder.path.is_symlink():
        return nothing
    done = list(_journaled(folder, run))
    late = {path: digest for trial in done for path, digest in trial.late.items()}
    if not done or not unchanged(late):
        return nothing
    if not run.recorders:
        return Earlier(folder, done)
    count, last = 0, list[Event]()
    for events in itertools.islice(_logged(folder, run), len(done)):
        count, last = count + 1, events
    return Earlier(folder, done[:count], last)


def _journaled(folder: RunFolder, run: Run) -> Iterator[Done]:
    """Give the trials of `PROGRESS`, up to the first line that is not as it was written."""
    names, own = [*columns(run.task.row)], {each.name for each in fields(run.task.row)}
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
            found, steps, late, values = content
            row = _row(run, dict(zip(names, values, strict=True)), own)
            yield Done(row, found, steps, late)


def _row(run: Run, values: Mapping[str, Any], own: set[str]) -> Any:
    metrics = {name: value for name, value in values.items() if name not in own}
    return run.task.row(**{n: v for n, v in values.items() if n in own}, metrics=metrics)


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
                if event.trial != count:
                    return
                yield trial
                count, trial = count + 1, []


def _typed(row: Any, types: Mapping[str, type]) -> dict[str, Any]:
    """Give a row's values as `gapath.store.rows.parquet` takes them, not as types of NumPy."""
    values = row.values()
    return {name: kind(values[name]) for name, kind in types.items()}


def _untimed(row: Any) -> str:
    values = _typed(row, columns(type(row)))
    return json.dumps({name: v for name, v in values.items() if not name.endswith(_TIME)})
