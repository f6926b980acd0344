"""The log: every event of a run in one MCAP file, and the events back from it."""

from gapath.recorders.mcap.compare import Comparison, compare
from gapath.recorders.mcap.description import Lost
from gapath.recorders.mcap.file.walk import LARGE, USUAL, Limits
from gapath.recorders.mcap.format import LOG_VERSION
from gapath.recorders.mcap.log import FILE, Recorder
from gapath.recorders.mcap.reader import answers, look, read_events, read_prefix
from gapath.recorders.mcap.salvage import Saved, salvage
from gapath.recorders.mcap.sound import read_sound

__all__ = [
    "FILE",
    "LARGE",
    "LOG_VERSION",
    "USUAL",
    "Comparison",
    "Limits",
    "Lost",
    "Recorder",
    "Saved",
    "answers",
    "compare",
    "look",
    "read_events",
    "read_prefix",
    "read_sound",
    "salvage",
]
