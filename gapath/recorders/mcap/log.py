"""The log: every event of a run in one MCAP file, and the events back from it.

Profile ``ros2``: whatever reads ROS 2 bags opens it. The same events give the same
bytes.
"""

import os
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from mcap.writer import Writer

from gapath.errors import Checks, InputError, require
from gapath.events import Event, RunStarted
from gapath.recorders.mcap import description
from gapath.recorders.mcap.format import (
    LIBRARY,
    MAX_CHUNK,
    MAX_LOG,
    NS_PER_STEP,
    PROFILE,
    TOPICS,
    schema,
)
from gapath.recorders.mcap.messages import Messages
from gapath.recorders.mcap.reader import read_events, read_prefix
from gapath.store.durable import new_file, part_of, publish

FILE = "run.mcap"
"""Name of the log in a run folder."""

_MESSAGE_HEAD = 31  # bytes of a message record before its data


@dataclass
class Recorder:
    """Writes ``run.mcap``.

    Parameters
    ----------
    flush_every : int
        Messages after which what was logged is handed to the operating system: no more
        than these are lost when the process is killed.

    Raises
    ------
    InputError
        If it is not from 1 to 1000000.
    """

    records = True

    flush_every: int
    _path: Path = field(init=False, repr=False)
    _file: IO[bytes] | None = field(init=False, repr=False, default=None)
    _writer: Any = field(init=False, repr=False)
    _channels: dict[str, int] = field(init=False, repr=False)
    _schemas: dict[str, int] = field(init=False, repr=False)
    _messages: Messages = field(init=False, repr=False)
    _count: int = field(init=False, repr=False)
    _bytes: int = field(init=False, repr=False)

    def __post_init__(self) -> None:
        Checks(self, "recorder.mcap").whole("flush_every", 1, 10**6)

    def check(self, trials: int) -> None:
        """Accept every run; its size is bounded while it is written."""

    def open(self, folder: str) -> None:
        """Start ``run.mcap.part`` in an existing folder."""
        self._path = Path(folder) / FILE
        self._file = new_file(self._part)
        self._count = self._bytes = 0
        self._writer = Writer(self._file, enable_data_crcs=True)
        self._writer.start(profile=PROFILE, library=LIBRARY)

    @property
    def _part(self) -> Path:
        return part_of(self._path)

    def record(self, event: Event) -> None:
        """Write an event's messages; the first event also gives metadata and attachments.

        Raises
        ------
        InputError
            If the log would grow past half of what `read_events` accepts.
        OSError
            If the file cannot be written.
        """
        if isinstance(event, RunStarted):
            self._begin(event)
        for topic, step, data in self._messages.records(event):
            self._bytes += len(data) + _MESSAGE_HEAD
            if len(data) > MAX_CHUNK // 2 or self._bytes > MAX_LOG // 2:
                raise InputError(
                    "recorder.mcap",
                    f"{len(data)} bytes in a message, {self._bytes} in the run",
                    f"at most {MAX_CHUNK // 2} and {MAX_LOG // 2}: fewer epochs or trials",
                )
            time = step * NS_PER_STEP
            self._writer.add_message(self._channel(topic), time, data, time, self._count)
            self._count += 1
            if self._count % self.flush_every == 0:
                self._writer.flush()

    def _begin(self, run: RunStarted) -> None:
        self._messages = Messages(run)
        self._writer.add_metadata(description.NAME, description.metadata(run))
        for name, data in description.attachments(run).items():
            self._writer.add_attachment(0, 0, name, "application/octet-stream", data)
        self._channels, self._schemas = {}, {}

    def _channel(self, topic: str) -> int:
        """Give the number of a topic's channel, which is made when it is first written to."""
        if topic not in self._channels:
            name = TOPICS[topic]
            if name not in self._schemas:
                text = schema(topic)
                self._schemas[name] = self._writer.register_schema(name, "ros2msg", text)
            number = self._writer.register_channel(topic, "cdr", self._schemas[name])
            self._channels[topic] = number
        return self._channels[topic]

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
        """Leave ``run.mcap.part`` as it is, for `salvage`."""
        if self._file is not None:
            self._file.close()


def salvage(path: str | Path, output: str | Path) -> int:
    """Write what is whole of a log that a killed run left as a log of its own.

    Parameters
    ----------
    path : str or Path
        A log without an end, such as ``run.mcap.part``.
    output : str or Path
        The new log; must not exist.

    Returns
    -------
    int
        Number of events saved; the new log was read back to check them.

    Raises
    ------
    InputError
        If there is nothing to save, or the output exists or has no folder.
    OSError
        If the output cannot be written.
    """
    output = Path(output)
    require(output.parent.is_dir(), output, "no such folder", "a file in an existing folder")
    require(not output.exists(), output, "a file that exists", "a new name")
    recorder = Recorder(flush_every=1000)
    with tempfile.TemporaryDirectory(dir=output.parent) as folder:
        count = 0
        recorder.open(folder)
        try:
            for event in read_prefix(path):
                recorder.record(event)
                count += 1
            recorder.close()
        finally:
            recorder.abort()
        whole = Path(folder) / FILE
        saved = sum(1 for _ in read_events(whole))
        require(saved == count, output, f"{saved} events read back", f"{count}")
        publish(whole, output)
    return count
