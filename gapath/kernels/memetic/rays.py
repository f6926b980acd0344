"""Rays: straight lines from field to field, read up to the first step that is not free.

They cross the fields of `gapath.kernels.raster.polyline`. Where no diagonal step is allowed a ray
goes by way of one of the two fields beside it instead: the one that costs less, of equals the one
that it comes to along its longer axis.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.memetic.steps import X_BITS
from gapath.kernels.raster import HALF, SHIFT, slope
from gapath.kernels.units import ALLOW, FORBID, NO_DIAGONALS, OBSTACLE


@kernel
def ray(table: NDArray[np.int32], x0: int, y0: int, x1: int, y1: int, rule: int) -> tuple[int, int]:
    """Follow a ray up to its end or to the first step that is not free.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    x0, y0, x1, y1 : int
        Fields on the map, the first one free.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    blocked : int
        The first step, from 1 on, that is not free; 0 if all are.
    cost : int
        The sum of the fields entered before, in units of 1 / SCALE.
    """
    cols = table.shape[1]
    weights = table.ravel()
    dx, dy = x1 - x0, y1 - y0
    n = max(abs(dx), abs(dy))
    cost = np.int64(0)
    if n == 0:
        return 0, cost
    if abs(dx) >= abs(dy):
        major, along, across = np.int64(x0), np.int64(1 if dx > 0 else -1), np.int64(cols)
        minor, step = (np.int64(y0) << SHIFT) + HALF, slope(dy, n)
    else:
        major, along = np.int64(y0) * cols, np.int64(cols if dy > 0 else -cols)
        across, minor, step = np.int64(1), (np.int64(x0) << SHIFT) + HALF, slope(dx, n)
    if rule != ALLOW:
        return strict_ray(weights, major, along, minor, across, step, n, rule)
    for i in range(1, n + 1):
        major += along
        minor += step
        weight = np.int64(weights[np.uint64(major + (minor >> SHIFT) * across)])
        if weight >= OBSTACLE:
            return i, cost
        cost += weight
    return 0, cost


@kernel(inner=True)
def strict_ray(
    weights: NDArray[np.int32],
    major: int,
    along: int,
    minor: int,
    across: int,
    step: int,
    n: int,
    rule: int,
) -> tuple[int, int]:
    """Follow a ray by a rule that forbids some diagonal steps, or all.

    Parameters
    ----------
    weights : (rows * cols,) int32
        `GridMap.table`, flattened.
    major, along : int
        Where the ray begins along its longer axis, and what a step adds, as flat indices.
    minor, across, step : int
        Where it begins along the other axis, with `SHIFT` fractional bits; what a field counts
        there in flat indices; what a step adds.
    n : int
        Steps.
    rule : int
        ONE_SIDE, FORBID or NO_DIAGONALS.

    Returns
    -------
    blocked, cost : int
        As of `ray`.
    """
    cost = np.int64(0)
    column = minor >> SHIFT
    for i in range(1, n + 1):
        minor += step
        weight = np.int64(weights[np.uint64(major + along + (minor >> SHIFT) * across)])
        if weight >= OBSTACLE:
            return i, cost
        if minor >> SHIFT != column:
            first = np.int64(weights[np.uint64(major + along + column * across)])
            second = np.int64(weights[np.uint64(major + (minor >> SHIFT) * across)])
            least = min(first, second)
            if least >= OBSTACLE or (rule == FORBID and max(first, second) >= OBSTACLE):
                return i, cost
            if rule == NO_DIAGONALS:
                weight += least
            column = minor >> SHIFT
        major += along
        cost += weight
    return 0, cost


@kernel
def field_at(x0: int, y0: int, x1: int, y1: int, i: int) -> tuple[int, int]:
    """Give the field that a ray comes to with step i; with step 0 it begins."""
    n = max(abs(x1 - x0), abs(y1 - y0))
    if n == 0:
        return np.int64(x0), np.int64(y0)
    x = (np.int64(x0) << SHIFT) + HALF + i * slope(x1 - x0, n)
    y = (np.int64(y0) << SHIFT) + HALF + i * slope(y1 - y0, n)
    return x >> SHIFT, y >> SHIFT


@kernel
def append_ray(
    table: NDArray[np.int32],
    x0: int,
    y0: int,
    x1: int,
    y1: int,
    steps: int,
    rule: int,
    path: NDArray[np.uint32],
    count: int,
) -> int:
    """Write the fields of a ray's first steps, which are free, behind a path.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    x0, y0, x1, y1 : int
        Ends of the ray.
    steps : int
        How many.
    rule : int
        Corner-cutting rule.
    path : (n,) uint32
        Fields (`gapath.kernels.memetic.steps`), with room for two a step.
    count : int
        How many the path has, the ray's start the last of them.

    Returns
    -------
    int
        How many it has then.
    """
    n = max(abs(x1 - x0), abs(y1 - y0), 1)
    slope_x, slope_y = slope(x1 - x0, n), slope(y1 - y0, n)
    x, y = (np.int64(x0) << SHIFT) + HALF, (np.int64(y0) << SHIFT) + HALF
    for _ in range(steps):
        u, v = x >> SHIFT, y >> SHIFT
        x += slope_x
        y += slope_y
        if rule == NO_DIAGONALS and x >> SHIFT != u and y >> SHIFT != v:
            flat = abs(x1 - x0) >= abs(y1 - y0)
            path[count] = beside(table, u, v, x >> SHIFT, y >> SHIFT, flat)
            count += 1
        path[count] = ((y >> SHIFT) << X_BITS) + (x >> SHIFT)
        count += 1
    return count


@kernel(inner=True)
def beside(table: NDArray[np.int32], x: int, y: int, u: int, v: int, flat: bool) -> int:
    """Give the field by way of which a ray makes a diagonal step."""
    first, second = (table[y, u], table[v, x]) if flat else (table[v, x], table[y, u])
    along_x = first <= second if flat else first > second
    return (y << X_BITS) + u if along_x else (v << X_BITS) + x
