"""Straight lines on the grid, read field by field: obstacle fields first, then the cost.

A path's fields are summed up in one 64-bit key: the number of obstacle fields and the sum of the
other weights are kept apart, so that a long path can never pass for a blocked one and no bit of
the cost is lost.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.raster import HALF, SHIFT, slope
from gapath.kernels.units import ALLOW, FORBID, NO_DIAGONALS, OBSTACLE, OBSTACLE_BITS, ONE_SIDE

WEIGHT_MASK = OBSTACLE - 1

KEY_BITS = 44
"""A key is (obstacle fields << KEY_BITS) + cost in units of 1 / SCALE."""
ONE_OBSTACLE = 1 << KEY_BITS
"""Keys from here on belong to infeasible paths."""
MOST_OBSTACLES = (1 << (63 - KEY_BITS)) - 1
"""Obstacle fields that a key can count; a path with more counts as one with so many."""


class Ends(NamedTuple):
    """Start and target fields."""

    start_x: int
    start_y: int
    target_x: int
    target_y: int


@kernel
def entry(table: NDArray[np.int32], x: int, y: int) -> int:
    """Read the table; outside the map lie obstacles (KG18 Sec. 3.4).

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    x, y : int
        A field, on the map or not.

    Returns
    -------
    int
        The weight in units of 1 / SCALE, or OBSTACLE.
    """
    if 0 <= x < table.shape[1] and 0 <= y < table.shape[0]:
        return np.int64(table[y, x])
    return OBSTACLE


@kernel
def cuts_corner(table: NDArray[np.int32], x0: int, y0: int, x1: int, y1: int, rule: int) -> bool:
    """Tell whether a step between neighbours breaks the corner-cutting rule.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    x0, y0, x1, y1 : int
        Two neighbouring fields.
    rule : int
        ALLOW, ONE_SIDE, FORBID or NO_DIAGONALS.

    Returns
    -------
    bool
        True if the step is forbidden.
    """
    if rule == ALLOW or x0 == x1 or y0 == y1:
        return False
    if rule == NO_DIAGONALS:
        return True
    walls = np.int64(entry(table, x1, y0) >= OBSTACLE)  # two truths of NumPy add up to one
    walls += entry(table, x0, y1) >= OBSTACLE
    return too_narrow(walls, rule)


@kernel(inner=True)
def too_narrow(walls: int, rule: int) -> bool:
    """Tell whether a diagonal step breaks the corner-cutting rule.

    A kernel that asks often counts the obstacles itself: to call one with an array costs it more
    than all the rest of the step.

    Parameters
    ----------
    walls : int
        Obstacles among the two fields that both ends of the step touch, 0 to 2.
    rule : int
        ALLOW, ONE_SIDE, FORBID or NO_DIAGONALS.

    Returns
    -------
    bool
        True if the step is forbidden.
    """
    return rule == NO_DIAGONALS or walls > (0 if rule == FORBID else 1 if rule == ONE_SIDE else 2)


ENDS, OUTSIDE, BLOCKED, APART, CORNER = range(-1, -6, -1)
"""What can be wrong with a path."""


@kernel
def path_sum(
    table: NDArray[np.int32],
    path: NDArray[np.int32],
    start: tuple[int, int],
    target: tuple[int, int],
    rule: int,
) -> tuple[int, int]:
    """Sum up the weights of a path's fields, if it is one.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    path : (n, 2) int32
        Fields as (x, y), n >= 1.
    start, target : (x, y)
        What it has to join.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    total : int
        In units of 1 / SCALE; or what is wrong: it does not join its ENDS, a field is OUTSIDE the
        map or BLOCKED by an obstacle, two successive ones are APART, or a step cuts a CORNER.
    at : int
        Index of the first field of which that is true, with the step that leads to it.
    """
    n, total = path.shape[0], np.int64(0)
    if (path[0, 0], path[0, 1]) != start or (path[n - 1, 0], path[n - 1, 1]) != target:
        return np.int64(ENDS), 0
    for i in range(n):
        x, y = np.int64(path[i, 0]), np.int64(path[i, 1])
        if not (0 <= x < table.shape[1] and 0 <= y < table.shape[0]):
            return np.int64(OUTSIDE), i
        if table[y, x] >= OBSTACLE:
            return np.int64(BLOCKED), i
        total += table[y, x]
        if i > 0:
            x0, y0 = np.int64(path[i - 1, 0]), np.int64(path[i - 1, 1])
            if max(abs(x - x0), abs(y - y0)) != 1:
                return np.int64(APART), i
            if cuts_corner(table, x0, y0, x, y, rule):
                return np.int64(CORNER), i
    return total, n


@kernel(inner=True)
def steps_inside(position: int, slope_: int, side: int, n: int) -> tuple[int, int]:
    """Find the steps at which a line is on the map along one axis.

    Parameters
    ----------
    position, slope_ : int
        Start and slope with `SHIFT` fractional bits.
    side : int
        Fields of the map along this axis.
    n : int
        Number of steps.

    Returns
    -------
    first, last : int
        Steps i with 1 <= first <= i <= last <= n; none if first > last.
    """
    limit = (side << SHIFT) - 1
    end = position + n * slope_
    if slope_ < 0:  # the mirror image: the line runs from the far side
        position, end, slope_ = limit - position, limit - end, -slope_
    first, last = 1, n
    if position < 0:
        first = (-position + slope_ - 1) // slope_ if end >= 0 else n + 1
    if end > limit:
        last = (limit - position) // slope_ if position <= limit else 0
    return first, last


@kernel
def line_key(table: NDArray[np.int32], x0: int, y0: int, x1: int, y1: int, rule: int) -> int:
    """Sum a straight line's fields, the first one left out.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    x0, y0, x1, y1 : int
        Ends of the line, within `COORDINATE_LIMIT`.
    rule : int
        Corner-cutting rule; a forbidden step counts as one obstacle field.

    Returns
    -------
    int
        The key of the line.
    """
    rows, cols = table.shape
    dx, dy = x1 - x0, y1 - y0
    n = max(abs(dx), abs(dy))
    if n == 0:
        return 0
    slope_x, slope_y = slope(dx, n), slope(dy, n)
    x, y = (x0 << SHIFT) + HALF, (y0 << SHIFT) + HALF

    # The map is convex, so the steps on it are one run; all others are obstacles.
    first, last = 1, n
    if not (0 <= x0 < cols and 0 <= x1 < cols and 0 <= y0 < rows and 0 <= y1 < rows):
        first, last = steps_inside(x, slope_x, cols, n)
        first_y, last_y = steps_inside(y, slope_y, rows, n)
        first, last = max(first, first_y), min(last, last_y)
    inside = max(last - first + 1, 0)
    obstacles = n - inside
    cost = np.int64(0)
    at_x, at_y = x + first * slope_x, y + first * slope_y
    for _ in range(inside):
        found = np.int64(table[np.uint64(at_y >> SHIFT), np.uint64(at_x >> SHIFT)])
        obstacles += found >> OBSTACLE_BITS
        cost += found & WEIGHT_MASK
        at_x += slope_x
        at_y += slope_y
    if rule != ALLOW:
        obstacles += corners_cut(table, x, y, slope_x, slope_y, n, rule)
    return (obstacles << KEY_BITS) + cost


@kernel(inner=True)
def corners_cut(
    table: NDArray[np.int32], x: int, y: int, slope_x: int, slope_y: int, n: int, rule: int
) -> int:
    """Count the steps of a line that break the corner-cutting rule.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    x, y, slope_x, slope_y : int
        Start and slope with `SHIFT` fractional bits.
    n : int
        Number of steps.
    rule : int
        ONE_SIDE, FORBID or NO_DIAGONALS.

    Returns
    -------
    int
        Number of forbidden steps.
    """
    rows, cols = table.shape
    count = 0
    for _ in range(n):
        x0, y0 = x >> SHIFT, y >> SHIFT
        x += slope_x
        y += slope_y
        x1, y1 = x >> SHIFT, y >> SHIFT
        if x0 == x1 or y0 == y1:
            continue
        walls = 2
        if 0 <= x1 < cols and 0 <= y0 < rows:
            walls -= table[np.uint64(y0), np.uint64(x1)] < OBSTACLE
        if 0 <= x0 < cols and 0 <= y1 < rows:
            walls -= table[np.uint64(y1), np.uint64(x0)] < OBSTACLE
        if too_narrow(walls, rule):
            count += 1
    return count
