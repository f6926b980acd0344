"""What can be saved of a log that was cut off or damaged: every message of every whole chunk."""

import contextlib
import os
import struct
from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import IO, NamedTuple

from mcap.opcode import Opcode
from mcap.records import Channel, Message

from gapath.errors import InputError, require
from gapath.events import Finished, RunFinished, RunStarted, TrialStarted
from gapath.recorders.mcap.description import NOTHING, Lost
from gapath.recorders.mcap.file.summary import MAGIC
from gapath.recorders.mcap.file.walk import (
    LARGE,
    Ended,
    Limits,
    Walk,
    chunk_of,
    inflated,
    inside,
    opened,
)
from gapath.recorders.mcap.format import TOPICS
from gapath.recorders.mcap.log import FILE, LogWriter
from gapath.recorders.mcap.messages import event
from gapath.recorders.mcap.reader import BEGUN, Head, read_events, refusing
from gapath.store.durable import named, publish, scratch

_HEAD = struct.Struct("<BQ")
_MARK = struct.pack("<I", 4) + b"zstd"
_BEFORE = _HEAD.size + 28  # bytes of a chunk's record before that
_BLOCK = 1 << 16
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
        If there is nothing to save, or the output exists, has no folder or cannot be written.
    """
    output = Path(output)
    require(output.parent.is_dir(), output, "no such folder", "a file in an existing folder")
    require(not output.exists(), output, "a file that exists", "a new name")
    with named(output), scratch(output.parent) as folder:
        whole = folder / FILE
        saved = _saved(path, whole, limits)
        deque(read_events(whole, limits), maxlen=0)
        publish(whole, output)
    return saved


def _saved(path: str | Path, whole: Path, limits: Limits) -> Saved:
    """Write what is whole; here, so that its map is gone when another reads it back."""
    with refusing(path, BEGUN):  # what goes wrong later is not the damaged log's fault
        file = opened(path)
    with file:
        with refusing(path, BEGUN):
            try:
                head, run, place = _begin(file, limits)
            except Ended as error:
                raise InputError("log", "nothing whole in it", BEGUN) from error
            lost, count = _lost(file, place, limits, run.trials, head.form.step_ns)
            require(count > 0, "messages", "nothing whole in it", "at least a chunk that is")
        with whole.open("wb") as new:
            writer = LogWriter(new, head.form, lost)
            deque(writer.begin(run), maxlen=0)
            for topic, m in _messages(file, place, limits):
                for _ in writer.put(topic, m.log_time, m.data, m.publish_time, m.sequence):
                    pass
            writer.finish()
            new.flush()
            os.fsync(new.fileno())
    return Saved(count, lost)


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
    topics, count, most = _told_channels(file, limits), 0, limits.messages
    for data in _chunks(file, place, limits):
        for _, entry in inside(data):
            most -= 1
            require(most >= 0, "messages", f"over {limits.messages}", "fewer, or --large")
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
    inflating, in_vain, tries, least = limits.log, _PATIENCE * size, limits.messages // 10, place
    while place < size and in_vain > 0 and tries > 0:
        file.seek(place)
        block, data = file.read(_BLOCK), None
        found = block.find(_MARK)
        while found >= 0 and data is None and in_vain > 0 and tries > 0:
            begin = place + found - _BEFORE
            found = block.find(_MARK, found + 1)
            record = (
                _chunk_at(file, begin, min(limits.chunk, size - begin)) if begin >= least else b""
            )
            with contextlib.suppress(Exception):  # whatever the libraries raise at what is none
                data = inflated(chunk_of(record, limits))
                least = begin + len(record)
            in_vain -= len(record) if data is None else 0
            tries -= 1
        if data is None:
            place += max(len(block) - len(_MARK) + 1, 1)
            continue
        place, inflating = least, inflating - len(data)
        require(inflating >= 0, "inflated size", f"over {limits.log}", "less, or --large")
        yield data


def _chunk_at(file: IO[bytes], begin: int, most: int) -> bytes:
    """Give the record that begins somewhere, if it can be a chunk's."""
    file.seek(begin)
    head = file.read(_HEAD.size)
    opcode, length = _HEAD.unpack(head)
    fits = opcode == Opcode.CHUNK and _HEAD.size + length <= most
    return head + file.read(length) if fits else b""


def _lost(
    file: IO[bytes], place: int, limits: Limits, trials: int, step_ns: int
) -> tuple[Lost, int]:
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
        found = event(topic, message.log_time // step_ns, message.data)
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
