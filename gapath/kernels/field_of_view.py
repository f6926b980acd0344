"""What a robot sees: a triangle of fields, its top in the robot's own field (KG18 Sec. 5).

Layer x, counted from the robot, has 2 x + 1 fields, eq. (7). For a straight heading it is a
row across it, for a diagonal one the L of the fields of the quadrant at that Chebyshev
distance.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import cuts_corner
from gapath.kernels.raster import HALF, SHIFT, slope
from gapath.kernels.units import ALLOW, OBSTACLE

# Headings 0 to 7 in eighths of a turn, clockwise from +x (y points down).
HEADING_X = np.array([1, 1, 0, -1, -1, -1, 0, 1], dtype=np.int64)
HEADING_Y = np.array([0, 1, 1, 1, 0, -1, -1, -1], dtype=np.int64)


@kernel
def heading_of(dx: int, dy: int) -> int:
    """Give the heading of a direction: one of eight.

    Parameters
    ----------
    dx, dy : int
        A direction; the zero direction has heading 0.

    Returns
    -------
    int
        0 (+x) to 7, clockwise with y down; for a direction that is no multiple of a step,
        the axis if the other component is less than half as long, else the diagonal.
    """
    if 2 * abs(dy) < abs(dx):
        dy = 0
    elif 2 * abs(dx) < abs(dy):
        dx = 0
    sign_x, sign_y = int(dx > 0) - int(dx < 0), int(dy > 0) - int(dy < 0)
    for heading in range(8):
        if HEADING_X[heading] == sign_x and HEADING_Y[heading] == sign_y:
            return heading
    return 0


@kernel(inner=True)
def is_seen(table: NDArray[np.int32], x0: int, y0: int, x1: int, y1: int) -> bool:
    """Tell whether a straight line reaches a field without crossing an obstacle before it."""
    n = max(abs(x1 - x0), abs(y1 - y0))
    if n == 0:
        return True
    slope_x, slope_y = slope(x1 - x0, n), slope(y1 - y0, n)
    x, y = (x0 << SHIFT) + HALF, (y0 << SHIFT) + HALF
    for _ in range(n - 1):
        x += slope_x
        y += slope_y
        if table[y >> SHIFT, x >> SHIFT] >= OBSTACLE:
            return False
    return True


@kernel
def sense(
    true_table: NDArray[np.int32],
    known_table: NDArray[np.int32],
    seen: NDArray[np.bool_],
    x: int,
    y: int,
    heading: int,
    layers: int,
    occlusion: bool,
    news: NDArray[np.int64],
    count: int,
    least: NDArray[np.int64],
) -> int:
    """Look in a direction and take over what is seen into the known map.

    Parameters
    ----------
    true_table : (rows, cols) int32
        The world.
    known_table : (rows, cols) int32
        What the robot believes; changed in place.
    seen : (rows, cols) bool
        Fields seen so far; changed in place.
    x, y : int
        The robot's field.
    heading : int
        0 to 7.
    layers : int
        Range of the sensor: layers 0 to this one.
    occlusion : bool
        An obstacle hides what lies behind it on a straight line.
    news : (2, n) int64
        Overwritten from `count` on with the flat indices of fields seen for the first time or
        changed, at most (layers + 1)**2, and their table entries.
    count : int
        How many news there are already.
    least : (1,) int64
        Lowered to the least of these entries.

    Returns
    -------
    int
        How many news there are now.
    """
    rows, cols = true_table.shape
    forward_x, forward_y = HEADING_X[heading], HEADING_Y[heading]
    diagonal = forward_x != 0 and forward_y != 0
    for layer in range(layers + 1):
        for i in range(-layer, layer + 1):
            if diagonal:
                # the L: along x for i <= 0, then along y for i >= 0
                along_x = layer if i >= 0 else layer + i
                along_y = layer if i <= 0 else layer - i
                u, v = x + forward_x * along_x, y + forward_y * along_y
            else:
                u = x + forward_x * layer + forward_y * i
                v = y + forward_y * layer + forward_x * i
            if not (0 <= u < cols and 0 <= v < rows):
                continue
            if occlusion and not is_seen(true_table, x, y, u, v):
                continue
            if not seen[v, u] or known_table[v, u] != true_table[v, u]:
                seen[v, u] = True
                known_table[v, u] = true_table[v, u]
                news[0, count] = v * cols + u
                news[1, count] = true_table[v, u]
                least[0] = min(least[0], news[1, count])
                count += 1
    return count


@kernel
def remaining_cost(table: NDArray[np.int32], path: NDArray[np.int32], first: int, rule: int) -> int:
    """Sum the rest of a path, its own field included.

    Parameters
    ----------
    table : (rows, cols) int32
        The known map.
    path : (n, 2) int32
        Fields as (x, y).
    first : int
        Index of the robot's own field.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    int
        The sum in units of 1 / SCALE, or -1 if an obstacle is on it or it cuts
        a corner.
    """
    cols, weights = table.shape[1], table.ravel()
    total = np.int64(0)
    for i in range(first, path.shape[0]):
        k = np.uint64(i)  # unsigned: numba looks for no sign
        found = weights[np.uint64(path[k, 1] * cols + path[k, 0])]
        if found >= OBSTACLE:
            return -1
        total += found
        if rule != ALLOW and i > first:
            x0, y0 = np.int64(path[i - 1, 0]), np.int64(path[i - 1, 1])
            if cuts_corner(table, x0, y0, np.int64(path[i, 0]), np.int64(path[i, 1]), rule):
                return -1
    return total


@kernel
def follow(
    true_table: NDArray[np.int32],
    known_table: NDArray[np.int32],
    seen: NDArray[np.bool_],
    path: NDArray[np.int32],
    fields: int,
    target: int,
    rule: int,
    layers: int,
    occlusion: bool,
    news: NDArray[np.int64],
    looks: NDArray[np.int64],
    least: NDArray[np.int64],
) -> int:
    """Go along a path, looking before each step, to the target or until it is seen to be blocked.

    Parameters
    ----------
    true_table, known_table, seen, layers, occlusion, least
        As of `sense`.
    path : (n, 2) int32
        Fields as (x, y), the robot's own first.
    fields : int
        Most steps, fewer than n.
    target : int
        Number of a field, y * cols + x, from which nobody goes on.
    rule : int
        Corner-cutting rule.
    news : (2, m) int64
        As of `sense`, look by look.
    looks : (2, fields) int64
        Overwritten with the heading of each look, and how many news there are after it.

    Returns
    -------
    int
        Number of looks. All steps were made but for the last, which may be blocked.
    """
    count = np.int64(0)
    for i in range(fields):
        x, y = np.int64(path[i, 0]), np.int64(path[i, 1])
        heading = heading_of(path[i + 1, 0] - x, path[i + 1, 1] - y)
        old = count
        count = sense(
            true_table, known_table, seen, x, y, heading, layers, occlusion, news, count, least
        )
        looks[0, i], looks[1, i] = heading, count
        learnt = i == 0
        for k in range(old, count):
            learnt |= news[1, k] >= OBSTACLE
        if learnt and remaining_cost(known_table, path, i, rule) < 0:
            return i + 1
        if path[i + 1, 1] * true_table.shape[1] + path[i + 1, 0] == target:
            return i + 1
    return fields
