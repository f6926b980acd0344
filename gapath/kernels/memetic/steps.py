"""Steps from field to neighbouring field: allowed ones, a ray's first, one with a hand on the wall.

A field that is kept in a path is one number, y * 2**16 + x: sides are not longer
(`gapath.grid.MAX_SIDE`), and nobody has to divide.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.units import ALLOW, FORBID, OBSTACLE

X_BITS = 16
X_MASK = (1 << X_BITS) - 1

# Directions clockwise from +x; straight ones are even.
STEP_X = np.array([1, 1, 0, -1, -1, -1, 0, 1], dtype=np.int64)
STEP_Y = np.array([0, 1, 1, 1, 0, -1, -1, -1], dtype=np.int64)
DIRECTION = np.array([[5, 6, 7], [4, -1, 0], [3, 2, 1]], dtype=np.int64)
"""Of a step (dx, dy) at [dy + 1, dx + 1]."""


@kernel(inner=True)
def is_free(table: NDArray[np.int32], x: int, y: int) -> bool:
    """Tell whether a field, on the map or not, can be passed."""
    rows, cols = table.shape
    return 0 <= x < cols and 0 <= y < rows and table[np.uint64(y), np.uint64(x)] < OBSTACLE


@kernel
def may_step(table: NDArray[np.int32], x: int, y: int, u: int, v: int, rule: int) -> bool:
    """Tell whether a step from a free field to a neighbour, on the map or not, is allowed.

    Where no diagonal step is, one counts if there is a way round it, as rays go.
    """
    if not is_free(table, u, v):
        return False
    if rule == ALLOW or x == u or y == v:
        return True
    first, second = is_free(table, u, y), is_free(table, x, v)
    return (first and second) or (rule != FORBID and (first or second))


@kernel
def towards(x: int, y: int, u: int, v: int) -> tuple[int, int]:
    """Give the first step of the ray from (x, y) to another field (u, v)."""
    dx, dy = u - x, v - y
    n = max(abs(dx), abs(dy))
    step_x = int(2 * dx >= n) - int(2 * dx < -n)  # along the longer axis always a whole one
    step_y = int(2 * dy >= n) - int(2 * dy < -n)
    return step_x, step_y


@kernel
def wall_step(
    table: NDArray[np.int32], x: int, y: int, wall: int, side: int, rule: int
) -> tuple[int, int, int]:
    """Go a step with a hand on the wall.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    x, y : int
        A free field.
    wall : int
        Direction of the wall: the search for a free neighbour begins behind it.
    side : int
        1 to search clockwise, which keeps the wall on the left; -1 the other way.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    x, y, wall : int
        The next field, the same if there is none.
    """
    if rule == ALLOW:  # Moore tracing: obstacles that touch at corners only are several
        for turn in range(1, 9):
            k = (wall + side * turn) & 7
            u, v = x + STEP_X[k], y + STEP_Y[k]
            if is_free(table, u, v):
                return u, v, (k - side * (3 if k & 1 else 2)) & 7
    else:  # straight steps: such obstacles are one
        for turn in range(2, 10, 2):
            k = (wall + side * turn) & 7
            u, v = x + STEP_X[k], y + STEP_Y[k]
            if is_free(table, u, v):
                return u, v, (k + 4) & 7
    return x, y, wall


@kernel
def wall_of(
    table: NDArray[np.int32], x: int, y: int, dx: int, dy: int, side: int, rule: int
) -> int:
    """Give the direction of the wall that blocks a step, for `wall_step` to begin with."""
    k = DIRECTION[dy + 1, dx + 1]
    if rule == ALLOW or k & 1 == 0:
        return k
    for wall in (k - 1, k + 1):
        if not is_free(table, x + STEP_X[wall & 7], y + STEP_Y[wall & 7]):
            return wall & 7
    return (k - side) & 7  # only the field behind the corner is blocked
