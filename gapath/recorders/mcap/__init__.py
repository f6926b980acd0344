"""The log: every event of a run in one MCAP file, and the events back from it."""

from gapath.recorders.mcap.log import FILE, Recorder, salvage
from gapath.recorders.mcap.reader import count_messages, read_events, read_prefix

__all__ = ["FILE", "Recorder", "count_messages", "read_events", "read_prefix", "salvage"]
