"""What a path is like, computed from its fields alone."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gapath.grid import GridMap
from gapath.kernels.units import SCALE

_EIGHTHS = np.array([[5, 6, 7], [4, 0, 0], [3, 2, 1]])
"""Heading of a step (dx, dy) in eighths of a turn, clockwise from +x, at [dy + 1, dx + 1]."""


def _steps(points: NDArray[Any]) -> NDArray[Any]:
    """Give the steps between successive points, as `numpy.diff` does in ten times the time."""
    return np.asarray(points[1:] - points[:-1])


def path_weights(grid: GridMap, path: NDArray[np.int32]) -> float:
    """Sum up the weights of a path's fields, start and target included: KG18 eq. (5).

    Parameters
    ----------
    grid : GridMap
        The map.
    path : (n, 2) int32
        Free fields (x, y).

    Returns
    -------
    float
        Exact, in multiples of 1 / SCALE.
    """
    return int(grid.table[path[:, 1], path[:, 0]].sum(dtype=np.int64)) / SCALE


def without_stands(places: NDArray[np.int32]) -> NDArray[np.int32]:
    """Leave out every place that repeats the one before.

    Parameters
    ----------
    places : (n, 2) int32
        Fields or way points as (x, y), n >= 1.

    Returns
    -------
    (m, 2) int32
        The others, in order.
    """
    moved = np.ones(len(places), dtype=np.bool_)
    steps = _steps(places)
    moved[1:] = (steps[:, 0] != 0) | (steps[:, 1] != 0)
    return np.asarray(places[moved])


def octile_length(path: NDArray[np.int32]) -> float:
    """Measure a path: 1 for a straight step, sqrt(2) for a diagonal one.

    Parameters
    ----------
    path : (n, 2) int32
        Fields (x, y), each a neighbour of the one before; n >= 1.

    Returns
    -------
    float
        In fields.
    """
    steps = _steps(path)
    diagonal = int(np.count_nonzero(steps[:, 0] * steps[:, 1]))
    return len(steps) - diagonal + diagonal * math.sqrt(2)


def heading_changes(path: NDArray[np.int32]) -> NDArray[np.int64]:
    """Give by how much the heading changes from each step to the next.

    Parameters
    ----------
    path : (n, 2) int32
        Fields (x, y), each a neighbour of the one before; n >= 1.

    Returns
    -------
    (max(n - 2, 0),) int64
        In eighths of a turn, 0 to 4.
    """
    steps = _steps(path)
    headings = _EIGHTHS[steps[:, 1] + 1, steps[:, 0] + 1]
    change = np.abs(_steps(headings)) % 8
    return np.asarray(np.minimum(change, 8 - change))


def turning(way_points: NDArray[np.int32]) -> NDArray[np.float64]:
    """Give by how much the heading changes at each way point between the ends.

    Parameters
    ----------
    way_points : (n, 2) int32
        Fields (x, y), each another one than the one before; n >= 1.

    Returns
    -------
    (max(n - 2, 0),) float64
        In radians, 0 to pi.
    """
    x, y = _steps(way_points.astype(np.float64)).T
    cross = x[:-1] * y[1:] - y[:-1] * x[1:]
    along = x[:-1] * x[1:] + y[:-1] * y[1:]
    return np.asarray(np.abs(np.arctan2(cross, along)))


def polyline_length(way_points: NDArray[np.int32]) -> float:
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
    x, y = _steps(way_points.astype(np.float64)).T
    return float(np.sqrt(x * x + y * y).sum())


def corners(path: NDArray[np.int32]) -> NDArray[np.int32]:
    """Leave out every field of a path at which it goes on as it came.

    Parameters
    ----------
    path : (n, 2) int32
        Fields (x, y), each a neighbour of the one before; n >= 1.

    Returns
    -------
    (m, 2) int32
        Its ends, and the fields at which it turns: straight lines that join them are the path.
    """
    turns = (np.diff(path, n=2, axis=0) != 0).any(axis=1)
    inner = path[1:-1][turns]
    return np.concatenate([path[:1], inner, path[len(path) - 1 :]])
