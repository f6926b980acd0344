"""The local path planning of Sedighi et al. 2004 (S04 Sec. II.A, Fig. 1).

The robot goes straight to the target, in horizontal and vertical moves, until something is in
the way; a planner leads it around that on a square subsection of the map; then it goes straight
on.

On a map that does not change a drive ends. Each detour ends nearer to the target, by the moves
that are left, than it began, so that without a newly seen obstacle detours come to an end; and
without having seen one since it last turned round the robot does not turn round again, but goes
back to its start.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.driving.navigation import Call, Decision, Past, Path, Situation, StreamOf
from gapath.driving.past_path import Track
from gapath.errors import Checks
from gapath.grid import Field, Table
from gapath.kernels.field_of_view import remaining_cost
from gapath.kernels.s04.genotype import MAX_SIDE
from gapath.kernels.units import OBSTACLE
from gapath.planning.planner import A_PLANNER, Particular, Planner
from gapath.problem import CornerCutting, Plan, no_path, nothing


class Memory(NamedTuple):
    """What the navigator remembers besides its track."""

    learnt: bool = True
    """An obstacle was seen since the robot last turned round."""
    passed: int = 0
    """Fields that it went back since the planner was last called."""


class Subsection(NamedTuple):
    """A square part of the known map; what it has beyond the map's border are obstacles."""

    table: Table
    corner: Field
    """The known map's field at its upper left."""
    resolution: float
    """Side of a field in metres."""

    @property
    def rows(self) -> int:
        """Number of fields from top to bottom."""
        return int(self.table.shape[0])

    @property
    def cols(self) -> int:
        """Number of fields from left to right."""
        return int(self.table.shape[1])

    def least_weight(self, start: Field, target: Field) -> int:
        """Give a bound of the fields' weights."""
        return 0


@dataclass(frozen=True)
class Navigator:
    """S04's local planning; ``conf/navigator/sedighi.yaml`` says where each value comes from.

    Parameters
    ----------
    planner : Planner
        Plans on a subsection.
    subsections : list of int
        Sides of the squares, in fields, tried in this order; what reaches no field behind the
        obstacle is left out.
    retreat_interval : int
        On its way back the robot calls the planner every so many fields.
    """

    planner: Any
    subsections: list[int]
    retreat_interval: int

    complete = False

    def __post_init__(self) -> None:
        sides = self.subsections
        check = Checks(self, "navigator")
        good = len(sides) > 0 and all(2 <= side <= MAX_SIDE for side in sides)
        check("subsections", good, f"at least one side, each from 2 to {MAX_SIDE}")
        check("planner", isinstance(self.planner, Planner), A_PLANNER)
        if isinstance(self.planner, Particular):
            largest = Subsection(np.broadcast_to(np.int32(0), 2 * (max(sides),)), (0, 0), 1.0)
            self.planner.check(Around(largest, (0, 0), (0, 0), CornerCutting.ALLOW))
        check.whole("retreat_interval", 1, 10**6)

    def begin(self, query: Situation) -> Track:
        """Begin without a path."""
        return Track(Past((query.start,)), memory=Memory())

    def step(
        self, state: Track, query: Situation, news: NDArray[np.int64], streams: StreamOf
    ) -> Decision:
        """Go on if the path is free, else straight on or around what is in the way, else back."""
        table, rule = query.map.table, int(query.corner_cutting)
        memory: Memory = state.memory
        if (table.ravel()[news] >= OBSTACLE).any():
            memory = memory._replace(learnt=True)
        path, at = state.path, state.at
        if path is not None and at + 1 < len(path) and remaining_cost(table, path, at, rule) >= 0:
            return state._replace(memory=memory).go_on()
        if state.returning and (not memory.learnt or memory.passed < self.retreat_interval):
            return state._replace(memory=memory._replace(passed=memory.passed + 1)).go_back()

        ahead = state._replace(memory=Memory(learnt=memory.learnt and not state.returning))
        line = staircase(query.start, query.target)
        blocked = table[line[:, 1], line[:, 0]] >= OBSTACLE
        if not blocked.any():
            return ahead.adopt(line).go_on()
        part, number = ("A", 0) if state.returning else ("C", 2)  # as KG18's parts
        calls: tuple[Call, ...] = ()
        for i, around in enumerate(subsections(query, line, blocked, self.subsections)):
            plan = self.planner.plan(around, streams(number, i))
            calls = (*calls, Call(part, i, on_map(plan, around), plan.feasible))
            if plan.feasible:
                return ahead.adopt(calls[-1].plan.path).go_on(calls)
        first, nearest = int(np.argmax(blocked)), min(self.subsections)
        far = np.abs(line[first] - line[0]).max() >= nearest
        if far and not calls and not state.returning:  # it is known, but no square reaches it yet
            return ahead.adopt(line[: max(2, first - nearest // 2)]).go_on()
        return state._replace(memory=Memory(memory.learnt, passed=1)).go_back(calls)


def staircase(start: Field, target: Field) -> Path:
    """Go straight in horizontal and vertical moves, as near to the straight line as they can.

    Parameters
    ----------
    start, target : (x, y)
        Two fields.

    Returns
    -------
    (n, 2) int32
        Fields from start to target, each beside the one before; no way is shorter.
    """
    (x, y), (u, v) = start, target
    width, height = abs(u - x), abs(v - y)
    right, down = 1 if u > x else -1, 1 if v > y else -1
    fields = [(x, y)]
    across = along = 0  # moves made on either axis
    while (x, y) != (u, v):
        if (2 * across + 1) * height < (2 * along + 1) * width:
            x, across = x + right, across + 1
        else:
            y, along = y + down, along + 1
        fields.append((x, y))
    return np.array(fields, dtype=np.int32)


class Around(NamedTuple):
    """What the planner is asked: from the robot to a field behind the obstacle, on a square."""

    map: Subsection
    start: Field
    target: Field
    corner_cutting: CornerCutting


def subsections(
    query: Situation, line: Path, blocked: NDArray[np.bool_], sides: list[int]
) -> Iterator[Around]:
    """Give squares around what is in the way.

    Parameters
    ----------
    query : Situation
        The robot's field and what it knows.
    line : (n, 2) int32
        The staircase to the target.
    blocked : (n,) bool
        Which of its fields are obstacles.
    sides : list of int
        Sides of the squares.

    Yields
    ------
    Around
        For each square that reaches any free field of the line behind the obstacle: from the
        robot to the last one that it reaches.
    """
    distances = np.abs(line - line[0]).max(axis=1)
    behind = ~blocked
    behind[: int(np.argmax(blocked))] = False
    for side in sides:
        reached = np.flatnonzero(behind & (distances < side))
        if len(reached):
            yield _around(query, line[reached[-1]], side)


def _around(query: Situation, sub_target: NDArray[np.int32], side: int) -> Around:
    """Cut the square out of the known map that has both fields in its middle."""
    start, target = np.array(query.start), sub_target.astype(np.int64)
    low = np.minimum(start, target)
    spare = side - 1 - np.abs(target - start)
    x, y = (int(value) for value in low - spare // 2)
    known = query.map.table
    rows, cols = known.shape
    table = np.full((side, side), OBSTACLE, dtype=np.int32)
    left, top, right, bottom = max(x, 0), max(y, 0), min(x + side, cols), min(y + side, rows)
    table[top - y : bottom - y, left - x : right - x] = known[top:bottom, left:right]
    inside = [(int(u) - x, int(v) - y) for u, v in (start, target)]
    part = Subsection(table, (x, y), query.map.resolution)
    return Around(part, inside[0], inside[1], query.corner_cutting)


def on_map(plan: Plan, around: Around) -> Plan:
    """Move a subsection's plan to where it lies on the map."""
    corner = np.array(around.map.corner, dtype=np.int32)
    return replace(plan, path=plan.path + corner, trace=nothing, lines=no_path, survey=nothing)
