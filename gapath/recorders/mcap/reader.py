"""Reading a log, which may come from anywhere.

Nothing is inflated before its size is known, and whatever is wrong is one `InputError`
that names the file.
"""

import contextlib
import io
import os
import zlib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any, TypeVar

import zstandard
from mcap.exceptions import EndOfFile
from mcap.records import Attachment, Channel, Chunk, DataEnd, Header, Message, Metadata
from mcap.stream_reader import StreamReader

from gapath.errors import InputError, require
from gapath.events import Event, RunStarted
from gapath.recorders.mcap import description
from gapath.recorders.mcap.cdr import Record
from gapath.recorders.mcap.format import LIBRARY, MAX_CHUNK, MAX_LOG, NS_PER_STEP, PROFILE
from gapath.recorders.mcap.messages import event

_WHOLE = "a whole log of gapath"
_BEGUN = "a log of gapath that is whole at least up to the first message"

T = TypeVar("T")


def read_events(path: str | Path) -> Iterator[Event]:
    """Read a whole log.

    The file is checked from end to end before the first event is given.

    Parameters
    ----------
    path : str or Path
        A log written by `Recorder`.

    Yields
    ------
    Event
        The very events that were recorded.

    Raises
    ------
    InputError
        If the file cannot be read, is not a log of gapath, has another version, is cut
        off or damaged, or would inflate to more than `MAX_CHUNK` or `MAX_LOG`.
    """
    try:
        with _refusing(path, _WHOLE), Path(path).open("rb") as file:
            ends = sum(isinstance(record, DataEnd) for record in _records(file))
            require(ends == 1, "end of data", f"{ends} records", "one")
            yield from _events(file)
    except InputError as error:
        if not _has_begun(path):
            raise
        expected = f"{error.expected}; to save the rest: gapath-log salvage {path}"
        raise InputError(error.where, error.value, expected) from error


def read_prefix(path: str | Path) -> Iterator[Event]:
    """Read a log up to where it is cut off or damaged.

    Parameters
    ----------
    path : str or Path
        A log written by `Recorder`, or what was left of one.

    Yields
    ------
    Event
        The events that are whole, in order, none missing in between.

    Raises
    ------
    InputError
        If not even the first event is whole.
    """
    with _refusing(path, _BEGUN), Path(path).open("rb") as file:
        yield from _until_damage(_events(file))


def count_messages(path: str | Path) -> Counter[str]:
    """Count the messages of each topic, up to where the log is cut off or damaged.

    Parameters
    ----------
    path : str or Path
        A log written by `Recorder`, or what was left of one.

    Returns
    -------
    Counter of str
        Number of messages by topic.

    Raises
    ------
    InputError
        If not even the run's first event is whole.
    """
    with _refusing(path, _BEGUN), Path(path).open("rb") as file:
        contents = _until_damage(_contents(file))
        return Counter(item.topic for item in contents if not isinstance(item, RunStarted))


def _has_begun(path: str | Path) -> bool:
    """Tell whether a log is whole up to its first message, so that there is something to save."""
    try:
        return next(read_prefix(path), None) is not None
    except InputError:
        return False


def _events(file: IO[bytes]) -> Iterator[Event]:
    for item in _contents(file):
        found = item if isinstance(item, RunStarted) else event(*item)
        if found is not None:
            yield found


def _contents(file: IO[bytes]) -> Iterator[RunStarted | Record]:
    """Give the run's first event, then every message."""
    text: dict[str, str] = {}
    files: dict[str, bytes] = {}
    topics: dict[int, str] = {}
    started, count = False, 0
    for record in _records(file):
        if isinstance(record, Metadata) and record.name == description.NAME:
            text = record.metadata
        elif isinstance(record, Attachment):
            files[record.name] = record.data
            if record.name == description.OPTIMAL_PATH:
                yield description.run_started(text, files)
                started = True
        elif isinstance(record, Chunk):
            require(started, "metadata", "none before the first message", "a run's description")
            for item in _inflate(record):
                if isinstance(item, Channel):
                    topics[item.id] = item.topic
                elif isinstance(item, Message):
                    # A damaged record may be skipped as one of an unknown kind.
                    require(item.sequence == count, "message", item.sequence, f"number {count}")
                    count += 1
                    step = item.log_time // NS_PER_STEP
                    yield Record(topics[item.channel_id], step, item.data)
    require(started, "metadata", "none", "a run's description")


def _records(file: IO[bytes]) -> Iterator[Any]:
    """Walk through a file from its start; chunks stay as they are, their sizes checked."""
    size = os.fstat(file.fileno()).st_size
    file.seek(0)
    inflated = 0
    reader = StreamReader(file, emit_chunks=True, validate_crcs=True, record_size_limit=size)
    for record in reader.records:
        if isinstance(record, Header):
            found = (record.profile, record.library)
            require(found == (PROFILE, LIBRARY), "profile, library", found, f"{PROFILE}, {LIBRARY}")
        elif isinstance(record, Chunk):
            inflated += record.uncompressed_size
            require(
                record.uncompressed_size <= MAX_CHUNK and inflated <= MAX_LOG,
                "inflated size",
                f"{record.uncompressed_size} bytes in a chunk, {inflated} so far",
                f"at most {MAX_CHUNK} and {MAX_LOG}",
            )
        yield record


def _inflate(chunk: Chunk) -> Iterator[Any]:
    require(chunk.compression == "zstd", "compression", repr(chunk.compression), "zstd")
    # The frame's own header decides how much is allocated, so it must not lie either.
    size = zstandard.frame_content_size(chunk.data)
    require(size == chunk.uncompressed_size, "chunk", f"{size} bytes", chunk.uncompressed_size)
    data = zstandard.ZstdDecompressor().decompress(chunk.data)
    crc = zlib.crc32(data)
    require(crc == chunk.uncompressed_crc, "chunk", f"CRC {crc}", chunk.uncompressed_crc)
    # One record at a time: small records take ten times their bytes as objects.
    with contextlib.suppress(EndOfFile):
        yield from StreamReader(io.BytesIO(data), skip_magic=True, record_size_limit=size).records


def _until_damage(items: Iterator[T]) -> Iterator[T]:
    yield next(items)  # without a first event there is nothing to read
    with contextlib.suppress(Exception):
        yield from items


@contextlib.contextmanager
def _refusing(path: str | Path, expected: str) -> Iterator[None]:
    """Turn whatever the libraries raise at a bad file into one `InputError`."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{path}: {error.where}", error.value, error.expected) from error
    except OSError as error:
        raise InputError(path, error.strerror or error, "a readable file") from error
    except Exception as error:
        raise InputError(path, f"{type(error).__name__} {error}".strip(), expected) from error
