"""A file within a log, such as a map: its bytes may be an array's own, so that nobody copies it."""

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import zip_longest
from typing import TypeAlias

import zstandard
from mcap.opcode import Opcode

from gapath.errors import require

Bytes: TypeAlias = bytes | memoryview

_OCTETS = "application/octet-stream"
_ZSTD = ".zst"
_WORTH = 4  # a file is packed that gets smaller by this factor
_BLOCK = 1 << 20
_TEXT = struct.Struct("<I")


@dataclass(frozen=True, eq=False)
class Stored:
    """An attachment: what MCAP calls a file within a log.

    Parameters
    ----------
    name : str
        Its name.
    parts : tuple of bytes or memoryview
        Its content, a piece after another.
    media_type : str
        What it is.
    create_time, log_time : int
        Times, in nanoseconds.
    """

    name: str
    parts: tuple[Bytes, ...] = field(repr=False)
    media_type: str = _OCTETS
    create_time: int = 0
    log_time: int = 0

    @property
    def size(self) -> int:
        """Bytes of its content."""
        return sum(map(len, self.parts))

    def record(self) -> Iterator[Bytes]:
        """Give the record that holds it, in pieces: its head, the content, a checksum."""
        head = struct.pack("<QQ", self.log_time, self.create_time)
        for text in (self.name.encode(), self.media_type.encode()):
            head += _TEXT.pack(len(text)) + text
        head += struct.pack("<Q", self.size)
        yield struct.pack("<BQ", Opcode.ATTACHMENT, len(head) + self.size + 4) + head
        crc = zlib.crc32(head)
        for part in self.parts:
            crc = zlib.crc32(part, crc)
            yield part
        yield struct.pack("<I", crc)

    def packed(self) -> "Stored":
        """Give it compressed by zstd, its name ending in ``.zst``; itself if that is hardly less.

        Arrays of any numbers stay as they are, so that a map of them is not held twice.
        """
        packer, most = zstandard.ZstdCompressor().compressobj(size=self.size), self.size // _WORTH
        data = bytearray()
        for part in self.parts:
            for begin in range(0, len(part), _BLOCK):
                data += packer.compress(part[begin : begin + _BLOCK])
                if len(data) > most:
                    return self
        data += packer.flush()
        name = self.name + _ZSTD
        return replace(self, name=name, parts=(bytes(data),)) if len(data) <= most else self

    def unpacked(self, most: int) -> "Stored":
        """Give what was packed, of at most so many bytes; raises InputError or ZstdError."""
        if not self.name.endswith(_ZSTD):
            return self
        (data,) = self.parts
        size = zstandard.frame_content_size(data)
        fits = 0 < size <= most
        require(fits, f"attachment {self.name}", f"{size} bytes in it", f"at most {most}")
        content = zstandard.ZstdDecompressor().decompress(data, allow_extra_data=False)
        return replace(self, name=self.name.removesuffix(_ZSTD), parts=(content,))

    def blocks(self) -> Iterator[bytes]:
        """Give the content in blocks of one size, however it lies in pieces."""
        rest = b""
        for part in self.parts:
            for block in blocks(part):
                rest += block
                while len(rest) >= _BLOCK:
                    yield rest[:_BLOCK]
                    rest = rest[_BLOCK:]
        yield rest

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Stored)
            and self._told == other._told
            and all(one == two for one, two in zip_longest(self.blocks(), other.blocks()))
        )

    @property
    def _told(self) -> tuple[object, ...]:
        return self.name, self.size, self.media_type, self.create_time, self.log_time


def blocks(data: Bytes) -> Iterator[bytes]:
    """Copy bytes a block at a time."""
    for begin in range(0, len(data), _BLOCK):
        yield bytes(data[begin : begin + _BLOCK])
