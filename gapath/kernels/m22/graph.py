"""The visibility graph over keypoints, and its shortest paths (M22 Secs II.C and II.D).

Lengths are integers, in units of 1 / SCALE pixels and rounded up, so that the straight line to
the end, rounded down, never says too much and no sum depends on its order.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import cuts_corner
from gapath.kernels.raster import HALF, SHIFT, slope
from gapath.kernels.units import ALLOW, OBSTACLE, SCALE

BLOCKED = -1
"""The length of a line that meets an obstacle."""

START, END = 0, 1
"""Numbers of the two points that every graph has; keypoints follow."""


@kernel
def line_is_free(table: NDArray[np.int32], x0: int, y0: int, x1: int, y1: int, rule: int) -> bool:
    """Tell whether a straight line would change no pixel of the picture, M22 eq. (4).

    Parameters
    ----------
    table : (rows, cols) int32
        OBSTACLE or more where an obstacle is.
    x0, y0, x1, y1 : int
        Both ends, in the picture.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    bool
        False as soon as a pixel of the line, its ends included, is an obstacle.
    """
    if table[y0, x0] >= OBSTACLE or table[y1, x1] >= OBSTACLE:
        return False
    n = max(abs(x1 - x0), abs(y1 - y0))
    if n == 0:
        return True
    slope_x, slope_y = slope(x1 - x0, n), slope(y1 - y0, n)
    x, y = (x0 << SHIFT) + HALF, (y0 << SHIFT) + HALF
    for _ in range(n):
        before_x, before_y = x >> SHIFT, y >> SHIFT
        x += slope_x
        y += slope_y
        if table[y >> SHIFT, x >> SHIFT] >= OBSTACLE:
            return False
        if rule != ALLOW and cuts_corner(table, before_x, before_y, x >> SHIFT, y >> SHIFT, rule):
            return False
    return True


@kernel
def distance(x0: int, y0: int, x1: int, y1: int) -> float:
    """Give the Euclidean distance between two pixels in units of 1 / SCALE."""
    dx, dy = np.float64(x1 - x0), np.float64(y1 - y0)
    return np.sqrt(dx * dx + dy * dy) * SCALE


@kernel
def graph_lengths(
    table: NDArray[np.int32], points: NDArray[np.int32], rule: int, lengths: NDArray[np.int64]
) -> None:
    """Measure the free lines between all pairs of points.

    Parameters
    ----------
    table : (rows, cols) int32
        OBSTACLE or more where an obstacle is.
    points : (n, 2) int32
        Pixels (x, y).
    rule : int
        Corner-cutting rule.
    lengths : (n, n) int64
        Overwritten with the lengths in units of 1 / SCALE, or BLOCKED.
    """
    n = points.shape[0]
    for i in range(n):
        x0, y0 = np.int64(points[i, 0]), np.int64(points[i, 1])
        for j in range(i + 1):
            x1, y1 = np.int64(points[j, 0]), np.int64(points[j, 1])
            length = np.int64(BLOCKED)
            if line_is_free(table, x0, y0, x1, y1, rule):
                length = np.int64(np.ceil(distance(x0, y0, x1, y1)))
            lengths[i, j] = lengths[j, i] = length


@kernel
def shortest(
    lengths: NDArray[np.int64],
    points: NDArray[np.int32],
    informed: bool,
    costs: NDArray[np.int64],
    before: NDArray[np.int32],
    expansions: NDArray[np.int64],
) -> int:
    """Find the shortest path from the start to the end.

    Parameters
    ----------
    lengths : (n, n) int64
        As `graph_lengths` made it.
    points : (n, 2) int32
        Pixels (x, y).
    informed : bool
        True for A*, by the straight line to the end; False for Dijkstra.
    costs : (n,) int64
        Overwritten with the length of the way to each point; BLOCKED where none was found.
    before : (n,) int32
        Overwritten with the point before each on that way.
    expansions : (1,) int64
        Overwritten with the number of points expanded.

    Returns
    -------
    int
        The length in units of 1 / SCALE, or BLOCKED if there is no path.
    """
    n = points.shape[0]
    estimates = np.zeros(n, dtype=np.int64)
    if informed:
        for i in range(n):
            estimates[i] = np.int64(
                distance(points[i, 0], points[i, 1], points[END, 0], points[END, 1])
            )
    settled = np.zeros(n, dtype=np.bool_)
    costs[:] = BLOCKED
    costs[START] = 0
    before[START] = START
    expansions[0] = 0
    while True:
        at = -1
        for i in range(n):
            if settled[i] or costs[i] < 0:
                continue
            if at < 0 or costs[i] + estimates[i] < costs[at] + estimates[at]:
                at = i
        if at < 0 or at == END:
            return costs[END]
        settled[at] = True
        expansions[0] += 1
        for i in range(n):
            if lengths[at, i] >= 0 and not settled[i]:
                through = costs[at] + lengths[at, i]
                if costs[i] < 0 or through < costs[i]:
                    costs[i] = through
                    before[i] = at
