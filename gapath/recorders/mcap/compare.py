"""A log against the same run done again: byte for byte, and what differs by name."""

import contextlib
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from typing import IO, NamedTuple

from mcap.records import Channel, Message, Metadata

from gapath.errors import InputError
from gapath.events import Event, RunStarted
from gapath.recorders.mcap.description import LOST, Lost
from gapath.recorders.mcap.file.difference import comparable, difference, first, named, unequal
from gapath.recorders.mcap.file.stored import Bytes, Stored, blocks
from gapath.recorders.mcap.file.walk import Ended, Entry, Limits, Walk, opened
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
    torn : int
        Bytes at the end of a log that breaks off which are of no whole chunk, so not compared.
    """

    run: RunStarted
    version: str
    messages: int
    difference: str
    byte: int | None
    ended: bool
    trial: int | None
    lost: Lost
    torn: int


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
                    self.byte = self._place + first(there, block)
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
        writer = LogWriter(twin, log.head.form, lost)
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
        if log.breaks_off:
            writer.flush()
        else:
            writer.finish()
        byte = twin.byte if twin.byte is None or twin.byte < log.size else None
        ended = log.topic == RUN_END and not log.breaks_off
        return Comparison(
            log.run, log.version, log.messages, difference, byte, ended, trial, lost, log.torn
        )


class _Log:
    """The log that is compared, entry by entry; its last message that is equal is on `topic`."""

    def __init__(self, path: str | Path, file: IO[bytes], limits: Limits) -> None:
        self._walk, self.head, self.messages = Walk(file, limits), Head(), 0
        self.breaks_off = False
        rest = self._read(path, limits)
        self._topics: dict[int, str] = {}
        begun: list[Entry] = []
        run = None
        with refusing(path, WHOLE):
            while run is None:
                entry = next(rest, None)
                if not isinstance(entry, Metadata | Stored):
                    begins = named(entry, {})
                    raise InputError("metadata", f"{begins} before them", "a run's description")
                begun.append(entry)
                run = self.head.take(entry)
        self.run, self.version = run, self.head.form.version
        self._rest = chain(begun, rest)
        self._next = next(self._rest, None)
        self._number = -1
        self.topic = ""

    def _read(self, path: str | Path, limits: Limits) -> Iterator[Entry]:
        """Give all entries, of a log without its end those that are whole."""
        with suggesting(path, limits), refusing(path, WHOLE):
            self._walk.begin()
            try:
                yield from self._walk.data()
            except Ended:
                if not self.messages:
                    raise
                self.breaks_off = True
            else:
                self._walk.end()

    @property
    def torn(self) -> int:
        """Bytes at the end of a log that breaks off which are of no whole record."""
        return self._walk.torn if self.breaks_off else 0

    @property
    def size(self) -> int:
        """Bytes of the log but for those."""
        return self._walk.size - self.torn

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
        if comparable(old) != comparable(new):
            return difference(old, new, self._topics, self.head.form.step_ns)
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
