"""A log's file, record by record, and nothing in it that a log of gapath has not.

A file may come from anywhere: sizes are checked before anything is read or inflated, every record
must be written as gapath writes it, and every byte must be of a record.
"""

import os
import struct
import zlib
from collections.abc import Iterator
from io import BufferedReader, BytesIO
from pathlib import Path
from typing import IO, Any, NamedTuple, TypeAlias, TypeVar

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Header, McapRecord, Message, Metadata, Schema

from gapath.errors import InputError, require
from gapath.recorders.mcap.file.stored import Stored
from gapath.recorders.mcap.file.summary import MAGIC, Place, Summary, encoded
from gapath.recorders.mcap.format import LIBRARY, MAX_CHUNK, MAX_LOG, PROFILE, TOPICS
from gapath.store.durable import open_regular

Entry: TypeAlias = Metadata | Stored | Schema | Channel | Message
"""What a log says, wherever in the file it lies."""


class Limits(NamedTuple):
    """What a log may take of whoever reads it.

    Parameters
    ----------
    chunk : int
        Bytes of a chunk, as it lies in the file and inflated.
    attachments : int
        Bytes of all attachments.
    log : int
        Bytes of all chunks, inflated.
    messages : int
        How many messages.
    """

    chunk: int
    attachments: int
    log: int
    messages: int


USUAL = Limits(48 << 20, 48 << 20, 1 << 30, 500_000)
"""Of nearly every run: they keep a reader within 512 MB and some seconds, whatever the file is."""

LARGE = Limits(MAX_CHUNK, 1 << 31, MAX_LOG, 2**32)
"""Of every run that can be logged."""

_FEW = 64  # metadata and attachments, whose number is that of the maps and some more
_TEXT = 4 << 20  # bytes of metadata, or of a schema or channel
_RATIO, _SMALL = 1000, 1 << 24  # only a large map of one weight is packed so tightly
_HEAD = struct.Struct("<BQ")
_CHUNK = struct.Struct("<QQQI")
_MESSAGE = struct.Struct("<HIQQ")
_TIMES, _SIZE, _LONG = struct.Struct("<QQ"), struct.Struct("<I"), struct.Struct("<Q")
_ZSTD = struct.pack("<I", 4) + b"zstd"

R = TypeVar("R", bound=McapRecord)


def opened(path: str | Path) -> IO[bytes]:
    """Open a regular file for reading; a pipe or a device would never end."""
    return BufferedReader(open_regular(path, links=True))


class Ended(InputError):
    """A file ends where there must be more."""


class Walk:
    """Where in a file one is, and what was there so far.

    Parameters
    ----------
    file : binary file
        A log written by `Recorder`.
    limits : Limits
        What it may take.

    Raises
    ------
    InputError
        By every method, where something else stands than `Recorder` writes, or the file ends, or
        would take more.
    Exception
        Where bytes are no record: whatever `mcap`, `zstandard` or Python raise.
    """

    def __init__(self, file: IO[bytes], limits: Limits = USUAL) -> None:
        self._file, self._limits = file, limits
        self.size = os.fstat(file.fileno()).st_size
        self.place = self._crc = self._inflated = self._attached = self._few = 0
        self._summary = Summary()
        self._inside = Inside()
        self.torn = 0
        file.seek(0)

    def entries(self) -> Iterator[Entry]:
        """Walk through a whole log.

        Yields
        ------
        Metadata, Stored, Schema, Channel or Message
            As they lie in the file, each checked. After the last one the end of the file is
            checked, too.
        """
        self.begin()
        yield from self.data()
        self.end()

    def data(self) -> Iterator[Entry]:
        """Go on up to the end of the data; where the file `Ended`, `torn` bytes are of no use."""
        while True:
            self.torn = self.size - self.place
            found = self.step()
            if found is None:
                return
            self.torn = self.size - self.place
            yield from found

    def _take(self, size: int) -> bytes:
        left = self.size - self.place
        if size > left:
            raise Ended("record", f"{left} bytes up to the end", f"{size} bytes")
        data = self._file.read(size)
        require(len(data) == size, "record", f"{len(data)} bytes", f"{size} bytes")
        self.place += size
        return data

    def _next(self) -> tuple[int, int]:
        """Look at the next record: its kind, and how many bytes it has."""
        opcode, length = _HEAD.unpack(self._take(_HEAD.size))
        most = {
            Opcode.CHUNK: self._limits.chunk,
            Opcode.ATTACHMENT: self._limits.attachments,
        }.get(opcode, _TEXT)
        require(length <= most, f"record {opcode}", f"{length} bytes", _at_most(most))
        self.place -= _HEAD.size
        self._file.seek(self.place)
        return opcode, _HEAD.size + length

    def begin(self) -> None:
        """Read what a file begins with."""
        magic = self._take(min(len(MAGIC), self.size))
        if magic != MAGIC:
            kind = Ended if MAGIC.startswith(magic) else InputError
            raise kind("first bytes", magic.hex(" "), f"those of MCAP, {MAGIC.hex(' ')}")
        opcode, length = self._next()
        require(opcode == Opcode.HEADER, "first record", f"of kind {opcode}", "a header")
        data = self._take(length)
        header = read(Header, data)
        found, right = (header.profile, header.library), (PROFILE, LIBRARY)
        require(found == right, "profile, library", ", ".join(found), ", ".join(right))
        self._crc = zlib.crc32(magic + data)

    def step(self) -> Iterator[Entry] | None:
        """Read the next record up to the end of the data, and what belongs to it."""
        offset = self.place
        opcode, length = self._next()
        if opcode == Opcode.ATTACHMENT:
            self._count()
            return iter([self._stored(offset, length)])
        data = self._take(length)
        if opcode == Opcode.DATA_END:
            good = data == _HEAD.pack(opcode, 4) + struct.pack("<I", self._crc)
            require(good, "end of data", data[9:].hex(" "), f"CRC {self._crc}")
            return None
        self._crc = zlib.crc32(data, self._crc)
        if opcode == Opcode.CHUNK:
            none = "none before the first message"
            require(self._few > 0, "metadata", none, "a run's description")
            return self._opened(offset, data)
        self._count()
        where, right = f"record at byte {offset}", "metadata, an attachment or a chunk"
        require(opcode == Opcode.METADATA, where, f"one of kind {opcode}", right)
        metadata = read(Metadata, data)
        self._summary.metadata(offset, length, metadata)
        return iter([metadata])

    def _count(self) -> None:
        self._few += 1
        require(self._few <= _FEW, "metadata and attachments", self._few, f"at most {_FEW}")

    def _stored(self, offset: int, length: int) -> Stored:
        """Read an attachment; its content, which may be large, is copied nowhere."""
        self._attached += length
        most = self._limits.attachments
        require(self._attached <= most, "attachments", self._attached, _at_most(most))
        end, pieces = offset + length, [self._take(_HEAD.size + 16)]

        def sized(head: struct.Struct) -> bytes:
            pieces.append(self._take(head.size))
            (size,) = head.unpack(pieces[-1])
            require(size <= end - self.place, "attachment", f"{size} bytes in it", f"{length}")
            pieces.append(self._take(size))
            return pieces[-1]

        names = [str(sized(_SIZE), "utf-8") for _ in range(2)]
        log_time, create_time = _TIMES.unpack_from(pieces[0], _HEAD.size)
        stored = Stored(names[0], (sized(_LONG),), names[1], create_time, log_time)
        pieces.append(self._take(_SIZE.size))
        head, content, crc = stored.record()
        good = (b"".join(pieces[:-2]), pieces[-2:]) == (head, [content, crc]) and self.place == end
        require(
            good, f"attachment {stored.name}", "a record with more in it", "as gapath writes it"
        )
        for piece in pieces:
            self._crc = zlib.crc32(piece, self._crc)
        self._summary.attachment(offset, length, stored)
        unpacked = stored.unpacked(most - self._attached + stored.size)
        self._attached += unpacked.size - stored.size
        return unpacked

    def _opened(self, offset: int, data: bytes) -> Iterator[Entry]:
        chunk = chunk_of(data, self._limits)
        self._inflated += chunk.uncompressed_size
        most = self._limits.log
        require(self._inflated <= most, "inflated size", self._inflated, _at_most(most))
        places: list[Place] = []
        for place, entry in self._inside.entries(inflated(chunk)):
            if isinstance(entry, Message):
                places.append(Place(place, entry.channel_id, entry.log_time))
            elif isinstance(entry, Schema):
                self._summary.schema(entry)
            else:
                self._summary.channel(entry)
            yield entry
        times = [place.time for place in places]
        require(bool(times), f"chunk at byte {offset}", "no messages", "some")
        found, right = (chunk.message_start_time, chunk.message_end_time), (min(times), max(times))
        require(found == right, f"times of the chunk at byte {offset}", found, str(right))
        follows = self._summary.chunk(offset, len(data), chunk, places)
        count, most = self._summary.messages, self._limits.messages
        require(count <= most, "messages", count, _at_most(most))
        where = f"index after the chunk at byte {offset}"
        there = self._take(len(follows))
        require(there == follows, where, "another one", "that of its messages")
        self._crc = zlib.crc32(there, self._crc)

    def end(self) -> None:
        """Read what stands behind the data, up to the end of the file."""
        for name, right in self._summary.parts(self.place):
            there = self._take(len(right))
            require(there == right, f"summary, {name}", "something else", "what the log holds")
        left = self.size - self.place
        require(not left, "end of file", f"{left} more bytes", "none after the log")


class Inside:
    """Opens chunks one after another; knows which schemas and channels there were so far."""

    def __init__(self) -> None:
        self._schemas: dict[int, str] = {}
        self._topics: dict[int, str] = {}

    def entries(self, data: bytes) -> Iterator[tuple[int, Schema | Channel | Message]]:
        """Give what an inflated chunk holds, and where each begins."""
        for place, entry in inside(data):
            if isinstance(entry, Message):
                known, number = entry.channel_id in self._topics, entry.channel_id
                require(known, "message", f"one on channel {number}", "one on a channel")
            elif isinstance(entry, Schema):
                self._schema(entry)
            else:
                self._channel(entry)
            yield place, entry

    def _schema(self, schema: Schema) -> None:
        new = schema.id == len(self._schemas) + 1 and schema.name not in self._schemas.values()
        known = schema.name in TOPICS.values() and new
        require(known, f"schema {schema.id}", schema.name, "another one of gapath's topics")
        self._schemas[schema.id] = schema.name

    def _channel(self, channel: Channel) -> None:
        topic, number = channel.topic, channel.id
        new = number == len(self._topics) + 1 and topic not in self._topics.values()
        known = new and topic in TOPICS
        require(known, f"channel {number}", topic, "another one of gapath's topics")
        name = self._schemas.get(channel.schema_id)
        require(name == TOPICS[topic], f"channel {topic}, schema", name, TOPICS[topic])
        self._topics[number] = topic


def inside(data: bytes) -> Iterator[tuple[int, Schema | Channel | Message]]:
    """Give the records within what a chunk inflates to, and where each begins."""
    place = 0
    while place < len(data):
        opcode, length = _HEAD.unpack_from(data, place)
        begin, end = place + _HEAD.size, place + _HEAD.size + length
        require(end <= len(data), "record in a chunk", f"{length} bytes", "as many as are left")
        if opcode == Opcode.MESSAGE:
            require(length >= _MESSAGE.size, "message", f"{length} bytes", f"{_MESSAGE.size}")
            number, sequence, time, published = _MESSAGE.unpack_from(data, begin)
            inner = data[begin + _MESSAGE.size : end]
            yield place, Message(number, time, inner, published, sequence)
        elif opcode == Opcode.SCHEMA:
            yield place, read(Schema, data[place:end])
        else:
            good = "a schema, channel or message"
            require(opcode == Opcode.CHANNEL, "record in a chunk", f"one of kind {opcode}", good)
            yield place, read(Channel, data[place:end])
        place = end


def chunk_of(data: bytes, limits: Limits) -> Chunk:
    """Read a chunk's record: nothing is inflated yet, but how much it would be is checked."""
    start, end, size, crc = _CHUNK.unpack_from(data, _HEAD.size)
    begin = _HEAD.size + _CHUNK.size
    kind = data[begin : begin + len(_ZSTD)]
    require(kind == _ZSTD, "compression", kind[4:], "zstd")
    begin += len(_ZSTD)
    (length,) = struct.unpack_from("<Q", data, begin)
    packed = memoryview(data)[begin + 8 :]
    require(length == len(packed), "chunk", f"{length} bytes", f"{len(packed)}")
    most = min(limits.chunk, max(_SMALL, _RATIO * length))
    require(size <= most, "inflated size", f"{size} bytes in a chunk", _at_most(most))
    return Chunk("zstd", packed, end, start, crc, size)


def inflated(chunk: Chunk) -> bytes:
    """Inflate a chunk."""
    # The frame's own header decides how much is allocated, so it must not lie either.
    size = zstandard.frame_content_size(chunk.data)
    require(size == chunk.uncompressed_size, "chunk", f"{size} bytes", str(chunk.uncompressed_size))
    data = zstandard.ZstdDecompressor().decompress(chunk.data, allow_extra_data=False)
    crc = zlib.crc32(data)
    require(crc == chunk.uncompressed_crc, "chunk", f"CRC {crc}", str(chunk.uncompressed_crc))
    return data


def read(kind: type[R], data: bytes) -> R:
    """Read a record, which must be written as it would be now: that covers its checksum, too."""
    record: Any = kind.read(ReadDataStream(BytesIO(data[_HEAD.size :])))
    good = encoded(record) == data
    require(good, kind.__name__.lower(), "a record with more in it", "as gapath writes it")
    found: R = record
    return found


def _at_most(most: int) -> str:
    return f"at most {most}; a log that is larger for a reason: --large"
