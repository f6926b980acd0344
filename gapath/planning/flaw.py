"""What is wrong with a path, told from the path alone, whoever planned it."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.units import OBSTACLE, SCALE
from gapath.problem import CornerCutting, Problem


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
    grid = problem.map
    if path.ndim != 2 or path.shape[1] != 2 or not len(path):
        return f"shape {path.shape} instead of (n, 2)"
    if tuple(path[0]) != problem.start or tuple(path[-1]) != problem.target:
        return f"it joins {tuple(path[0])} and {tuple(path[-1])}"
    x, y = path[:, 0], path[:, 1]
    outside = (x < 0) | (x >= grid.cols) | (y < 0) | (y >= grid.rows)
    if outside.any():
        return f"{tuple(path[outside][0])} is outside the map"
    blocked = grid.table >= OBSTACLE
    if blocked[y, x].any():
        return f"{tuple(path[blocked[y, x]][0])} is an obstacle"
    if (np.abs(np.diff(path, axis=0)).max(axis=1, initial=0) != 1).any():
        return "two successive fields are not neighbours"
    if problem.corner_cutting is not CornerCutting.ALLOW:
        first, second = blocked[y[:-1], x[1:]], blocked[y[1:], x[:-1]]
        diagonal = (x[:-1] != x[1:]) & (y[:-1] != y[1:])
        cut = {
            CornerCutting.ONE_SIDE: first & second,
            CornerCutting.FORBID: first | second,
            CornerCutting.NO_DIAGONALS: np.ones_like(first),
        }[problem.corner_cutting]
        if (cut & diagonal).any():
            return "it cuts a corner"
    true_cost = int(grid.table[y, x].sum(dtype=np.int64)) / SCALE
    if cost is not None and cost != true_cost:
        return f"it costs {true_cost}, not {cost}"
    return None
