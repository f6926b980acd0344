"""What is wrong with a path, told from the path alone, whoever planned it."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.lines import APART, BLOCKED, CORNER, ENDS, OUTSIDE, path_sum
from gapath.kernels.units import SCALE
from gapath.problem import Problem

_WORDS = {
    OUTSIDE: "{} is outside the map",
    BLOCKED: "{} is an obstacle",
    APART: "two successive fields are not neighbours: {} is no step further",
    CORNER: "it cuts a corner before {}",
}


def flaw(problem: Problem, path: NDArray[np.int32], cost: float | None = None) -> str | None:
    """Say what is wrong with a path, independently of the planner that made it.

    Parameters
    ----------
    problem : Problem
        Map, start, target and corner-cutting rule.
    path : (n, 2) int32
        Fields as (x, y).
    cost : float, optional
        What the planner says that it costs, KG18 eq. (5).

    Returns
    -------
    str or None
        None if the path is a solution.
    """
    if not isinstance(path, np.ndarray) or path.dtype != np.int32:
        found = path.dtype if isinstance(path, np.ndarray) else type(path).__name__
        return f"{found} instead of an array of int32"
    if path.ndim != 2 or path.shape[1] != 2 or not len(path):
        return f"shape {path.shape} instead of (n, 2)"
    ends = (problem.start, problem.target)
    total, at = path_sum(problem.map.table, path, *ends, int(problem.corner_cutting))
    if total == ENDS:
        return f"it joins {_field(path, 0)} and {_field(path, -1)}, not {ends[0]} and {ends[1]}"
    if total < 0:
        return _WORDS[total].format(_field(path, at))
    if cost is not None and cost != total / SCALE:
        return f"it costs {total / SCALE}, not {cost}, as its planner says"
    return None


def _field(path: NDArray[np.int32], at: int) -> tuple[int, ...]:
    return tuple(path[at].tolist())
