"""A log's file written, record by record, a chunk at most in memory: what `walk` reads."""

import struct
import zlib
from typing import Protocol

import zstandard
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    DataEnd,
    Header,
    McapRecord,
    Message,
    Metadata,
    Schema,
    Statistics,
)

from gapath.recorders.mcap.file.stored import Bytes, Stored
from gapath.recorders.mcap.file.summary import MAGIC, Place, Summary, encoded
from gapath.recorders.mcap.format import LIBRARY, PROFILE

_MESSAGE = struct.Struct("<BQHIQQ")
_HEAD = struct.calcsize("<BQ")


class Target(Protocol):
    """Where a log goes: a file, or what only compares with one."""

    def write(self, data: Bytes, /) -> object:
        """Take bytes; raises OSError if that fails."""

    def flush(self) -> None:
        """Hand over what was written so far."""


class Writer:
    """Writes a log's records.

    Parameters
    ----------
    file : Target
        Where to, from its start.

    Raises
    ------
    OSError
        By every method, if the file cannot be written.
    """

    def __init__(self, file: Target) -> None:
        self._file, self._place, self._crc = file, 0, 0
        self._summary = Summary()
        self._begin()
        self._put(MAGIC)
        self._put(encoded(Header(PROFILE, LIBRARY)))

    def _put(self, data: Bytes) -> None:
        self._file.write(data)
        self._crc = zlib.crc32(data, self._crc)
        self._place += len(data)

    def metadata(self, record: Metadata) -> None:
        """Write metadata."""
        data = encoded(record)
        self._summary.metadata(self._place, len(data), record)
        self._put(data)

    def stored(self, record: Stored) -> None:
        """Write an attachment."""
        begin = self._place
        for piece in record.record():
            self._put(piece)
        self._summary.attachment(begin, self._place - begin, record)

    def schema(self, record: Schema) -> None:
        """Write a schema into the chunk under way."""
        self._summary.schema(record)
        self._add(record)

    def channel(self, record: Channel) -> None:
        """Write a channel into the chunk under way."""
        self._summary.channel(record)
        self._add(record)

    def _add(self, record: McapRecord) -> None:
        self._chunk.append(encoded(record))
        self._size += len(self._chunk[-1])

    def message(self, message: Message) -> None:
        """Write a message into the chunk under way."""
        number, data, time = message.channel_id, message.data, message.log_time
        size = _MESSAGE.size + len(data)
        head = (Opcode.MESSAGE, size - _HEAD, number, message.sequence, time, message.publish_time)
        self._places.append(Place(self._size, number, time))
        self._chunk += (_MESSAGE.pack(*head), data)
        self._size += size

    def _begin(self) -> None:
        self._chunk: list[bytes] = []
        self._places: list[Place] = []
        self._size = 0

    def flush(self) -> None:
        """End the chunk under way, if it has a message, and hand all to the operating system."""
        if self._places:
            places, data = self._places, b"".join(self._chunk)
            self._begin()
            times = [place.time for place in places]
            packed, crc = zstandard.compress(data), zlib.crc32(data)
            chunk = Chunk("zstd", packed, max(times), min(times), crc, len(data))
            del data
            record = encoded(chunk)
            follows = self._summary.chunk(self._place, len(record), chunk, places)
            self._put(record)
            self._put(follows)
        self._file.flush()

    @property
    def statistics(self) -> Statistics:
        """What has been written: whole chunks alone."""
        return self._summary.statistics

    def finish(self) -> None:
        """Write the log's end."""
        self.flush()
        self._put(encoded(DataEnd(self._crc)))
        for _, part in self._summary.parts(self._place):
            self._file.write(part)
