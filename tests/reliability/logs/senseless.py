"""Logs whose checksums are right and whose numbers are none that make sense."""

import copy
import dataclasses
import math
import struct
from dataclasses import replace

import numpy as np
from mcap.records import Channel
from taking_apart import Parts

from gapath.recorders.mcap.format import TOPICS, TYPES


def hostile(parts):
    """Give logs in which a number of a message is none that makes sense: what, log."""
    entries = parts.entries
    topics = {e.id: e.topic for e in entries if isinstance(e, Channel)}
    seen = set()
    for i, entry in enumerate(entries):
        topic = topics.get(getattr(entry, "channel_id", None), "/log")
        if not TOPICS[topic].startswith("gapath"):
            continue
        message = TYPES.deserialize_cdr(entry.data, TOPICS[topic])
        for name, what, value in _senseless(message):
            if (topic, name, what) in seen:
                continue
            seen.add((topic, name, what))
            changed = copy.copy(message)
            object.__setattr__(changed, name, value)
            try:
                data = bytes(TYPES.serialize_cdr(changed, TOPICS[topic], little_endian=True))
            except (struct.error, OverflowError):
                continue
            if data == entry.data:
                continue
            new = [*entries[:i], replace(entry, data=data), *entries[i + 1 :]]
            yield f"{topic}.{name} {what}", Parts(new, parts.ends)


def _senseless(message):
    for each in dataclasses.fields(message):
        value = getattr(message, each.name)
        if isinstance(value, np.ndarray):
            small, large = _ends(value.dtype)
            for what, number in (("least", small), ("most", large), ("zero", 0)):
                yield each.name, f"all {what}", np.full_like(value, number)
                if value.size:
                    yield each.name, f"last {what}", np.append(value[:-1], value.dtype.type(number))
            yield each.name, "emptied", value[:0]
            yield each.name, "shorter", value[:-1]
            yield each.name, "thrice", np.tile(value, 3)
        elif isinstance(value, float):
            for number in (math.nan, math.inf, -math.inf, 1e308, -1.0):
                yield each.name, str(number), number
        elif isinstance(value, int) and not each.name.startswith("__"):
            for number in (0, 1, 9, 255, 2**31 - 1, -1, -(2**31), 2**32 - 1, 2**63, 2**64 - 1):
                yield each.name, str(number), number
        elif isinstance(value, str):
            yield each.name, "obeyed", "\x1b[2J"
            yield each.name, "long", "x" * 10**5


def _ends(dtype):
    return (
        (-math.inf, math.nan) if dtype.kind == "f" else (np.iinfo(dtype).min, np.iinfo(dtype).max)
    )
