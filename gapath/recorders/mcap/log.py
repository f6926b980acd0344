"""The log: every event of a run in one MCAP file.

Profile ``ros2``: whatever reads ROS 2 bags opens it. The same events give the same bytes.
"""

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

from mcap.records import Channel, Message, Metadata, Schema

from gapath.errors import InputError
from gapath.events import Event, RunStarted
from gapath.recorders.mcap import description
from gapath.recorders.mcap.description import NOTHING
from gapath.recorders.mcap.file.walk import Entry
from gapath.recorders.mcap.file.write import Target, Writer
from gapath.recorders.mcap.format import MAX_CHUNK, MAX_LOG, NS_PER_STEP, TOPICS, schema
from gapath.recorders.mcap.messages import Messages, count_first
from gapath.recorders.mcap.reader import read_prefix
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
    version : str
        What the log calls itself: another version only to write an older log again.
    lost : Lost
        What is not in the log, of one that was saved; `skipped` counts how much of it was not
        written so far.
    """

    def __init__(
        self,
        file: Target,
        version: str = description.LOG_VERSION,
        lost: description.Lost = NOTHING,
    ) -> None:
        self._version, self._lost, self.skipped = version, lost, 0
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
            If the log would grow past half of what can be read.
        OSError
            If the file cannot be written.
        """
        if isinstance(event, RunStarted):
            yield from self.begin(event)
        assert self._messages is not None, "the run's first event comes first"
        for topic, step, data in self._messages.records(event):
            self._bytes += len(data) + _MESSAGE_HEAD
            if len(data) > MAX_CHUNK // 2 or self._bytes > MAX_LOG // 2:
                raise InputError(
                    "recorder.mcap",
                    f"{len(data)} bytes in a message, {self._bytes} in the run",
                    f"at most {MAX_CHUNK // 2} and {MAX_LOG // 2}: a smaller map, or fewer epochs "
                    "or trials",
                )
            number, time = self._count, step * NS_PER_STEP
            self._count += 1
            if self._lost.has(number):
                self.skipped += 1
            else:
                yield from self.put(topic, time, data, time, number)
        if isinstance(event, RunStarted):
            self._end_head()

    def begin(self, run: RunStarted) -> Iterator[Entry]:
        """Write the metadata and attachments that a run's first event comes to."""
        self._messages = Messages(run)
        self._head = count_first(run)
        told = {description.NAME: description.metadata(run, self._version)}
        for name, text in (told | self._lost.metadata).items():
            entry = Metadata(name, text)
            self._writer.metadata(entry)
            yield entry
        for stored in description.attachments(run):
            self._writer.stored(stored)
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
                described = Schema(self._schemas[name], schema(topic), "ros2msg", name)
                self._writer.schema(described)
                yield described
            self._channels[topic] = len(self._channels) + 1
            channel = Channel(self._channels[topic], topic, "cdr", {}, self._schemas[name])
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


@dataclass
class Recorder:
    """Writes ``run.mcap``."""

    records = True

    _path: Path = field(init=False, repr=False)
    _file: IO[bytes] | None = field(init=False, repr=False, default=None)
    _writer: LogWriter = field(init=False, repr=False)

    def check(self, trials: int) -> None:
        """Accept every run; its size is bounded while it is written."""

    def open(self, folder: str) -> None:
        """Start ``run.mcap.part`` in an existing folder."""
        self._path = Path(folder) / FILE
        self._file = new_file(self._part)
        self._writer = LogWriter(self._file)

    @property
    def _part(self) -> Path:
        return part_of(self._path)

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
        self._writer.finish()
        self._file.flush()
        os.fsync(self._file.fileno())
        self._file.close()
        publish(self._part, self._path)
        return [self._path.name]

    def abort(self) -> None:
        """Leave ``run.mcap.part`` with all that was recorded, for `salvage`."""
        if self._file is not None and not self._file.closed:
            with self._file:
                self._writer.flush()
