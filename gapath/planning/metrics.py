"""One definition of each reported quantity, computed from the path alone.

The three papers' fitnesses cannot be compared with one another; these can.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gapath.grid import GridMap
from gapath.kernels.units import SCALE


@dataclass(frozen=True)
class PathMetrics:
    """What a table says about a path; NaN (turns: 0) where there is no path."""

    cost: float
    """KG18 eq. (5): sum of the weights of the fields, start and target included."""
    length: float
    """Octile length in fields: 1 for a straight step, sqrt(2) for a diagonal one."""
    turns: int
    """Steps whose heading differs from that of the step before."""
    clearance: float
    """Least Euclidean distance of a field's centre to an obstacle's, in fields; what lies
    outside the map is an obstacle."""
    curvature: float
    """Sum of the absolute changes of heading over the length, in radians per field."""


def clearances(grid: GridMap) -> NDArray[np.float64]:
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
    distances: NDArray[np.float64] = distance_transform_edt(free)
    return distances[1:-1, 1:-1]


def path_metrics(
    grid: GridMap, path: NDArray[np.int32], distances: NDArray[np.float64]
) -> PathMetrics:
    """Measure a path.

    Parameters
    ----------
    grid : GridMap
        The map.
    path : (n, 2) int32
        Fields (x, y), each a neighbour of the one before; may be empty.
    distances : (rows, cols) float64
        `clearances` of the map.

    Returns
    -------
    PathMetrics
        All quantities.
    """
    if not len(path):
        return PathMetrics(math.nan, math.nan, 0, math.nan, math.nan)
    x, y = path[:, 0], path[:, 1]
    cost = int(grid.table[y, x].sum(dtype=np.int64)) / SCALE
    steps = np.diff(path, axis=0)
    diagonal = int(np.count_nonzero(steps.all(axis=1)))
    length = len(steps) - diagonal + diagonal * math.sqrt(2)
    headings = _EIGHTHS[steps[:, 1] + 1, steps[:, 0] + 1]
    change = np.abs(np.diff(headings)) % 8
    change = np.minimum(change, 8 - change)
    curvature = int(change.sum()) * (math.pi / 4) / length if length else 0.0
    clearance = float(distances[y, x].min())
    return PathMetrics(cost, length, int(np.count_nonzero(change)), clearance, curvature)


def line_length(way_points: NDArray[np.int32]) -> float:
    """Measure the straight lines that join way points.

    Parameters
    ----------
    way_points : (n, 2) int32
        Fields (x, y).

    Returns
    -------
    float
        The Euclidean length, in fields.
    """
    steps = np.diff(way_points.astype(np.float64), axis=0)
    return float(np.sqrt((steps * steps).sum(axis=1)).sum())


_EIGHTHS = np.array([[5, 6, 7], [4, 0, 0], [3, 2, 1]])
"""Heading of a step (dx, dy) in eighths of a turn, clockwise from +x, at [dy + 1, dx + 1]."""
