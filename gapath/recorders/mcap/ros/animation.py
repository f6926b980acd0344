"""Trials of a log as a bag that moves: each epoch's best path, each step's frame of the robot.

A log holds an evolution in one message, which costs little and shows nothing move; this is made of
it when somebody wants to see that.
"""

import os
from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from mcap.records import Channel, Message, Schema, Statistics

from gapath.errors import require
from gapath.events import Event, Evolved, Finished, RunStarted, TrialStarted
from gapath.grid import GridMap
from gapath.recorders.mcap.cdr import Record, path_cdr, record, robot_frame
from gapath.recorders.mcap.file.walk import Limits
from gapath.recorders.mcap.file.write import Writer
from gapath.recorders.mcap.format import (
    ALL_TOPICS,
    LOG_VERSION,
    TOPICS,
    TYPES,
    Form,
    channel_metadata,
    schema,
)
from gapath.recorders.mcap.log import check_step
from gapath.recorders.mcap.messages import Messages
from gapath.recorders.mcap.ros.bag import METADATA, described
from gapath.recorders.mcap.sound import read_sound
from gapath.store.durable import publish, scratch

NAME = "animation.mcap"
"""Name of the bag's file."""

_CHUNK = 1 << 20


def animate(
    log: Path, folder: Path, trials: Collection[int], step_s: float, limits: Limits
) -> list[Path]:
    """Make a bag of some trials of a log, one right after another.

    Parameters
    ----------
    log : Path
        The log.
    folder : Path
        The bag; must not exist.
    trials : collection of int
        Which trials.
    step_s : float
        Seconds that a step, or an epoch, takes.
    limits : Limits
        What the log may take.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InputError
        If the log cannot be read or lacks one of the trials, a step is of no time, or there is
        something already.
    OSError
        If the bag cannot be written.
    """
    check_step(step_s, "step_s")
    require(not os.path.lexists(folder), folder, "something that is there", "a new folder")
    require(folder.parent.is_dir(), folder, "no such folder", "one within a folder")
    form, left, events = (
        Form(LOG_VERSION, round(step_s * 1e9)),
        set(trials),
        read_sound(log, limits),
    )
    run = next(events)
    assert isinstance(run, RunStarted), "the reader gives it first"
    with scratch(folder.parent) as place:
        with (place / NAME).open("wb") as file:
            bag = _Bag(Writer(file), form)
            bag.add(Messages(run, form).records(run))
            for trial, records in _trials(run, events, left, form):
                bag.add(records)
                left.discard(trial)
            bag.finish()
            file.flush()
            os.fsync(file.fileno())
        require(not left, f"{log}, trials", f"no trial {min(left, default=0)}", "some of the log")
        with (place / METADATA).open("wb") as file:
            file.write(described(NAME, bag.statistics, bag.channels))
            file.flush()
            os.fsync(file.fileno())
        folder.mkdir()
        made = [folder / NAME, folder / METADATA]
        for path in made:
            publish(place / path.name, path)
    return made


def _trials(
    run: RunStarted, events: Iterator[Event], wanted: Collection[int], form: Form
) -> Iterator[tuple[int, list[Record]]]:
    """Give the messages of each wanted trial in the order of time, the first one's from step 0."""
    numbers, messages, before, begin = frozenset(wanted), Messages(run, form), 0, 0
    records: list[Record] = []
    for event in events:
        trial = getattr(event, "trial", None)
        if trial not in numbers:
            continue
        if isinstance(event, TrialStarted):
            records, begin = [], event.step - before
        of_trial: Any = event  # so it has a step
        moved = replace(of_trial, step=of_trial.step - begin)
        for each in messages.records(moved):
            records += [each, *_frame(each)]
        records += _epochs(moved, run.problem.map, form.step_ns)
        if isinstance(moved, Finished):
            before = moved.step + _PAUSE
            yield moved.trial, sorted(records, key=lambda record: record.time)


_PAUSE = 10  # steps between the end of a trial and the next one


def _frame(pose: Record) -> Iterator[Record]:
    """Give a pose of the robot as its frame, too."""
    if pose.topic == "/pose":
        placed = TYPES.deserialize_cdr(pose.data, TOPICS[pose.topic]).pose
        where, turn = placed.position, placed.orientation
        yield robot_frame(pose.time, (where.x, where.y), (turn.z, turn.w))


def _epochs(event: Event, grid: GridMap, step_ns: int) -> Iterator[Record]:
    """Give an evolution epoch by epoch."""
    if isinstance(event, Evolved):
        told = event.evolution
        each = zip(told.way_points, told.best.tolist(), told.mean.tolist(), strict=True)
        for i, (way_points, best, mean) in enumerate(each):
            time = (event.step + i) * step_ns
            yield Record("/best", time, path_cdr(time, grid.to_metres(way_points)))
            yield record("/epoch", time, event.trial, event.call, i + 1, best, mean)


class _Bag:
    """Writes messages, a schema and a channel before the first one of each topic."""

    def __init__(self, writer: Writer, form: Form) -> None:
        self._writer, self._form = writer, form
        self._schemas: dict[str, int] = {}
        self.channels: dict[str, int] = {}
        self._count = self._size = 0

    def add(self, records: Iterable[Record]) -> None:
        """Write messages."""
        for topic, time, data in records:
            if topic not in self.channels:
                self._channel(topic)
            self._writer.message(Message(self.channels[topic], time, data, time, self._count))
            self._count += 1
            self._size += len(data)
            if self._size > _CHUNK:
                self._writer.flush()
                self._size = 0

    def _channel(self, topic: str) -> None:
        name = ALL_TOPICS[topic]
        if name not in self._schemas:
            self._schemas[name] = len(self._schemas) + 1
            self._writer.schema(Schema(self._schemas[name], schema(name), "ros2msg", name))
        self.channels[topic] = number = len(self.channels) + 1
        told = channel_metadata(topic, self._form)
        self._writer.channel(Channel(number, topic, "cdr", told, self._schemas[name]))

    @property
    def statistics(self) -> Statistics:
        """What was written."""
        return self._writer.statistics

    def finish(self) -> None:
        """Write the file's end."""
        self._writer.finish()
