"""In what two logs differ: the first thing, by name, and both values."""

import dataclasses
import io
from collections.abc import Mapping
from itertools import zip_longest
from typing import Any

import numpy as np
from mcap.records import Channel, Message, Metadata, Schema

from gapath.recorders.mcap.file.stored import Stored
from gapath.recorders.mcap.file.walk import Entry
from gapath.recorders.mcap.format import TOPICS, TYPES


def comparable(entry: Entry | None) -> object:
    """Give what must be equal: of metadata their order, too, but not the digest of all of it.

    That one is right of whatever is there; to name it would hide what differs.
    """
    return (entry.name, _told(entry)) if isinstance(entry, Metadata) else entry


def _told(metadata: Metadata) -> list[tuple[str, str]]:
    return [(k, "" if k == "sha256" else v) for k, v in metadata.metadata.items()]


def difference(
    old: Entry | None, new: Entry | None, topics: Mapping[int, str], step_ns: int
) -> str:
    """Name the first thing in which two entries differ.

    Parameters
    ----------
    old, new : Metadata, Stored, Schema, Channel, Message or None
        What the log has, and what it would be; None for nothing.
    topics : mapping of int to str
        The channels' topics.
    step_ns : int
        Nanoseconds that a step counts.

    Returns
    -------
    str
        What it is, the field, and both values.
    """
    where = named(old, topics, step_ns)
    channels = {getattr(entry, "channel_id", 0) for entry in (old, new)}
    if old is None or new is None or type(old) is not type(new) or len(channels) > 1:
        return _both("", where, named(new, topics, step_ns))
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
        return _both("", where, named(new, {}))
    nothing = (None, "")
    for one, other in zip_longest(_told(old), _told(new), fillvalue=nothing):
        if one[0] != other[0]:
            return _both(f"{where}, entry", one[0], other[0])
        for pair in zip_longest(one[1].split("\n"), other[1].split("\n")):
            if pair[0] != pair[1]:
                return _both(f"{where}, {one[0]}", *pair)
    return ""


def named(entry: Entry | None, topics: Mapping[int, str], step_ns: int = 1) -> str:
    """Say what an entry is; of messages their step, whose length must be told."""
    match entry:
        case Message():
            topic = topics.get(entry.channel_id, f"channel {entry.channel_id}")
            return f"message {entry.sequence}, step {entry.log_time / step_ns:g}, {topic}"
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
        index = tuple(map(int, np.unravel_index(first(one, other) // old.itemsize, old.shape)))
        return _both(f"{where}{list(index)}", old[index], new[index])
    if isinstance(old, bytes) and old != new:
        place = first(old, new)
        return _both(f"{where}, byte {place}", old[place : place + 1], new[place : place + 1])
    same = old == new and repr(old) == repr(new)  # 0.0 is not -0.0
    return "" if same or (old != old and new != new) else _both(where, old, new)


def first(one: bytes, other: bytes) -> int:
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
