"""Clearance of a path: its least distance to an obstacle; beyond the map all are obstacles."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from gapath.grid import GridMap
from gapath.problem import Plan, Problem

TITLE = "Clearance, fields"


@lru_cache(maxsize=1)  # a run has one map
def nearest(grid: GridMap) -> NDArray[np.int32]:
    """Find the nearest obstacle of every field; distances of all take three times the room.

    Parameters
    ----------
    grid : GridMap
        The map.

    Returns
    -------
    (2, rows + 2, cols + 2) int32
        Row and column of the nearest one, on the map with a border of obstacles round it.
    """
    from scipy.ndimage import distance_transform_edt

    free = np.pad(~grid.obstacles, 1, constant_values=False)
    return np.asarray(distance_transform_edt(free, return_distances=False, return_indices=True))


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
    v, u = nearest(problem.map)[:, y, x]
    return math.sqrt(((u - x) ** 2 + (v - y) ** 2).min())
