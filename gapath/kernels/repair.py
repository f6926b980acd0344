"""A path that was cut, repaired where it was cut: along the walls, round what is in the way.

The wall is followed from behind the cut back to the robot, not the other way: where it is met then
changes little while the robot goes along it, so that the same hand gets round first, and the robot
seldom turns back. A path that is all new only takes the place of pieces of the repaired one where
that is worth a change of sides.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.memetic.crossing import cross
from gapath.kernels.memetic.polygon import fields_of
from gapath.kernels.memetic.rerouting import walked_path
from gapath.kernels.memetic.shortening import cut_loops, pull, pull_there_and_back, running_cost
from gapath.kernels.memetic.steps import X_BITS, X_MASK, may_step
from gapath.kernels.memetic.walls import BOTH, NO_WAY, grown

BEYOND = 8
"""Fields behind the cut, to where the wall is followed: nearer to the target one hand is first."""

CHANGE, NEAR = 16, 4
"""Fields that a new path has to save, and how many more than possible a repaired one may have
for the least saving to do."""

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
        Index of the first field, ``at`` or later, from which the path is free to its end.
    """
    i = path.shape[0] - 1
    u, v = np.int64(path[i, 0]), np.int64(path[i, 1])
    while i > at:
        x, y = np.int64(path[i - 1, 0]), np.int64(path[i - 1, 1])
        if not may_step(table, u, v, x, y, rule):
            break
        u, v = x, y
        i -= 1
    return i


@kernel
def straightened(
    table: NDArray[np.int32],
    path: NDArray[np.uint32],
    count: int,
    rule: int,
    well: bool,
    order: NDArray[np.int32],
) -> tuple[int, int, NDArray[np.uint32]]:
    """Cut off a path's loops and pull it straight.

    Parameters
    ----------
    table : (rows, cols) int32
        The known map.
    path : (n,) uint32
        Fields (`gapath.kernels.memetic.steps`); changed in place.
    count : int
        How many.
    rule : int
        Corner-cutting rule.
    well : bool
        Also from the target back, and again.
    order : (rows * cols,) int32
        Anything; overwritten.

    Returns
    -------
    count, cost : int
        How many fields there are, and what they cost, the first one left out.
    path : (m,) uint32
        Where they are.
    """
    count = cut_loops(table, path, count, order, rule)
    sums = running_cost(table, path, count)
    points, costs = np.empty((count, 2), dtype=np.int32), np.empty(count, dtype=np.int64)
    size, cost = pull(table, path, count, sums, rule, points, costs)
    if well and size > 2:
        size, cost, points, costs, path = pull_there_and_back(
            table, points, costs, size, rule, path
        )
    count, path = fields_of(table, points, size, False, rule, path)
    return count, cost, path


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
    least: int,
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
    least : int
        The least weight of any free field but these two.
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
    end_x, end_y = np.int64(target_x), np.int64(target_y)
    u, v = end_x, end_y
    n = path.shape[0]
    behind = n
    if n:
        behind = min(behind_cuts(table, path, at, rule) + BEYOND, n - 1)
        u, v = np.int64(path[behind, 0]), np.int64(path[behind, 1])
    stream = np.zeros(4, dtype=np.uint64)  # nothing is drawn from it
    way = np.empty(n + 256, dtype=np.uint32)
    count, _, way = walked_path(table, (x, y, u, v), rule, BOTH, NO_LIMIT, False, True, way, stream)
    if count == NO_WAY:  # nor to the target, to which the path is free from there
        return np.empty((0, 2), dtype=np.int32), 0
    way = grown(way, count, count + n - behind)
    for i in range(behind + 1, n):
        way[count] = (np.int64(path[i, 1]) << X_BITS) + path[i, 0]
        count += 1
    count, cost, way = straightened(table, way, count, rule, True, order)

    lower = table[end_y, end_x] + least * (max(abs(end_x - x), abs(end_y - y)) - 1)
    enough = 1 if cost <= lower + NEAR * least else CHANGE * least + 1
    if cost - enough >= lower:
        new = np.empty(256, dtype=np.uint32)
        more, _, new = walked_path(
            table, (x, y, end_x, end_y), rule, BOTH, NO_LIMIT, False, False, new, stream
        )
        more, _, new = straightened(table, new, more, rule, False, order)
        child = np.empty(count + more, dtype=np.uint32)
        more, less, _ = cross(table, way, count, new, more, order, child)
        if less <= cost - enough:
            way, count, cost = child, more, less
    fields = np.empty((count, 2), dtype=np.int32)
    for i in range(count):
        fields[i, 0], fields[i, 1] = way[i] & X_MASK, way[i] >> X_BITS
    return fields, cost + np.int64(table[y, x])
