"""Other ways along the walls: whole ones, and past some vertices of a polygon."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.graph_search import bits_of
from gapath.kernels.jit import kernel
from gapath.kernels.memetic.crossing import cross
from gapath.kernels.memetic.mutations import distance_below
from gapath.kernels.memetic.polygon import fields_of, splice
from gapath.kernels.memetic.population import Individuals, with_room
from gapath.kernels.memetic.shortening import (
    SHORTENING,
    cut_loops,
    pull,
    running_cost,
    shortened,
)
from gapath.kernels.memetic.walls import BOTH, first_path
from gapath.kernels.rng import Stream, high

SPAN, WALK, MARGIN = 3, 4, 16
"""A reroute goes past up to 2**SPAN vertices, and walks WALK times as far as they are apart, and
MARGIN fields more."""


class Room(NamedTuple):
    """Where paths are kept while they change; each may be replaced by a larger one."""

    order: NDArray[np.int32]
    """(rows * cols,) places of fields on a path."""
    path: NDArray[np.uint32]
    other: NDArray[np.uint32]
    child: NDArray[np.uint32]


@kernel
def walked_path(
    table: NDArray[np.int32],
    start_x: int,
    start_y: int,
    target_x: int,
    target_y: int,
    rule: int,
    hands: int,
    budget: int,
    varied: bool,
    backward: bool,
    path: NDArray[np.uint32],
    stream: Stream,
) -> tuple[int, int, NDArray[np.uint32]]:
    """Find a path as `first_path` does, or from the target back to the start."""
    x, y, u, v = start_x, start_y, target_x, target_y
    if backward:
        x, y, u, v = u, v, x, y
    count, walked, path = first_path(table, x, y, u, v, rule, hands, budget, varied, path, stream)
    if backward:
        for k in range(count // 2):
            path[k], path[count - 1 - k] = path[count - 1 - k], path[k]
    return count, walked, path


@kernel
def crossed(
    table: NDArray[np.int32],
    points: NDArray[np.int32],
    size: int,
    others: NDArray[np.int32],
    other_size: int,
    rule: int,
    room: Room,
) -> tuple[int, int, int, Room]:
    """Cross two polygons with the same ends (`cross`), each as the fields of its rays.

    Gives the fields and the cost of the child, which lies in the room, the fields that were read,
    and the room.
    """
    n, path = fields_of(table, points, size, False, rule, room.path)
    m, other = fields_of(table, others, other_size, False, rule, room.other)
    child = room.child
    if n + m > child.shape[0]:
        child = np.empty(2 * (n + m), dtype=np.uint32)
    count, cost, _ = cross(table, path, n, other, m, room.order, child)
    return count, cost, n + m, Room(room.order, path, other, child)


@kernel
def reroute(
    table: NDArray[np.int32],
    members: Individuals,
    row: int,
    least: int,
    rule: int,
    hands: int,
    words: NDArray[np.uint64],
    room: Room,
    stream: Stream,
) -> tuple[int, int, Individuals, Room]:
    """Look for another way past some vertices, along the walls, and cross it with the old one.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    members : Individuals
        The population; changed in place, or moved.
    row : int
        An individual of at least three vertices.
    least : int
        The least weight of any free field but start and target.
    rule, hands : int
        As of `first_path`.
    words : (n,) uint64
        Two random words.
    room : Room
        Room for paths.
    stream : (4,) uint64
        A random stream, advanced in place.

    Returns
    -------
    gain : int
        What it saves, at least 0.
    fields : int
        How many fields were read.
    members, room
        Where they are now.
    """
    points, costs, size = members.points[row], members.costs[row], members.sizes[row]
    i = high(words[0], size - 2)
    j = min(i + 2 + distance_below(min(bits_of(size) - 1, SPAN), words[1]), size - 1)
    x, y = np.int64(points[i, 0]), np.int64(points[i, 1])
    u, v = np.int64(points[j, 0]), np.int64(points[j, 1])
    old = np.int64(0)
    for k in range(i, j):
        old += costs[k]
    apart = max(abs(u - x), abs(v - y))
    lower = least * (apart - 1) + table[v, u]
    if old <= lower:
        return np.int64(0), np.int64(1), members, room
    budget, backward = WALK * (apart + MARGIN), words[0] & np.uint64(1) == 1
    count, walked, other = walked_path(
        table, x, y, u, v, rule, hands, budget, hands == BOTH, backward, room.other, stream
    )
    room = Room(room.order, room.path, other, room.child)
    if count < 0:
        return np.int64(0), walked, members, room
    count = cut_loops(table, other, count, room.order, rule)
    others, other_costs = np.empty((count, 2), dtype=np.int32), np.empty(count, dtype=np.int64)
    sums = running_cost(table, other, count)
    other_size, _ = pull(table, other, count, sums, rule, others, other_costs)
    walked += SHORTENING // 2 * count
    count, cost, fields, room = crossed(
        table, points[i:], j - i + 1, others, other_size, rule, room
    )
    if cost >= old:
        return np.int64(0), walked + fields, members, room
    none = np.empty(0, dtype=np.int64)
    new_size, total, new, new_costs = shortened(
        table, room.child, count, rule, lower, False, room.order, none
    )
    members = with_room(members, size + new_size)
    members.sizes[row] = splice(
        members.points[row], members.costs[row], size, i, j, new[1:], new_costs, new_size - 2
    )
    members.totals[row] += total - old
    return old - total, walked + fields, members, room
