"""Clearance of a path: its least distance to an obstacle; beyond the map all are obstacles."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from gapath.grid import GridMap
from gapath.problem import Plan, Problem

TITLE = "Clearance, fields"


@lru_cache(maxsize=1)  # a run has one map
def rows_away(grid: GridMap) -> NDArray[np.int32]:
    """Count how many rows up or down each field's column has its nearest obstacle.

    Parameters
    ----------
    grid : GridMap
        The map.

    Returns
    -------
    (rows + 2, cols + 2) int32
        Of the map with a border of obstacles round it.
    """
    away = np.pad(~grid.obstacles, 1, constant_values=False).astype(np.int32)
    for y in range(1, len(away)):
        away[y] *= away[y - 1] + 1  # 0 in an obstacle
    for y in range(len(away) - 2, 0, -1):
        np.minimum(away[y], away[y + 1] + 1, out=away[y])
    return away


def measure(problem: Problem, plan: Plan) -> float:
    """Measure a path.

    Parameters
    ----------
    problem : Problem
        Its map.
    plan : Plan
        Has a path.

    Returns
    -------
    float
        Euclidean distance of the nearest field's centre to an obstacle's, in fields.
    """
    x, y = 1 + plan.path.T.astype(np.int64)
    away = rows_away(problem.map)
    least, aside = math.inf, 0
    while aside**2 < least:  # no column is beyond the border: that would have been nearer
        rows = min(int(away[y, x - aside].min()), int(away[y, x + aside].min()))
        least = min(least, aside**2 + rows**2)
        aside += 1
    return math.sqrt(least)
