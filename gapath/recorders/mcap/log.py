"""The log: every event of a run in one MCAP file.

Profile ``ros2``: whatever reads ROS 2 bags opens it. The same events give the same bytes.
"""

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

from mcap.records import Channel, Message, Metadata, Schema

from gapath.errors import InputError, require
from gapath.events import Event, RunStarted
from gapath.recorders.mcap import description
from gapath.recorders.mcap.description import NOTHING
from gapath.recorders.mcap.file.walk import Entry
from gapath.recorders.mcap.file.write import Target, Writer
from gapath.recorders.mcap.format import (
    LAST_TIME,
    LOG_VERSION,
    LONGEST_STEP,
    MAX_CHUNK,
    MAX_LOG,
    TOPICS,
    Form,
    channel_metadata,
    schema,
)
from gapath.recorders.mcap.messages import Messages, count_first
from gapath.recorders.mcap.reader import read_prefix
from gapath.recorders.mcap.ros.bag import METADATA, described
from gapath.store.durable import new_file, part_of, publish

FILE = "run.mcap"
"""Name of the log in a run folder."""

CHUNK_MESSAGES, CHUNK_BYTES = 400, 1 << 18
"""A chunk ends after so many messages or bytes, and after the run's first event: however a run is
recorded, its log has the same bytes."""

_MESSAGE_HEAD = 31  # bytes of a message record before its data


class LogWriter:
    """Writes events, or messages that were events once, as a log.

    Parameters
    ----------
    file : Target
        Where to.
    form : Form
        The log's: an earlier version only to write an older log again.
    lost : Lost
        What is not in the log, of one that was saved; `skipped` counts how much of it was not
        written so far.
    """

    def __init__(
        self,
        file: Target,
        form: Form,
        lost: description.Lost = NOTHING,
    ) -> None:
        self._form, self._lost, self.skipped = form, lost, 0
        self._writer = Writer(file)
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._messages: Messages | None = None
        self._count = self._bytes = self._in_chunk = self._chunk_bytes = self._head = 0

    def write(self, event: Event) -> Iterator[Entry]:
        """Write what an event comes to; the first event also gives metadata and attachments.

        Parameters
        ----------
        event : Event
            The next event of the run.

        Yields
        ------
        Metadata, Stored, Schema, Channel or Message
            What has been written.

        Raises
        ------
        InputError
            If the log would grow past half of what can be read, or its times past their end.
        OSError
            If the file cannot be written.
        """
        if isinstance(event, RunStarted):
            yield from self.begin(event)
        assert self._messages is not None, "the run's first event comes first"
        end = getattr(event, "step", 0) * self._form.step_ns
        if end >= LAST_TIME:
            most = f"less than {LAST_TIME // 10**9} s: fewer steps, or shorter ones (step_s)"
            raise InputError("recorder.mcap", f"{end / 1e9:g} s of log time", most)
        for topic, time, data in self._messages.records(event):
            self._bytes += len(data) + _MESSAGE_HEAD
            if len(data) > MAX_CHUNK // 2 or self._bytes > MAX_LOG // 2:
                raise InputError(
                    "recorder.mcap",
                    f"{len(data)} bytes in a message, {self._bytes} in the run",
                    f"at most {MAX_CHUNK // 2} and {MAX_LOG // 2}: a smaller map, or fewer epochs "
                    "or trials",
                )
            number = self._count
            self._count += 1
            if self._lost.has(number):
                self.skipped += 1
            else:
                yield from self.put(topic, time, data, time, number)
        if isinstance(event, RunStarted):
            self._end_head()

    def begin(self, run: RunStarted) -> Iterator[Entry]:
        """Write the metadata and attachments that a run's first event comes to."""
        self._messages = Messages(run, self._form)
        self._head = count_first(run, self._form)
        told = {description.NAME: description.metadata(run, self._form)}
        for name, text in (told | self._lost.metadata).items():
            entry = Metadata(name, text)
            self._writer.metadata(entry)
            yield entry
        for stored in description.attachments(run):
            self._writer.stored(stored.packed() if self._form.is_bag else stored)
            yield stored

    def put(
        self, topic: str, time: int, data: bytes, published: int, sequence: int
    ) -> Iterator[Entry]:
        """Write a message on a topic, whose channel is made when it is first written to."""
        if sequence >= self._head:
            self._end_head()
        if topic not in self._channels:
            name = TOPICS[topic]
            if name not in self._schemas:
                self._schemas[name] = len(self._schemas) + 1
                described = Schema(self._schemas[name], schema(name), "ros2msg", name)
                self._writer.schema(described)
                yield described
            self._channels[topic] = len(self._channels) + 1
            told = channel_metadata(topic, self._form)
            channel = Channel(self._channels[topic], topic, "cdr", told, self._schemas[name])
            self._writer.channel(channel)
            yield channel
        message = Message(self._channels[topic], time, data, published, sequence)
        self._writer.message(message)
        self._in_chunk += 1
        self._chunk_bytes += len(data) + _MESSAGE_HEAD
        if self._in_chunk >= CHUNK_MESSAGES or self._chunk_bytes >= CHUNK_BYTES:
            self.flush()
        yield message

    def _end_head(self) -> None:
        """End the first chunk: a killed run leaves something whole from its first moment on."""
        if self._head:
            self._head = 0
            self.flush()

    def flush(self) -> None:
        """End a chunk, and hand it to the operating system."""
        self._writer.flush()
        self._in_chunk = self._chunk_bytes = 0

    def finish(self) -> None:
        """Write the log's end."""
        self._writer.finish()

    def bag(self, name: str) -> bytes:
        """Describe the log, which is finished and has this name, as a bag of ROS 2."""
        return described(name, self._writer.statistics, self._channels)


def check_step(step_s: float, where: str) -> None:
    """Refuse a step of no sensible time: raises InputError."""
    good = 1 <= step_s * 1e9 <= LONGEST_STEP
    require(good, where, step_s, f"from 1e-9 to {LONGEST_STEP / 1e9:g}")


@dataclass
class Recorder:
    """Writes ``run.mcap``, and ``metadata.yaml``, with which the folder is a bag of ROS 2.

    Parameters
    ----------
    step_s : float
        Seconds that a step counts in the log, so in whatever plays it.
    """

    records = True

    step_s: float

    _path: Path = field(init=False, repr=False)
    _file: IO[bytes] | None = field(init=False, repr=False, default=None)
    _writer: LogWriter = field(init=False, repr=False)

    def __post_init__(self) -> None:
        check_step(self.step_s, "recorder.step_s")

    def check(self, trials: int) -> None:
        """Accept every run; its size is bounded while it is written."""

    def open(self, folder: str) -> None:
        """Start ``run.mcap.part`` in an existing folder."""
        self._path = Path(folder) / FILE
        self._file = new_file(part_of(self._path))
        self._writer = LogWriter(self._file, Form(LOG_VERSION, round(self.step_s * 1e9)))

    def recorded(self, folder: str) -> Iterator[Event]:
        """Give the whole events of a log that was cut short, which nobody writes any more.

        Parameters
        ----------
        folder : str
            Where it was begun.

        Yields
        ------
        Event
            In order, none missing in between.

        Raises
        ------
        InputError
            If not even the first event is whole.
        """
        whole = Path(folder) / FILE
        return read_prefix(whole if whole.exists() else part_of(whole))

    def record(self, event: Event) -> None:
        """Write what an event comes to; raises InputError or OSError as `LogWriter.write` does."""
        for _ in self._writer.write(event):
            pass

    def close(self) -> list[str]:
        """Finish the log, make it durable, and give it its name."""
        assert self._file is not None, "open comes first"
        bag = self._path.with_name(METADATA)
        self._writer.finish()
        with self._file as log, new_file(part_of(bag)) as described:
            described.write(self._writer.bag(FILE))
            for file in (log, described):
                file.flush()
                os.fsync(file.fileno())
        for path in (self._path, bag):
            publish(part_of(path), path)
        return [FILE, METADATA]

    def abort(self) -> None:
        """Leave ``run.mcap.part`` with all that was recorded, for `salvage`."""
        if self._file is not None and not self._file.closed:
            with self._file:
                self._writer.flush()
