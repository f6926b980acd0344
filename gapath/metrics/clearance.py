"""Clearance of a path: its least distance to an obstacle; beyond the map all are obstacles."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from gapath.grid import GridMap
from gapath.problem import Plan, Problem

TITLE = "Clearance, fields"


@lru_cache(maxsize=1)  # a run has one map
def distances(grid: GridMap) -> NDArray[np.float64]:
    """Compute the distance of every field to the nearest obstacle or the border.

    Parameters
    ----------
    grid : GridMap
        The map.

    Returns
    -------
    (rows, cols) float64
        Euclidean distance between centres, in fields.
    """
    from scipy.ndimage import distance_transform_edt

    free = np.pad(~grid.obstacles, 1, constant_values=False)
    return np.asarray(distance_transform_edt(free)[1:-1, 1:-1])


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
    x, y = plan.path[:, 0], plan.path[:, 1]
    return float(distances(problem.map)[y, x].min())
