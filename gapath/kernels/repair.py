"""A path that was cut, repaired where it was cut: along the walls, round what is in the way.

The wall is followed from behind the cut back to the robot, not the other way: where a wall is met
hardly changes then while the robot goes along it, so that the same hand gets round first, and the
robot turns back seldom.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.memetic.polygon import fields_of
from gapath.kernels.memetic.rerouting import walked_path
from gapath.kernels.memetic.shortening import shortened
from gapath.kernels.memetic.steps import X_BITS, X_MASK, may_step
from gapath.kernels.memetic.walls import BOTH, NO_WAY, grown

TWICE, BESIDE = 2, 64
"""What comes behind the cut is made shorter, too: twice as many fields as lead round, and so many
more."""

NO_LIMIT = 1 << 40
"""Steps along walls."""


@kernel
def behind_cuts(table: NDArray[np.int32], path: NDArray[np.int32], at: int, rule: int) -> int:
    """Find where a path goes on behind the last step that is not allowed.

    Parameters
    ----------
    table : (rows, cols) int32
        The known map.
    path : (n, 2) int32
        Fields as (x, y), the last one free.
    at : int
        Index of the robot's own field.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    int
        Index of a free field from which the path is free to its end; at most n - 1.
    """
    j = path.shape[0] - 1
    while j > at:
        x, y = np.int64(path[j - 1, 0]), np.int64(path[j - 1, 1])
        u, v = np.int64(path[j, 0]), np.int64(path[j, 1])
        if not may_step(table, u, v, x, y, rule):
            break
        j -= 1
    return j


@kernel
def repaired(
    table: NDArray[np.int32],
    path: NDArray[np.int32],
    at: int,
    robot_x: int,
    robot_y: int,
    target_x: int,
    target_y: int,
    rule: int,
    order: NDArray[np.int32],
) -> tuple[NDArray[np.int32], int]:
    """Repair a path from the robot's field to the target.

    Parameters
    ----------
    table : (rows, cols) int32
        The known map.
    path : (n, 2) int32
        The path so far, fields as (x, y); of no length for one that is all new.
    at : int
        Index of the robot's own field on it.
    robot_x, robot_y, target_x, target_y : int
        Free fields, the ends of what is left of the path.
    rule : int
        Corner-cutting rule.
    order : (rows * cols,) int32
        Anything; overwritten.

    Returns
    -------
    path : (m, 2) int32
        Fields from the robot's to the target; none if there is no way, which is proved.
    cost : int
        The sum of their weights, in units of 1 / SCALE.
    """
    x, y = np.int64(robot_x), np.int64(robot_y)
    u, v = np.int64(target_x), np.int64(target_y)
    stream, none = np.zeros(4, dtype=np.uint64), np.empty(0, dtype=np.int64)  # nothing is drawn
    n = path.shape[0]
    behind = n
    if n:
        behind = behind_cuts(table, path, at, rule)
        u, v = np.int64(path[behind, 0]), np.int64(path[behind, 1])
    way = np.empty(256, dtype=np.uint32)
    count, _, way = walked_path(table, x, y, u, v, rule, BOTH, NO_LIMIT, False, True, way, stream)
    if count == NO_WAY:  # nor to the target, to which the path is free from there
        return np.empty((0, 2), dtype=np.int32), 0
    end = min(behind + 1 + TWICE * count + BESIDE, n)
    way = grown(way, count, count + max(end - behind, 0))
    for k in range(behind + 1, end):
        way[count] = (np.int64(path[k, 1]) << X_BITS) + path[k, 0]
        count += 1
    size, cost, points, _ = shortened(table, way, count, rule, 0, True, order, none)
    count, way = fields_of(table, points, size, False, rule, way)
    whole = np.empty((count + n - end, 2), dtype=np.int32)
    for k in range(count):
        whole[k, 0], whole[k, 1] = way[k] & X_MASK, way[k] >> X_BITS
    cost += np.int64(table[y, x])
    for k in range(end, n):
        whole[count + k - end] = path[k]
        cost += np.int64(table[path[k, 1], path[k, 0]])
    return whole, cost
