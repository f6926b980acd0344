"""What can be saved of a log that was cut off or damaged: every message of every whole chunk."""

import contextlib
import os
import struct
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO, NamedTuple

from mcap.opcode import Opcode
from mcap.records import Channel, Message

from gapath.errors import require
from gapath.events import Finished, RunFinished, RunStarted, TrialStarted
from gapath.recorders.mcap.description import NOTHING, Lost
from gapath.recorders.mcap.file.summary import MAGIC
from gapath.recorders.mcap.file.walk import LARGE, Limits, Walk, chunk_of, inflated, inside, opened
from gapath.recorders.mcap.format import NS_PER_STEP, TOPICS
from gapath.recorders.mcap.log import FILE, LogWriter
from gapath.recorders.mcap.messages import event
from gapath.recorders.mcap.reader import BEGUN, Head, read_events, refusing
from gapath.store.durable import publish

_HEAD = struct.Struct("<BQ")
_MARK = struct.pack("<I", 4) + b"zstd"
_BEFORE = _HEAD.size + 28  # bytes of a chunk's record before that
_BLOCK = 1 << 20
_PATIENCE = 4  # times the file's size that may be read in vain
_FOOTER = struct.Struct("<BQQQI")


class Saved(NamedTuple):
    """What was saved.

    Parameters
    ----------
    messages : int
        How many messages.
    lost : Lost
        What is missing before the last one.
    """

    messages: int
    lost: Lost


def salvage(path: str | Path, output: str | Path, limits: Limits = LARGE) -> Saved:
    """Write what is whole of a log that is not as a log of its own.

    Parameters
    ----------
    path : str or Path
        A log without an end, such as ``run.mcap.part``, or a damaged one.
    output : str or Path
        The new log; must not exist.
    limits : Limits
        What it may take.

    Returns
    -------
    Saved
        What is in it; the new log was read back to check it.

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
    with opened_regular(path) as file:
        with refusing(path, f"{BEGUN}: there is nothing whole in it"):
            head, run, place = _begin(file, limits)
            lost, count = _lost(file, place, limits, run.trials)
        with tempfile.TemporaryDirectory(dir=output.parent) as folder:
            whole = Path(folder) / FILE
            with whole.open("wb") as new:
                writer = LogWriter(new, head.text["gapath_log_version"], lost)
                for _ in writer.begin(run):
                    pass
                for topic, m in _messages(file, place, limits):
                    for _ in writer.put(topic, m.log_time, m.data, m.publish_time, m.sequence):
                        pass
                writer.finish()
                new.flush()
                os.fsync(new.fileno())
            for _ in read_events(whole, limits):
                pass
            publish(whole, output)
    return Saved(count, lost)


@contextlib.contextmanager
def opened_regular(path: str | Path) -> Iterator[IO[bytes]]:
    """Open the damaged log; what goes wrong later is not its fault."""
    with contextlib.ExitStack() as stack:
        with refusing(path, BEGUN):
            file = stack.enter_context(opened(path))
        yield file


def _begin(file: IO[bytes], limits: Limits) -> tuple[Head, RunStarted, int]:
    """Read the run's first event, which must be whole; give where the chunks begin."""
    walk, head, run = Walk(file, limits), Head(), None
    walk.begin()
    while run is None:
        for entry in walk.step() or ():
            good = not isinstance(entry, Message | Channel)
            require(good, "metadata", "none before the first message", "a run's description")
            run = run or head.take(entry)  # type: ignore[arg-type]
    require(head.lost == NOTHING, "log", "one that was saved already", "a log as it was written")
    return head, run, walk.place


def _messages(file: IO[bytes], place: int, limits: Limits) -> Iterator[tuple[str, Message]]:
    """Give all messages of whole chunks, and their topics, in the order of their numbers."""
    topics, count = _told_channels(file, limits), 0
    for data in _chunks(file, place, limits):
        for _, entry in inside(data):
            if isinstance(entry, Channel) and entry.topic in TOPICS:
                topics[entry.id] = entry.topic
            elif not isinstance(entry, Message) or entry.sequence < count:
                continue
            elif topic := topics.get(entry.channel_id):
                count = entry.sequence + 1
                yield topic, entry


def _told_channels(file: IO[bytes], limits: Limits) -> dict[int, str]:
    """Give the channels that the log's end repeats: those within may be in a damaged chunk."""
    topics: dict[int, str] = {}
    with contextlib.suppress(Exception):  # there may be no end
        end = os.fstat(file.fileno()).st_size - len(MAGIC) - _FOOTER.size
        file.seek(end)
        opcode, _, begin, _, _ = _FOOTER.unpack(file.read(_FOOTER.size))
        if opcode == Opcode.FOOTER and end - begin <= limits.chunk:
            file.seek(begin)
            for _, entry in inside(file.read(end - begin)):
                if isinstance(entry, Channel) and entry.topic in TOPICS:
                    topics[entry.id] = entry.topic
    return topics


def _chunks(file: IO[bytes], place: int, limits: Limits) -> Iterator[bytes]:
    """Find all whole chunks from a place on, and give what they inflate to.

    No length is believed but of a chunk whose checksum is right: what lies between two of them
    is searched for the next one.
    """
    size = os.fstat(file.fileno()).st_size
    patience, inflating, least = _PATIENCE * size + _BLOCK, limits.log, place
    while place < size and patience > 0:
        file.seek(place)
        block = file.read(_BLOCK)
        patience -= len(block) if len(block) == _BLOCK else 0
        found = block.find(_MARK)
        if found < 0:
            place += max(len(block) - len(_MARK) + 1, 1)
            continue
        begin, place = place + found - _BEFORE, place + found + 1
        file.seek(max(begin, 0))
        head = file.read(_HEAD.size)
        if begin < least or head[:1] != bytes([Opcode.CHUNK]):
            continue
        (length,) = _HEAD.unpack(head)[1:]
        if length > min(limits.chunk, size - begin):
            continue
        patience -= length
        with contextlib.suppress(Exception):  # whatever the libraries raise at what is no chunk
            data = inflated(chunk_of(head + file.read(length), limits))
            inflating -= len(data)
            require(inflating >= 0, "inflated size", f"over {limits.log}", "less")
            place = least = begin + _HEAD.size + length
            patience += length
            yield data


def _lost(file: IO[bytes], place: int, limits: Limits, trials: int) -> tuple[Lost, int]:
    """Tell which messages are missing, which trials lack some, and how many messages there are."""
    gaps: list[tuple[int, int]] = []
    whole: set[int] = set()
    current, last, count, total = None, -1, 0, 0
    for topic, message in _messages(file, place, limits):
        total += 1
        if message.sequence != count:
            gaps.append((count, message.sequence - 1))
            current = None
        count = message.sequence + 1
        found = event(topic, message.log_time // NS_PER_STEP, message.data)
        trial = trials - 1 if isinstance(found, RunFinished) else getattr(found, "trial", -1)
        last = max(last, trial)
        if isinstance(found, TrialStarted):
            current = trial
        if isinstance(found, Finished) and trial == current:
            whole.add(trial)
    if not gaps:
        return NOTHING, total
    require(last < 10**6, "trial", last, "one of 10^6")
    there = whole | ({current} if current is not None else set())
    return Lost(tuple(gaps), frozenset(range(last + 1)) - there), total
