"""The path that a robot follows, step by step, as what it sees cuts it."""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.events import DriveStarted, Event, PathsChanged, Stepped
from gapath.kernels.lines import BLOCKED, CORNER, ENDS, path_sum
from gapath.kernels.units import SCALE
from gapath.problem import Problem, no_path


class Followed(NamedTuple):
    """What a robot follows at the end of a step, after it looked and moved."""

    path: NDArray[np.int32]
    """(n, 2) fields (x, y) of its current path, its own first, as far as it knows them to be free;
    none without a path."""
    cut: bool
    """Whether the path goes on, but not freely."""
    left: float
    """KG18 eq. (5) of the whole rest of the path, on what it knew when it decided, before it
    looked; NaN without a path that was free then."""


def followed(problem: Problem, events: Iterable[Event]) -> list[Followed]:
    """Tell what the robot followed at the end of each step of a drive, its first look included.

    Parameters
    ----------
    problem : Problem
        The true map, start, target and corner-cutting rule.
    events : iterable of Event
        The drive's.

    Returns
    -------
    list of Followed
        One for each `Stepped`.
    """
    grid, rule = problem.map, int(problem.corner_cutting)
    known = np.zeros((grid.rows, grid.cols), dtype=np.int32)
    path, found = no_path(), []
    for event in events:
        match event:
            case DriveStarted():
                known[:] = int(event.unknown_weight * SCALE + 0.5)
                for x, y in (problem.start, problem.target):
                    known[y, x] = grid.table[y, x]
            case PathsChanged():
                path = event.path
            case Stepped():
                if len(path) > 1 and tuple(path[1].tolist()) == event.place:
                    path = path[1:]
                total, _ = _sum(known, path, rule)
                known[event.fields[:, 1], event.fields[:, 0]] = event.entries
                wrong, at = _sum(known, path, rule)
                rest = path[:at] if wrong in (BLOCKED, CORNER) else path
                left = total / SCALE if total >= 0 else math.nan
                found.append(Followed(rest, len(rest) < len(path), left))
    return found


def _sum(known: NDArray[np.int32], path: NDArray[np.int32], rule: int) -> tuple[int, int]:
    """Give what `path_sum` does of a path to its own ends; of none that it has no ends."""
    if not len(path):
        return ENDS, 0
    (x, y), (u, v) = path[[0, -1]].tolist()
    return path_sum(known, path, (x, y), (u, v), rule)
