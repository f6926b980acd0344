"""A log against the same run done again: byte for byte, and what differs by name."""

import contextlib
import dataclasses
import io
from collections.abc import Callable, Iterator, Mapping
from itertools import chain, zip_longest
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from mcap.records import Channel, Message, Metadata, Schema

from gapath.errors import InputError
from gapath.events import Event, RunStarted
from gapath.recorders.mcap.description import LOST, Lost
from gapath.recorders.mcap.file.stored import Bytes, Stored, blocks
from gapath.recorders.mcap.file.walk import Entry, Limits, entries, opened
from gapath.recorders.mcap.format import NS_PER_STEP, TOPICS, TYPES
from gapath.recorders.mcap.log import LogWriter
from gapath.recorders.mcap.reader import ENDS, RUN_END, WHOLE, Head, refusing, suggesting


class Comparison(NamedTuple):
    """What came of it.

    Parameters
    ----------
    run : RunStarted
        The run's first event, as the log has it.
    version : str
        Of the log.
    messages : int
        How many are equal.
    difference : str
        The first thing in which the log differs; empty if all that it says is equal.
    byte : int or None
        The first byte that differs; None if none does.
    ended : bool
        Whether the log has the run's end.
    trial : int or None
        The last trial that is in it to its end.
    lost : Lost
        What it says to lack, of a log that was saved.
    """

    run: RunStarted
    version: str
    messages: int
    difference: str
    byte: int | None
    ended: bool
    trial: int | None
    lost: Lost


class _Twin:
    """A file that is only compared with another one while it is written."""

    def __init__(self, other: IO[bytes]) -> None:
        self._other, self._place = other, 0
        self.byte: int | None = None

    def write(self, data: Bytes) -> None:
        for block in blocks(data):
            if self.byte is None:
                there = self._other.read(len(block))
                if there != block:
                    self.byte = self._place + _first(there, block)
                self._place += len(block)

    def flush(self) -> None:
        pass


def compare(
    path: str | Path, again: Callable[[RunStarted], Iterator[Event]], limits: Limits
) -> Comparison:
    """Write a log anew while it is read, and compare.

    Neither log is ever in memory as a whole, and the run is done again only up to the first
    difference.

    Parameters
    ----------
    path : str or Path
        A log written by `Recorder`.
    again : callable
        Gives the events of a run of which a log says the first one, that one too, all made anew.
    limits : Limits
        What the log may take.

    Returns
    -------
    Comparison
        What came of it.

    Raises
    ------
    InputError
        If the log cannot be read, or its run not be done again.
    """
    with contextlib.ExitStack() as files:
        with refusing(path, WHOLE):
            file, other = (files.enter_context(opened(path)) for _ in range(2))
        log = _Log(path, file, limits)
        lost, twin = log.head.lost, _Twin(other)
        writer = LogWriter(twin, log.version, lost)
        difference, trial, lacking = "", None, set[int]()
        for event in again(log.run):
            skipped = writer.skipped
            for new in writer.write(event):
                difference = log.against(new)
                if difference or log.is_over:
                    break
            if writer.skipped != skipped:
                lacking.add(getattr(event, "trial", -1))
            elif log.topic in ENDS:
                trial = getattr(event, "trial", trial)
            if difference or log.is_over:
                break
        difference = difference or log.left(lost, frozenset(lacking))
        writer.finish()
        ended = log.topic == RUN_END
        return Comparison(
            log.run, log.version, log.messages, difference, twin.byte, ended, trial, lost
        )


class _Log:
    """The log that is compared, entry by entry; its last message that is equal is on `topic`."""

    def __init__(self, path: str | Path, file: IO[bytes], limits: Limits) -> None:
        rest, self.head, self.messages = _read(path, file, limits), Head(), 0
        self._topics: dict[int, str] = {}
        begun: list[Entry] = []
        run = None
        with refusing(path, WHOLE):
            while run is None:
                entry = next(rest, None)
                if not isinstance(entry, Metadata | Stored):
                    begins = _named(entry, {})
                    raise InputError("metadata", f"{begins} before them", "a run's description")
                begun.append(entry)
                run = self.head.take(entry)
        self.run, self.version = run, self.head.text["gapath_log_version"]
        self._rest = chain(begun, rest)
        self._next = next(self._rest, None)
        self._number = -1
        self.topic = ""

    @property
    def is_over(self) -> bool:
        """Whether all of it has been compared, its end included."""
        return self._next is None

    def against(self, new: Entry | None) -> str:
        """Compare what comes next; name what differs, or give an empty text."""
        old = self._next
        for entry in (new, old):
            if isinstance(entry, Channel):
                self._topics[entry.id] = entry.topic
        if _comparable(old) != _comparable(new):
            return difference(old, new, self._topics)
        if isinstance(old, Message):
            self.messages += 1
            self.topic, self._number = self._topics[old.channel_id], old.sequence
        self._next = next(self._rest, None)
        return ""

    def left(self, lost: Lost, lacking: frozenset[int]) -> str:
        """Name what the log has besides, or says to lack and does not."""
        if not self.is_over:
            return self.against(None)
        if lost.messages and lost.messages[-1][1] > self._number:
            return f"metadata {LOST}, messages: up to {lost.messages[-1][1]}, after the last one"
        found = (" ".join(map(str, sorted(trials))) for trials in (lost.trials, lacking - {-1}))
        return unequal(next(found), next(found), f"metadata {LOST}, trials")


def _read(path: str | Path, file: IO[bytes], limits: Limits) -> Iterator[Entry]:
    with suggesting(path, limits), refusing(path, WHOLE):
        yield from entries(file, limits)


def _comparable(entry: Entry | None) -> object:
    """Give what must be equal: of metadata their order, too, but not the digest of all of it.

    That one is right of whatever is there; to name it would hide what differs.
    """
    return (entry.name, _told(entry)) if isinstance(entry, Metadata) else entry


def _told(metadata: Metadata) -> list[tuple[str, str]]:
    return [(k, "" if k == "sha256" else v) for k, v in metadata.metadata.items()]


def difference(old: Entry | None, new: Entry | None, topics: Mapping[int, str]) -> str:
    """Name the first thing in which two entries differ.

    Parameters
    ----------
    old, new : Metadata, Stored, Schema, Channel, Message or None
        What the log has, and what it would be; None for nothing.
    topics : mapping of int to str
        The channels' topics.

    Returns
    -------
    str
        What it is, the field, and both values.
    """
    where = _named(old, topics)
    channels = {getattr(entry, "channel_id", 0) for entry in (old, new)}
    if old is None or new is None or type(old) is not type(new) or len(channels) > 1:
        return _both("", where, _named(new, topics))
    if isinstance(old, Metadata) and isinstance(new, Metadata):
        return _entry(old, new, where)
    names = [each.name for each in dataclasses.fields(old) if each.name not in ("data", "parts")]
    for name in names:
        if found := unequal(getattr(old, name), getattr(new, name), f"{where}, {name}"):
            return found
    found = unequal(_decoded(old, topics), _decoded(new, topics), where)
    return found or unequal(_data(old), _data(new), where)


def _entry(old: Metadata, new: Metadata, where: str) -> str:
    """Name the first entry of metadata that differs, and of text the line."""
    if old.name != new.name:
        return _both("", where, _named(new, {}))
    nothing = (None, "")
    for one, other in zip_longest(_told(old), _told(new), fillvalue=nothing):
        if one[0] != other[0]:
            return _both(f"{where}, entry", one[0], other[0])
        for pair in zip_longest(one[1].split("\n"), other[1].split("\n")):
            if pair[0] != pair[1]:
                return _both(f"{where}, {one[0]}", *pair)
    return ""


def _named(entry: Entry | None, topics: Mapping[int, str]) -> str:
    """Say what an entry is."""
    match entry:
        case Message():
            topic = topics.get(entry.channel_id, f"channel {entry.channel_id}")
            return f"message {entry.sequence}, step {entry.log_time / NS_PER_STEP:g}, {topic}"
        case Stored():
            return f"attachment {entry.name}"
        case Metadata() | Schema():
            return f"{type(entry).__name__.lower()} {entry.name}"
        case Channel():
            return f"channel {entry.topic}"
    return "nothing"


def _decoded(entry: Any, topics: Mapping[int, str]) -> Any:
    """Give what an entry's bytes mean, or the bytes where they mean nothing."""
    try:
        if isinstance(entry, Message):
            return TYPES.deserialize_cdr(entry.data, TOPICS[topics[entry.channel_id]])
        if isinstance(entry, Stored):
            return np.load(io.BytesIO(_data(entry)), allow_pickle=False)
        return entry.data.decode().split("\n")
    except Exception:  # a log may come from anywhere
        return _data(entry)


def _data(entry: Any) -> bytes:
    """Give an entry's bytes; a channel has none."""
    whole = b"".join(entry.blocks()) if isinstance(entry, Stored) else getattr(entry, "data", b"")
    return bytes(whole)


def unequal(old: Any, new: Any, where: str) -> str:
    """Name the first part in which two values differ, bit by bit.

    Parameters
    ----------
    old, new : object
        What the log has, and what it would be: messages, arrays, lists, bytes, numbers, text.
    where : str
        Name of the whole.

    Returns
    -------
    str
        Which part differs, and its two values; empty if none does.
    """
    if type(old) is not type(new):
        return _both(where, old, new)
    if dataclasses.is_dataclass(old):
        names = [each.name for each in dataclasses.fields(old) if not each.name.startswith("__")]
        parts = (unequal(getattr(old, n), getattr(new, n), f"{where}.{n}") for n in names)
        return next(filter(None, parts), "")
    if isinstance(old, list):
        pairs = enumerate(zip_longest(old, new))
        parts = (unequal(one, other, f"{where}[{i}]") for i, (one, other) in pairs)
        return next(filter(None, parts), "")
    if isinstance(old, np.ndarray):
        if (old.shape, old.dtype) != (new.shape, new.dtype):
            return _both(where, *(f"{each.dtype} {list(each.shape)}" for each in (old, new)))
        one, other = old.tobytes(), new.tobytes()
        if one == other:
            return ""
        index = tuple(map(int, np.unravel_index(_first(one, other) // old.itemsize, old.shape)))
        return _both(f"{where}{list(index)}", old[index], new[index])
    if isinstance(old, bytes) and old != new:
        place = _first(old, new)
        return _both(f"{where}, byte {place}", old[place : place + 1], new[place : place + 1])
    same = old == new and repr(old) == repr(new)  # 0.0 is not -0.0
    return "" if same or (old != old and new != new) else _both(where, old, new)


def _first(one: bytes, other: bytes) -> int:
    """Give the first place in which two byte strings differ; one may be longer."""
    size = min(len(one), len(other))
    differs = np.frombuffer(one, np.uint8, size) != np.frombuffer(other, np.uint8, size)
    return int(np.argmax(differs)) if differs.any() else size


def _both(where: str, old: object, new: object) -> str:
    return f"{where}: {_short(old)} in the log, {_short(new)} now".removeprefix(": ")


def _short(value: object) -> str:
    if value is None or value == b"":
        return "nothing"
    text = value if isinstance(value, str) else str(value)
    return text if len(text) <= _LONG else f"{text[:_LONG]}..."


_LONG = 80
