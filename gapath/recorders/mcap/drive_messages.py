"""The events of drives as ROS 2 messages in CDR, and back."""

import math
import struct
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gapath.events import (
    Called,
    DriveFinished,
    DriveStarted,
    Event,
    Mode,
    Outcome,
    PathsChanged,
    RunStarted,
    Stepped,
)
from gapath.recorders.mcap.cdr import (
    ENCAPSULATION,
    INFO,
    WARN,
    Record,
    answer_numbers,
    arrays_cdr,
    in_metres,
    log_record,
    occupancy_grid_cdr,
    path_cdr,
    per_cent,
    pose_record,
    read_answer,
    stamp_again,
    strings_cdr,
)

_FIELDS_A_STEP = 1 << 14
"""Fields of the known map that a step may log on average: larger maps are shown less often."""

_INT32 = np.dtype("<i4")
_STEP = struct.Struct("<QiiBB2x")  # padded for the count that follows
_CALL = struct.Struct("<QQQQQdddIB?2x")
_TRIAL = struct.Struct("<Q")
_BEGIN = struct.Struct("<QdII")
_END = struct.Struct("<QQQB")


def _turns() -> list[tuple[float, float]]:
    """Give z and w of the eight headings' quaternions; square roots are equal everywhere."""
    half, eighth = math.sqrt(0.5), math.sqrt(0.125)
    long, short = math.sqrt(0.5 + eighth), math.sqrt(0.5 - eighth)  # of 22.5 degrees
    right = [(0.0, 1.0), (-short, long), (-half, half), (-long, short)]  # headings go clockwise
    left = [(1.0, 0.0), (long, short), (half, half), (short, long)]
    return right + left


class DriveMessages:
    """Turns the events of drives into messages; keeps what the robot knows.

    Parameters
    ----------
    run : RunStarted
        The run's first event, for its map.
    step_ns : int
        Nanoseconds that a step counts.
    """

    def __init__(self, run: RunStarted, step_ns: int) -> None:
        self._step_ns = step_ns
        self._grid = grid = run.problem.map
        self._metres = lru_cache(maxsize=1 << 16)(partial(in_metres, grid))  # 11 us a field
        self._every = -(-grid.weights.size // _FIELDS_A_STEP)
        z, w = math.sin(grid.origin[2] / 2), math.cos(grid.origin[2] / 2)
        self._turns = [(z * c + w * s, w * c - z * s) for s, c in _turns()]
        # A message that stays, in which only the time and what is new change.
        known = np.full(grid.weights.shape, -1, dtype=np.int8)
        x, y = zip(run.problem.start, run.problem.target, strict=True)  # known from the start
        known[y, x] = per_cent(grid.table[y, x])
        self._nothing = occupancy_grid_cdr(grid, known)
        self._begin()

    def _begin(self) -> None:
        self._message = bytearray(self._nothing)
        size = self._grid.weights.size
        cells = np.frombuffer(self._message, np.int8, offset=len(self._message) - size)
        self._known = cells.reshape(self._grid.weights.shape)[::-1]  # rows from the top
        self._news = True
        self._shown = -self._every
        self._mode = Mode.EXPLORE

    def started(self, event: DriveStarted) -> Iterator[Record]:
        """Forget the drive before, and log what the robot can do."""
        self._begin()
        able = (event.unknown_weight, event.sensor_range, event.step_limit)
        time = event.step * self._step_ns
        yield Record("/drive_start", time, ENCAPSULATION + _BEGIN.pack(event.trial, *able))

    def stepped(self, event: Stepped) -> Iterator[Record]:
        """Log a step: the known map if it changed, the pose, all of it exactly."""
        step, time, fields = event.step, event.step * self._step_ns, event.fields
        if event.mode is Mode.RETURN and self._mode is not Mode.RETURN:
            yield log_record(time, INFO, f"trial {event.trial}: going back, no path was found")
        self._mode = event.mode
        if len(fields):
            self._known[fields[:, 1], fields[:, 0]] = per_cent(event.entries)
            self._news = True
        if self._news and step - self._shown >= self._every:
            yield self._known_map(step)
        yield pose_record("/pose", time, self._metres(event.place), self._turns[event.heading])
        head = _STEP.pack(event.trial, *event.place, event.heading, event.mode)
        arrays = np.asarray(fields, _INT32), np.asarray(event.entries, _INT32)
        yield Record("/drive_step", time, arrays_cdr(head, *arrays))

    def _known_map(self, step: int) -> Record:
        self._news, self._shown = False, step
        time = step * self._step_ns
        stamp_again(self._message, time)
        return Record("/known_map", time, bytes(self._message))

    def called(self, event: Called) -> Iterator[Record]:
        """Log a call of a planner."""
        answer = event.answer
        numbers = answer_numbers(answer)
        head = _CALL.pack(event.trial, *numbers, event.index, answer.status, event.adopted)
        data = arrays_cdr(head, np.asarray(answer.path, _INT32)) + strings_cdr(event.part)
        yield Record("/planner_call", event.step * self._step_ns, data)

    def paths_changed(self, event: PathsChanged) -> Iterator[Record]:
        """Log the current path and the way back, for viewers and exactly."""
        time = event.step * self._step_ns
        for topic, path in (("/current_path", event.path), ("/past_path", event.past)):
            yield Record(topic, time, path_cdr(time, self._grid.to_metres(path)))
        arrays = np.asarray(event.path, _INT32), np.asarray(event.past, _INT32)
        yield Record("/paths", time, arrays_cdr(_TRIAL.pack(event.trial), *arrays))

    def finished(self, event: DriveFinished) -> Iterator[Record]:
        """Log the end of a drive, and what it knew then."""
        if self._news:
            yield self._known_map(event.step)
        text = f"trial {event.trial}: {event.ending} after {event.steps} steps"
        time = event.step * self._step_ns
        yield log_record(time, INFO if event.outcome is Outcome.REACHED else WARN, text)
        data = ENCAPSULATION + _END.pack(event.trial, event.steps, event.stands, event.outcome)
        yield Record("/drive_end", time, data)


def _pairs(numbers: Any) -> NDArray[np.int32]:
    return np.array(numbers, dtype=np.int32).reshape(-1, 2)


def _read_step(step: int, m: Any) -> Stepped:
    entries = np.array(m.entries, dtype=np.int32)
    place = (m.x, m.y)
    return Stepped(
        step, m.trial, place, m.heading, Mode(m.mode), _pairs(m.fields), entries, math.nan
    )


def _read_call(step: int, m: Any) -> Called:
    return Called(step, m.trial, m.part, m.index, m.adopted, read_answer(m))


READERS: dict[str, Callable[[int, Any], Event]] = {
    "/drive_start": lambda step, m: DriveStarted(
        step, m.trial, m.sensor_range, m.unknown_weight, m.step_limit
    ),
    "/drive_step": _read_step,
    "/planner_call": _read_call,
    "/paths": lambda step, m: PathsChanged(step, m.trial, _pairs(m.path), _pairs(m.past)),
    "/drive_end": lambda step, m: DriveFinished(
        step, m.trial, Outcome(m.outcome), m.steps, m.stands
    ),
}
"""What turns a message of a drive back into its event, by topic."""
