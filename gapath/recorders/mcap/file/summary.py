"""What stands behind a log's messages: its end, which says again what the log holds, and where.

Viewers that seek go by it, so a log is whole only if it is right, to the last byte.
"""

import struct
import zlib
from collections.abc import Iterator
from typing import NamedTuple

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    Footer,
    McapRecord,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import MCAP0_MAGIC

from gapath.recorders.mcap.file.stored import Stored

MAGIC = MCAP0_MAGIC
"""What a file begins and ends with."""


def encoded(record: McapRecord) -> bytes:
    """Write a record as bytes."""
    builder = RecordBuilder()
    record.write(builder)
    data: bytes = builder.end()
    return data


class Place(NamedTuple):
    """Where in what its chunk inflates to a message begins, its channel and its log time."""

    begin: int
    channel: int
    time: int


class Summary:
    """Gathers what a log's end must say of it, and writes that."""

    def __init__(self) -> None:
        self._groups: dict[int, tuple[str, bytearray]] = {
            Opcode.SCHEMA: ("schemas", bytearray()),
            Opcode.CHANNEL: ("channels", bytearray()),
            Opcode.STATISTICS: ("statistics", bytearray()),
            Opcode.CHUNK_INDEX: ("index of chunks", bytearray()),
            Opcode.ATTACHMENT_INDEX: ("index of attachments", bytearray()),
            Opcode.METADATA_INDEX: ("index of metadata", bytearray()),
        }  # as bytes, which are smaller than objects
        self._counts = Statistics(0, 0, {}, 0, 0, 0, 0, 0, 0)

    @property
    def messages(self) -> int:
        """How many messages there were so far."""
        count: int = self._counts.message_count
        return count

    @property
    def statistics(self) -> Statistics:
        """Counts and times of all that was taken so far."""
        return self._counts

    def _add(self, opcode: int, record: McapRecord) -> None:
        self._groups[opcode][1].extend(encoded(record))

    def schema(self, schema: Schema) -> None:
        """Take a schema."""
        self._counts.schema_count += 1
        self._add(Opcode.SCHEMA, schema)

    def channel(self, channel: Channel) -> None:
        """Take a channel."""
        self._counts.channel_count += 1
        self._add(Opcode.CHANNEL, channel)

    def metadata(self, offset: int, length: int, record: Metadata) -> None:
        """Take metadata that lie at an offset."""
        self._counts.metadata_count += 1
        self._add(Opcode.METADATA_INDEX, MetadataIndex(offset, length, record.name))

    def attachment(self, offset: int, length: int, record: Stored) -> None:
        """Take an attachment that lies at an offset."""
        self._counts.attachment_count += 1
        times, size = (record.log_time, record.create_time), record.size
        index = AttachmentIndex(offset, length, *times, size, record.name, record.media_type)
        self._add(Opcode.ATTACHMENT_INDEX, index)

    def chunk(self, offset: int, length: int, chunk: Chunk, places: list[Place]) -> bytes:
        """Take a chunk that lies at an offset, and give what must follow it.

        Parameters
        ----------
        offset, length : int
            Where in the file its record lies.
        chunk : Chunk
            The record.
        places : list of Place
            Its messages.

        Returns
        -------
        bytes
            The index of its messages.
        """
        counts, times = self._counts, [place.time for place in places]
        if not counts.message_count:
            counts.message_start_time = times[0]
        counts.message_start_time = min(counts.message_start_time, *times)
        counts.message_end_time = max(counts.message_end_time, *times)
        counts.message_count += len(places)
        counts.chunk_count += 1
        indexes: dict[int, MessageIndex] = {}
        for begin, number, time in places:
            index = indexes.setdefault(number, MessageIndex(number, []))
            index.records.append((time, begin))
        per_channel, offsets, follows = counts.channel_message_counts, {}, b""
        for number, index in indexes.items():
            per_channel[number] = per_channel.get(number, 0) + len(index.records)
            offsets[number] = offset + length + len(follows)
            follows += encoded(index)
        self._add(
            Opcode.CHUNK_INDEX,
            ChunkIndex(
                message_start_time=chunk.message_start_time,
                message_end_time=chunk.message_end_time,
                chunk_start_offset=offset,
                chunk_length=length,
                message_index_offsets=offsets,
                message_index_length=len(follows),
                compression=chunk.compression,
                compressed_size=len(chunk.data),
                uncompressed_size=chunk.uncompressed_size,
            ),
        )
        return follows

    def parts(self, begin: int) -> Iterator[tuple[str, bytes]]:
        """Give everything that follows the end of the data.

        Parameters
        ----------
        begin : int
            Where in the file it begins.

        Yields
        ------
        (str, bytes)
            The name of a part, and the part.
        """
        self._add(Opcode.STATISTICS, self._counts)
        place, offsets, crc = begin, b"", 0
        for opcode, (name, group) in self._groups.items():
            yield name, bytes(group)
            crc = zlib.crc32(group, crc)
            offsets += encoded(SummaryOffset(opcode, place, len(group)))
            place += len(group)
        yield "offsets", offsets
        crc = zlib.crc32(offsets, crc)
        head = struct.pack("<BQQQ", Opcode.FOOTER, 20, begin, place)
        yield "footer", encoded(Footer(begin, place, zlib.crc32(head, crc)))
        yield "end", MAGIC
