"""Logs that were taken apart, with something altered.

What there is to alter is found in the log: a new topic, field or entry is altered, too.
"""

import copy
import dataclasses
import io
import itertools
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from mcap.records import Attachment, Channel, Header, Message, Metadata, Schema
from taking_apart import Parts

from gapath.recorders.mcap import description
from gapath.recorders.mcap.format import TOPICS, TYPES


class Altered(NamedTuple):
    """An altered log: what was done, and words of which one must be named."""

    what: str
    names: tuple
    parts: Parts


def alterations(parts):
    """Give every single alteration of what a log says."""
    entries = parts.entries
    for i, entry in enumerate(entries):
        kind = type(entry).__name__
        for what, names, new in _of_entry(entry):
            changed = [*entries[:i], *new, *entries[i + 1 :]]
            yield Altered(f"{kind}: {what}", names, Parts(changed, parts.ends))
    yield from _of_topics(parts)
    yield from _foreign(parts)
    yield from _consistent(parts)


def _of_entry(entry):
    """Alterations of one entry but messages: what, names, the entries in its place."""
    match entry:
        case Header():
            for name in ("profile", "library"):
                yield name, (name,), [replace(entry, **{name: getattr(entry, name) + "x"})]
        case Metadata():
            named = ("metadata", "gapath_log_version: got None")
            if entry.name == description.LOST:  # what is lost shows where it is
                named += ("message",)
            yield "removed", named, []
            yield "doubled", named, [entry, entry]
            yield "renamed", named, [replace(entry, name="other")]
            yield "another", named, [entry, Metadata("note", {"made": "by nobody"})]
            yield from _of_metadata(entry)
        case Attachment():
            named = (entry.name, "maps", "map", "metadata")
            yield f"{entry.name} removed", (*named, "optimal_path.npy", "queries"), []
            yield f"{entry.name} doubled", named, [entry, entry]
            for name in ("create_time", "log_time"):
                yield f"{entry.name} {name}", named, [replace(entry, **{name: 1})]
            for name in ("name", "media_type"):
                yield (f"{entry.name} {name}", (*named, "description", "optimal_path.npy"),
                       [replace(entry, **{name: getattr(entry, name) + "x"})])  # fmt: skip
            for what, array in _of_array(np.load(io.BytesIO(entry.data))):
                yield (
                    f"{entry.name} {what}",
                    (*named, "start", "target", "optimal"),
                    [replace(entry, data=npy(array))],
                )
            extra = replace(entry, name="note.txt", data=b"by nobody")
            yield "another", ("note.txt",), [extra, entry]
        case Schema():
            for name in ("name", "encoding", "data"):
                more = b"\n# more" if name == "data" else "x"
                new = replace(entry, **{name: getattr(entry, name) + more})
                yield f"{entry.name} {name}", ("schema", "channel"), [new]
        case Channel():
            for name in ("topic", "message_encoding"):
                new = replace(entry, **{name: getattr(entry, name) + "x"})
                yield f"{entry.topic} {name}", ("channel",), [new]
            new = replace(entry, metadata={"offered": "by nobody"})
            yield f"{entry.topic} metadata", ("channel",), [new]
            yield f"{entry.topic} schema", ("channel", "schema"), [replace(entry, schema_id=99)]


def _of_metadata(entry):
    text = entry.metadata
    for name, value in text.items():
        if name == "sha256":
            continue
        named = (name, "metadata", *_RELATED.get(name, ()))
        others = {key: other for key, other in text.items() if key != name}
        yield f"{name} removed", named, [replace(entry, metadata=others)]
        for what, new in _of_text(value):
            yield f"{name} {what}", named, [replace(entry, metadata=text | {name: new})]
        moved = {name: value} | others if name != next(iter(text)) else others | {name: value}
        yield f"{name} moved", named, [replace(entry, metadata=moved)]
    yield "another entry", ("metadata",), [replace(entry, metadata=text | {"note": "by nobody"})]
    lines = text.get("settings", "").splitlines(keepends=True)
    for i, line in enumerate(lines):
        name = line.partition(":")[0]
        named = (name, name.partition("[")[0], name.rpartition(".")[2], "settings", "metadata")
        rest = [*lines[:i], *lines[i + 1 :]]
        variants = {
            "removed": rest,
            "moved": [*rest, line] if i < len(lines) - 1 else [line, *rest],
        }
        for what, new in _of_text(line.rstrip("\n").partition(": ")[2]):
            variants[what] = [*lines[:i], f"{name}: {new}\n", *lines[i + 1 :]]
        for what, new in variants.items():
            changed = text | {"settings": "".join(new)}
            yield f"setting {name} {what}", named, [replace(entry, metadata=changed)]


_RELATED = {
    "method": ("/log.msg: run started",),  # a name of one's own must be the same everywhere
    "start": ("map.start",),
    "step_ns": ("message",),  # the whole log goes at another pace
}


def _of_text(text):
    try:
        number = float(text)
        yield "more", str(int(text) + 1) if text.lstrip("-").isdigit() else repr(number * 2 + 1)
    except ValueError:
        yield "more", f'{text[:-1]}x"' if text.endswith('"') else text + "x"
        if text and not text.endswith('"'):
            yield "emptied", ""
    if text.endswith('"') and len(text) > 2:
        yield "emptied", '""'
    yield "with a blank", text + " "


def npy(array):
    """Save an array as bytes."""
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def _of_array(array):
    """Arrays that differ from one in a part."""
    if array.size:
        for what, place in (("first", 0), ("last", array.size - 1)):
            changed = array.copy()
            flat = changed.reshape(-1)
            flat[place] = _other(flat[place].item(), array.dtype)
            yield what, changed
        yield "shorter", array[:-1].copy()
        yield "emptied", array[:0].copy()
    longer = array[-1:] if len(array) else np.zeros((1, *array.shape[1:]), array.dtype)
    yield "longer", np.concatenate([array, longer])


def _other(value, dtype):
    if dtype.kind == "f":
        return 0.25 if value != 0.25 else 0.75
    return value + 1 if value + 1 <= np.iinfo(dtype).max else value - 1


def _of_value(value):
    """Values that differ from one in a part: what, value."""
    if isinstance(value, np.ndarray):
        yield from _of_array(value)
    elif isinstance(value, bool | np.bool_):
        yield "turned", not value
    elif isinstance(value, int | np.integer):
        yield "one more or less", value - 1 if value > 0 else value + 1
    elif isinstance(value, float | np.floating):
        yield "a bit more", float(np.nextafter(value, np.inf)) if np.isfinite(value) else 1.0
        yield "NaN", float("nan")
    elif isinstance(value, str):
        yield "longer", value + "x"
        if value:
            yield "emptied", ""
    elif isinstance(value, list):
        if value:
            yield "shorter", value[:-1]
            yield "doubled", [*value, value[-1]]
        for i in {0, len(value) - 1} if value else ():
            for what, new in _of_value(value[i]):
                yield f"[{i}]{what}", [*value[:i], new, *value[i + 1 :]]
    elif dataclasses.is_dataclass(value):
        for each in dataclasses.fields(value):
            if not each.name.startswith("__"):
                for what, new in _of_value(getattr(value, each.name)):
                    changed = copy.copy(value)
                    object.__setattr__(changed, each.name, new)
                    yield f"{each.name} {what}", changed


def _of_topics(parts):
    """Alterations of the first and the last message of each topic."""
    entries = parts.entries
    topics = {e.id: e.topic for e in entries if isinstance(e, Channel)}
    places = {}
    for i, entry in enumerate(entries):
        if isinstance(entry, Message):
            places.setdefault(topics[entry.channel_id], []).append(i)
    for topic, found in places.items():
        for i in sorted({found[0], found[-1]}):
            entry, name = entries[i], TOPICS[topic]
            message = TYPES.deserialize_cdr(entry.data, name)
            variants = []
            for what, new in _of_value(message):
                data = bytes(TYPES.serialize_cdr(new, name, little_endian=True))
                if data != entry.data:
                    variants.append((what, [replace(entry, data=data)]))
            variants += [
                ("bytes emptied", [replace(entry, data=b"")]),
                ("bytes longer", [replace(entry, data=entry.data + b"\0")]),
                ("within the step", [replace(entry, log_time=entry.log_time + 1)]),
                ("a step later", [replace(entry, log_time=entry.log_time + STEP_NS)]),
                ("published later", [replace(entry, publish_time=entry.publish_time + 1)]),
                ("sequence", [replace(entry, sequence=entry.sequence + 1)]),
                ("removed, a gap left", []),
            ]
            for what, new in variants:
                changed = [*entries[:i], *new, *entries[i + 1 :]]
                yield Altered(f"{topic} {what}", (topic, "message"), Parts(changed, parts.ends))
            for what, changed in (
                ("removed", [*entries[:i], *entries[i + 1 :]]),
                ("doubled", [*entries[: i + 1], *entries[i:]]),
                ("moved", _swapped(entries, i)),
            ):
                named = (topic, "message", "schema", "channel", "interrupted")
                yield Altered(f"{topic} {what}", named, Parts(_numbered(changed), parts.ends))
        gone = set(found)
        rest = [e for i, e in enumerate(entries) if i not in gone]
        named = (topic, "message", "schema", "channel", "interrupted")
        yield Altered(f"{topic} all removed", named, Parts(_numbered(rest), parts.ends))


def _swapped(entries, i):
    other = next(
        (j for j in itertools.chain(range(i + 1, len(entries)), range(i - 1, 0, -1))
         if isinstance(entries[j], Message)), i,
    )  # fmt: skip
    changed = list(entries)
    changed[i], changed[other] = changed[other], changed[i]
    first = min(i, other)
    between = changed[first + 1 : max(i, other)]  # a channel, and a schema, must come before it
    told = [e for e in between if isinstance(e, Schema | Channel)]
    rest = [e for e in between if not isinstance(e, Schema | Channel)]
    last = max(i, other)
    return [*changed[:first], *told, changed[first], *rest, *changed[last:]]


def _numbered(entries):
    """Number messages anew."""
    count = itertools.count()
    return [replace(e, sequence=next(count)) if isinstance(e, Message) else e for e in entries]


def _foreign(parts):
    """Topics that no run writes to, or not this one."""
    message = next(e for e in parts.entries if isinstance(e, Message))
    schema = next(e for e in parts.entries if isinstance(e, Schema))
    own = replace(schema, id=99, name="note_msgs/msg/Note")
    for topic in ("/note", "/path"):
        extra = [own, Channel(99, topic, "cdr", {}, 99), replace(message, channel_id=99)]
        named = ("channel", "schema")
        yield Altered(f"foreign {topic}", named, Parts([*parts.entries, *extra], parts.ends))


def _consistent(parts):
    """What a liar would do who knows the format: the same lie wherever it is told."""
    (told,) = [e for e in parts.entries if isinstance(e, Metadata) and e.name == description.NAME]
    lines = told.metadata["settings"].splitlines(keepends=True)
    variants = {}
    for one, other in [*itertools.pairwise(lines)][:: max(1, len(lines) // 6)]:
        swap = {one: other, other: one}
        variants[f"{one} swapped"] = [swap.get(line, line) for line in lines]
    variants["a setting more"] = [*lines, "note: 1\n"]
    others = ("recorder", "recorder[0]", "recorder.mcap.made", "output")
    variants |= {name: [*lines, f'{name}: "by nobody"\n'] for name in others}
    for what, new in variants.items():
        named = ("settings", "metadata")
        yield Altered(f"everywhere: {what}", named, telling(parts, "settings", "".join(new)))
    for name in ("method", "experiment"):
        lie = telling(parts, name, "mine", trials=name == "method")
        yield Altered(f"everywhere: {name}", ("mine",), lie)


def telling(parts, name, value, trials=True):
    """Give a log that says something of its run in the metadata, and at each trial's start."""
    (start,) = [e.id for e in parts.entries if isinstance(e, Channel) and e.topic == TRIAL]
    changed = []
    for entry in parts.entries:
        if isinstance(entry, Metadata) and entry.name == description.NAME:
            entry = replace(entry, metadata=entry.metadata | {name: value})
        elif isinstance(entry, Message) and entry.channel_id == start and trials:
            message = TYPES.deserialize_cdr(entry.data, TOPICS[TRIAL])
            setattr(message, name, value)
            data = TYPES.serialize_cdr(message, TOPICS[TRIAL], little_endian=True)
            entry = replace(entry, data=bytes(data))
        changed.append(entry)
    return Parts(changed, parts.ends)


TRIAL = "/trial_start"
STEP_NS = 100_000_000
