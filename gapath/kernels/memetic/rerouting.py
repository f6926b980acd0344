"""Ways along the walls: first paths, newcomers, and other ways past some vertices of a polygon."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.graph_search import bits_of
from gapath.kernels.jit import kernel
from gapath.kernels.memetic.account import (
    ASK,
    CROWDED,
    EVALUATIONS,
    HANDS,
    INDIVIDUAL,
    MEMBERS,
    NEWCOMER,
    READ,
    SHARES,
)
from gapath.kernels.memetic.crossing import cross
from gapath.kernels.memetic.mutations import distance_below
from gapath.kernels.memetic.polygon import fields_of, splice
from gapath.kernels.memetic.population import (
    Diary,
    Individuals,
    noted,
    put,
    same_side,
    with_room,
)
from gapath.kernels.memetic.shortening import (
    FIXED,
    SHORTENING,
    cut_loops,
    pull,
    running_cost,
    shortened,
)
from gapath.kernels.memetic.walls import BOTH, GIVEN_UP, first_path, is_narrow
from gapath.kernels.rng import Stream, high

SPAN, WALK, MARGIN = 3, 4, 16
"""A reroute goes past up to 2**SPAN vertices, and walks WALK times as far as they are apart, and
MARGIN fields more."""

EARLY, FOREVER = 8, 1 << 40
"""Steps along walls for each row and column after which to look whether corridors are narrow."""


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
    ends: tuple[int, int, int, int],
    rule: int,
    hands: int,
    budget: int,
    varied: bool,
    backward: bool,
    path: NDArray[np.uint32],
    stream: Stream,
) -> tuple[int, int, NDArray[np.uint32]]:
    """Find a path as `first_path` does, or from the target back to the start."""
    x, y, u, v = ends
    if backward:
        x, y, u, v = u, v, x, y
    count, walked, path = first_path(table, x, y, u, v, rule, hands, budget, varied, path, stream)
    if backward:
        for k in range(count // 2):
            path[k], path[count - 1 - k] = path[count - 1 - k], path[k]
    return count, walked, path


@kernel(inner=True)
def first_walk(
    table: NDArray[np.int32],
    ends: tuple[int, int, int, int],
    rule: int,
    settings: NDArray[np.int64],
    stream: Stream,
) -> tuple[int, int, NDArray[np.uint32]]:
    """Find a first path as `first_path` does; CROWDED instead where corridors prove narrow."""
    rows, cols = table.shape
    budget = np.int64(EARLY * (rows + cols) if settings[ASK] else FOREVER)
    path = np.empty(256, dtype=np.uint32)
    for _ in range(2):
        count, walked, path = walked_path(
            table, ends, rule, settings[HANDS], budget, False, False, path, stream
        )
        if count != GIVEN_UP:
            break
        if is_narrow(table):
            return CROWDED, walked, path
        budget = np.int64(FOREVER)
    return count, walked, path


@kernel(inner=True)
def newcomers(
    table: NDArray[np.int32],
    ends: tuple[int, int, int, int],
    rule: int,
    settings: NDArray[np.int64],
    content: int,
    budget: int,
    members: Individuals,
    diary: Diary,
    numbers: NDArray[np.int64],
    room: Room,
    stream: Stream,
) -> tuple[Individuals, Diary, Room]:
    """Fill the population with paths along other walls, each of another homotopy or cheaper.

    The first of them goes from the target back to the start. One hand has no other ways than these
    two, both have a new one as often as chance makes one of them faster.

    Parameters
    ----------
    table, rule, settings, stream
        As of `evolve`.
    ends : tuple of int
        x and y of start and target.
    content : int
        A cost to stop at.
    budget : int
        How many fields may be read.
    members, diary, room
        The population, of one, its diary, and room for paths; each may move.
    numbers : (NUMBERS,) int64
        What comes out; MEMBERS, INDIVIDUAL, EVALUATIONS, READ and shares are changed in place.

    Returns
    -------
    members, diary, room
        Where they are now.
    """
    hands, population = settings[HANDS], members.sizes.shape[0]
    none = np.empty(0, dtype=np.int64)
    for k in range(1, 2 * population if hands == BOTH else min(population, 2)):
        best, n = numbers[INDIVIDUAL], numbers[MEMBERS]
        before, left = members.totals[best], budget - numbers[READ]
        if n == population or before <= content or left <= FIXED:
            break
        count, walked, path = walked_path(
            table, ends, rule, hands, left, k > 1, k & 1 == 1, room.path, stream
        )
        room = Room(room.order, path, room.other, room.child)
        numbers[EVALUATIONS] += 1
        numbers[READ] += FIXED + walked + SHORTENING * max(count, 0)
        if count < 0:
            continue
        size, total, points, costs = shortened(
            table, path, count, rule, content, True, room.order, none
        )
        row = n
        for other in range(n):
            if same_side(table, members.points[other], members.sizes[other], points, size, rule):
                row = other
                break
        if row < n and total >= members.totals[row]:
            continue
        members = put(members, row, points, costs, size, total)
        diary = noted(diary, members, 1, row, NEWCOMER, 0)
        numbers[MEMBERS] = max(n, row + 1)
        if total < before:
            numbers[INDIVIDUAL] = row
            numbers[SHARES + NEWCOMER] += before - total
    return members, diary, room


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
        table, (x, y, u, v), rule, hands, budget, hands == BOTH, backward, room.other, stream
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
