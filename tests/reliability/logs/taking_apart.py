"""Logs taken apart and put together again by the MCAP library, every checksum right."""

from collections import deque
from dataclasses import replace
from typing import NamedTuple

from mcap.records import Attachment, Channel, Chunk, DataEnd, Header, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.writer import Writer

from gapath.recorders.mcap import description, read_events
from gapath.recorders.mcap.file.stored import Stored
from gapath.recorders.mcap.format import earlier
from gapath.recorders.mcap.log import LogWriter


class Parts(NamedTuple):
    """A log: what it says, and after how many messages its chunks end."""

    entries: list
    ends: set


def taken_apart(path):
    entries, ends, count = [], set(), 0
    with path.open("rb") as file:
        for record in StreamReader(file, emit_chunks=True).records:
            if isinstance(record, DataEnd):
                break
            if isinstance(record, Chunk):
                inside = breakup_chunk(record)
                count += sum(isinstance(entry, Message) for entry in inside)
                ends.add(count)
                entries += inside
            elif isinstance(record, Attachment):
                stored = Stored(record.name, (record.data,)).unpacked(1 << 28)
                entries.append(replace(record, name=stored.name, data=stored.parts[0]))
            elif isinstance(record, Header | Metadata):
                entries.append(record)
    return Parts(entries, ends)


def older(path, version, output):
    """Write a log's events as a log of an earlier version."""
    with output.open("wb") as file:
        writer = LogWriter(file, earlier(version))
        for event in read_events(path):
            deque(writer.write(event), maxlen=0)
        writer.finish()
    return output


def put_together(parts, path, **options):
    """Write a log of any entries; sequence numbers stay, the metadata's digest is made anew."""
    files = {e.name: Stored(e.name, (e.data,)) for e in parts.entries if isinstance(e, Attachment)}
    with path.open("wb") as file:
        writer = Writer(file, **({"chunk_size": 1 << 28, "enable_data_crcs": True} | options))
        schemas, channels, count = {}, {}, 0
        for entry in parts.entries:
            match entry:
                case Header():
                    writer.start(entry.profile, entry.library)
                case Metadata():
                    text = dict(entry.metadata)
                    if text.pop("sha256", None):
                        text["sha256"] = description._digest(text, files.values())
                    writer.add_metadata(entry.name, text)
                case Attachment():
                    times, stored = (entry.create_time, entry.log_time), files[entry.name].packed()
                    data = b"".join(stored.parts)
                    writer.add_attachment(*times, stored.name, entry.media_type, data)
                case Schema():
                    number = writer.register_schema(entry.name, entry.encoding, entry.data)
                    schemas[entry.id] = number
                case Channel():
                    told = (entry.topic, entry.message_encoding, schemas.get(entry.schema_id, 0))
                    channels[entry.id] = writer.register_channel(*told, entry.metadata)
                case Message():
                    times = entry.log_time, entry.data, entry.publish_time
                    writer.add_message(channels[entry.channel_id], *times, entry.sequence)
                    count += 1
                    if count in parts.ends:
                        writer.flush()
        writer.finish()
