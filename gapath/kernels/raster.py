"""Straight lines on the grid by DDA, in exact integer arithmetic (KG18 Sec. 3.4).

With n = max(|dx|, |dy|) field i of a line is floor(a + i d / n + 1/2), i = 0 ... n. The
line back crosses the same fields, but a mirror image may not: ties go right and down.

The kernels step a fixed-point number with 40 fractional bits instead of dividing. Its
slope is rounded up, so after i steps it lies at most n / 2**40 above the exact value; the
exact value is a multiple of 1 / (2 n), so no floor changes while 2 n**2 < 2**40.
`COORDINATE_LIMIT` keeps n far below that.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel

SHIFT = 40
HALF = 1 << (SHIFT - 1)

COORDINATE_LIMIT = 1 << 17
"""Coordinates of way points lie in [-COORDINATE_LIMIT, COORDINATE_LIMIT]."""


@kernel
def slope(d: int, n: int) -> int:
    """Give d / n with `SHIFT` fractional bits, rounded up.

    Parameters
    ----------
    d : int
        Difference along one axis, |d| <= n.
    n : int
        Number of steps, at least 1.

    Returns
    -------
    int
        ceil(d * 2**SHIFT / n).
    """
    return -((-d << SHIFT) // n)


@kernel
def polyline(way_points: NDArray[np.int32]) -> NDArray[np.int32]:
    """Rasterise the straight lines that join way points.

    Parameters
    ----------
    way_points : (w, 2) int32
        Way points as (x, y), w >= 1.

    Returns
    -------
    (n, 2) int32
        Fields from the first way point to the last, each a neighbour of the one before;
        junctions and repeated way points count once.
    """
    count = 1
    for j in range(1, way_points.shape[0]):
        dx = abs(np.int64(way_points[j, 0]) - way_points[j - 1, 0])
        dy = abs(np.int64(way_points[j, 1]) - way_points[j - 1, 1])
        count += max(dx, dy)
    fields = np.empty((count, 2), dtype=np.int32)
    fields[0, 0], fields[0, 1] = way_points[0, 0], way_points[0, 1]
    at = 1
    for j in range(1, way_points.shape[0]):
        x0, y0 = np.int64(way_points[j - 1, 0]), np.int64(way_points[j - 1, 1])
        dx, dy = way_points[j, 0] - x0, way_points[j, 1] - y0
        n = max(abs(dx), abs(dy))
        if n == 0:
            continue
        slope_x, slope_y = slope(dx, n), slope(dy, n)
        x, y = (x0 << SHIFT) + HALF, (y0 << SHIFT) + HALF
        for _ in range(n):
            x += slope_x
            y += slope_y
            fields[at, 0] = x >> SHIFT
            fields[at, 1] = y >> SHIFT
            at += 1
    return fields
