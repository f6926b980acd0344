"""A path that was cut, repaired where it was cut: along the walls, round what is in the way.

The wall is followed from behind the cut back to the robot, not the other way: where it is met then
changes little while the robot goes along it, so that the same hand gets round first, and the robot
seldom turns back. The path behind is only looked through, so that a repair takes as long as the way
round. If that is nearly straight, the way round the other side takes its place wherever it is
shorter, by however little. A path that is all new, from the robot to the target, is only looked for
where the repaired one has grown so much since the last time that a change of sides may be worth it.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.memetic.crossing import cross
from gapath.kernels.memetic.polygon import fields_of
from gapath.kernels.memetic.rays import ray
from gapath.kernels.memetic.rerouting import walked_path
from gapath.kernels.memetic.shortening import shortened
from gapath.kernels.memetic.steps import X_BITS, X_MASK, may_step
from gapath.kernels.memetic.walls import BOTH, NO_WAY, grown
from gapath.kernels.units import ALLOW, OBSTACLE

BEYOND = 8
"""Fields behind the cut, to where the wall is followed: nearer to the target one hand is first."""

SLACK = 32
"""Fields of the path behind the way round that are pulled straight together with it."""

NEAR = 4
"""How many fields more than possible the way round may have for the least saving to do."""

CHANGE = 16
"""Fields that a path which is all new has to save otherwise."""

NO_LIMIT = 1 << 40
"""Steps along walls; also a cost that is always low enough."""

FREE = -1
"""Instead of a cost: there is nothing to repair."""


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
    cols, weights = table.shape[1], table.ravel()
    i = path.shape[0] - 1
    while i > at:
        k = np.uint64(i - 1)  # unsigned: numba looks for no sign
        if weights[np.uint64(path[k, 1] * cols + path[k, 0])] >= OBSTACLE:
            break
        if rule != ALLOW:
            x, y = np.int64(path[k, 0]), np.int64(path[k, 1])
            if not may_step(table, np.int64(path[i, 0]), np.int64(path[i, 1]), x, y, rule):
                break
        i -= 1
    return i


@kernel
def last_beside(path: NDArray[np.int32], first: int, way: NDArray[np.uint32], count: int) -> int:
    """Find the last field of a path that may be on a way or beside it: within its bounds.

    Parameters
    ----------
    path : (n, 2) int32
        Fields as (x, y).
    first : int
        Where to stop looking.
    way : (m,) uint32
        Fields (`gapath.kernels.memetic.steps`).
    count : int
        How many.

    Returns
    -------
    int
        Its index; ``first`` if there is none behind that one.
    """
    left = right = np.int64(way[0] & X_MASK)
    top = bottom = np.int64(way[0] >> X_BITS)
    for i in range(1, count):
        x, y = np.int64(way[i] & X_MASK), np.int64(way[i] >> X_BITS)
        left, right, top, bottom = min(left, x), max(right, x), min(top, y), max(bottom, y)
    i = path.shape[0] - 1
    while i > first:
        x, y = np.int64(path[i, 0]), np.int64(path[i, 1])
        if left - 1 <= x <= right + 1 and top - 1 <= y <= bottom + 1:
            break
        i -= 1
    return i


@kernel
def goes_straight_on(
    table: NDArray[np.int32],
    path: NDArray[np.int32],
    i: int,
    points: NDArray[np.int32],
    costs: NDArray[np.int64],
    size: int,
    rule: int,
) -> bool:
    """Let the last ray of a polygon end where a path ends, if it is free then and no dearer.

    Parameters
    ----------
    table : (rows, cols) int32
        The known map.
    path : (n, 2) int32
        Fields as (x, y), free from ``i`` on.
    i : int
        Where on it the polygon ends.
    points : (m, 2) int32
        Vertices; the last one is changed in place.
    costs : (m,) int64
        What their rays cost; changed in place.
    size : int
        How many vertices there are, at least 2.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    bool
        Whether it ends there now.
    """
    cols, weights, last = table.shape[1], table.ravel(), path.shape[0] - 1
    along = costs[size - 2]
    for k in range(np.uint64(i + 1), np.uint64(last + 1)):  # unsigned: numba looks for no sign
        along += weights[np.uint64(path[k, 1] * cols + path[k, 0])]
    x, y = np.int64(points[size - 2, 0]), np.int64(points[size - 2, 1])
    u, v = np.int64(path[last, 0]), np.int64(path[last, 1])
    blocked, through = ray(table, x, y, u, v, rule)
    if blocked or through > along:
        return False
    points[size - 1, 0], points[size - 1, 1], costs[size - 2] = u, v, through
    return True


@kernel
def all_new(
    table: NDArray[np.int32],
    x: int,
    y: int,
    target_x: int,
    target_y: int,
    rule: int,
    enough: int,
    order: NDArray[np.int32],
) -> tuple[int, int, NDArray[np.uint32]]:
    """Find a path along walls, and pull it straight.

    Parameters
    ----------
    table, target_x, target_y, rule, order
        As of `repaired`.
    x, y : int
        Where it begins.
    enough : int
        A cost that is low enough.

    Returns
    -------
    count : int
        How many fields it has, or NO_WAY.
    cost : int
        The sum of their weights but the first one's, in units of 1 / SCALE.
    path : (n,) uint32
        Fields (`gapath.kernels.memetic.steps`).
    """
    stream = np.zeros(4, dtype=np.uint64)  # nothing is drawn from it
    way, none = np.empty(512, dtype=np.uint32), np.empty(0, dtype=np.int64)
    ends = (np.int64(x), np.int64(y), np.int64(target_x), np.int64(target_y))
    count, _, way = walked_path(table, ends, rule, BOTH, NO_LIMIT, False, False, way, stream)
    if count == NO_WAY:
        return count, np.int64(0), way
    size, cost, points, _ = shortened(table, way, count, rule, enough, False, order, none)
    count, way = fields_of(table, points, size, False, rule, way)
    return count, cost, way


@kernel
def led_round(
    table: NDArray[np.int32],
    path: NDArray[np.int32],
    at: int,
    behind: int,
    rule: int,
    least: int,
    order: NDArray[np.int32],
) -> tuple[NDArray[np.int32], int]:
    """Lead a path round what has cut it.

    Parameters
    ----------
    table, path, at, rule, least, order
        As of `repaired`.
    behind : int
        From where on the path is free (`behind_cuts`).

    Returns
    -------
    path : (m, 2) int32
        Fields from the robot's to the path's end; none if there is no way, which is proved.
    cost : int
        The sum of their weights but the first one's, in units of 1 / SCALE.
    """
    n = path.shape[0]
    x, y = np.int64(path[at, 0]), np.int64(path[at, 1])
    i = min(behind + BEYOND, n - 1)
    u, v = np.int64(path[i, 0]), np.int64(path[i, 1])
    stream = np.zeros(4, dtype=np.uint64)  # nothing is drawn from it
    way = np.empty(512, dtype=np.uint32)
    count, _, way = walked_path(table, (x, y, u, v), rule, BOTH, NO_LIMIT, False, True, way, stream)
    if count == NO_WAY:  # nor to the end, to which the path is free from there
        return np.empty((0, 2), dtype=np.int32), np.int64(0)
    end = min(last_beside(path, i, way, count) + SLACK, n - 1)
    way = grown(way, count, count + end - i)
    for k in range(i + 1, end + 1):
        way[count] = (np.int64(path[k, 1]) << X_BITS) + path[k, 0]
        count += 1
    u, v = np.int64(path[end, 0]), np.int64(path[end, 1])
    lower = table[v, u] + least * (max(abs(u - x), abs(v - y)) - 1)
    none = np.empty(0, dtype=np.int64)
    size, total, points, costs = shortened(table, way, count, rule, lower, False, order, none)
    if lower < total <= lower + NEAR * least:  # the other side may be the better one
        more, _, other = all_new(table, x, y, u, v, rule, NO_LIMIT, order)
        count, way = fields_of(table, points, size, False, rule, way)
        child = np.empty(count + more, dtype=np.uint32)
        count, less, _ = cross(table, way, count, other, more, order, child)
        if less < total:
            size, total, points, costs = shortened(
                table, child, count, rule, lower, False, order, none
            )
    if goes_straight_on(table, path, end, points, costs, size, rule):
        end = n - 1
    count, way = fields_of(table, points, size, False, rule, way)
    cost = costs[: size - 1].sum()
    new = np.empty((count + n - 1 - end, 2), dtype=np.int32)
    for k in range(count):
        new[k, 0], new[k, 1] = way[k] & X_MASK, way[k] >> X_BITS
    for k in range(end + 1, n):
        new[count, 0], new[count, 1] = path[k, 0], path[k, 1]
        cost += table[path[k, 1], path[k, 0]]
        count += 1
    return new, cost


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
    expected: int,
    order: NDArray[np.int32],
) -> tuple[NDArray[np.int32], int, int]:
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
    expected : int
        What a new path cost, when one was last looked for, from the beginning of the path.
    order : (rows * cols,) int32
        Anything; overwritten.

    Returns
    -------
    path : (m, 2) int32
        Fields from the robot's to the target; none if there is no way, which is proved.
    cost : int
        The sum of their weights, in units of 1 / SCALE; FREE if the path is not cut.
    expected : int
        What a new path costs, as far as is known.
    """
    x, y = np.int64(robot_x), np.int64(robot_y)
    end_x, end_y = np.int64(target_x), np.int64(target_y)
    lower = table[end_y, end_x] + least * (max(abs(end_x - x), abs(end_y - y)) - 1)
    if path.shape[0] == 0:
        count, cost, way = all_new(table, x, y, end_x, end_y, rule, lower, order)
        return unpacked(way, max(count, 0)), cost + table[y, x], cost
    behind = behind_cuts(table, path, at, rule)
    if behind == at:
        return path, np.int64(FREE), expected
    for i in range(1, at + 1):
        expected -= table[path[i, 1], path[i, 0]]
    new, cost = led_round(table, path, at, behind, rule, least, order)
    if new.shape[0] == 0:
        return new, cost, cost
    enough = cost - CHANGE * least
    if enough > max(lower, expected):
        more, expected, other = all_new(table, x, y, end_x, end_y, rule, NO_LIMIT, order)
        count = new.shape[0]
        way, child = np.empty(count, dtype=np.uint32), np.empty(count + more, dtype=np.uint32)
        for i in range(count):
            way[i] = (np.int64(new[i, 1]) << X_BITS) + new[i, 0]
        count, expected, _ = cross(table, way, count, other, more, order, child)
        if expected < enough:
            new, cost = unpacked(child, count), expected
    return new, cost + table[y, x], expected


@kernel(inner=True)
def unpacked(path: NDArray[np.uint32], count: int) -> NDArray[np.int32]:
    """Give fields (`gapath.kernels.memetic.steps`) as (x, y)."""
    fields = np.empty((count, 2), dtype=np.int32)
    for i in range(count):
        fields[i, 0], fields[i, 1] = path[i] & X_MASK, path[i] >> X_BITS
    return fields
