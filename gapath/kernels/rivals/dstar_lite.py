"""D* Lite: a shortest path that is repaired when the map changes (Koenig & Likhachev 2002).

It searches from the target to the robot. g is a field's cost to the target as last settled,
rhs what its neighbours say; the queue holds the fields where they differ. After a change
only the fields whose cost it touches, and that the robot's path may use, are settled again.

A step costs the weight of the field that it leaves, in the upper bits, and a length in the
lower ones: 2 straight, 3 diagonal. So no step is free, which the algorithm requires and
weights of 0 would violate, and of the cheapest paths the one of least such length wins. Were
diagonal steps as long as straight ones, many more fields would be due in every search.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.graph_search import STEP_X, STEP_Y
from gapath.kernels.jit import kernel
from gapath.kernels.lines import cuts_corner
from gapath.kernels.units import OBSTACLE

LENGTH_BITS = 22
MAX_FIELDS = 1 << 20
"""Fields of the largest map: no path is then longer than 2**LENGTH_BITS."""

NO_PATH = 1 << 60
"""Above the cost of every path."""

FREE = -1  # position of a field that is not queued


class Search(NamedTuple):
    """State of a search on N fields, changed in place."""

    table: NDArray[np.int32]
    """(rows, cols) the known map as of the last repair."""
    g: NDArray[np.int64]
    """(N,) cost to the target, as settled."""
    rhs: NDArray[np.int64]
    """(N,) cost to the target, one step ahead."""
    queue: NDArray[np.int64]
    """(N,) binary heap of fields."""
    position: NDArray[np.int64]
    """(N,) index of a field in the heap, or FREE."""
    keys: NDArray[np.int64]
    """(N, 2) the key by which a queued field is ordered."""
    target: tuple[int, int]
    rule: int
    """Corner-cutting rule."""


class Heuristic(NamedTuple):
    """What bounds the cost from the robot to a field."""

    robot: tuple[int, int]
    least: int
    """A weight that no field undercuts but the target and the light one."""
    light: tuple[int, int]
    """A field that may be lighter: where the drive began."""
    light_weight: int
    offset: int
    """Added to every later key (k_m of the paper): how far the robot has gone."""


@kernel
def length(dx: int, dy: int) -> int:
    """Give the least length of a way, 2 for straight and 3 for diagonal steps."""
    longer, shorter = max(abs(dx), abs(dy)), min(abs(dx), abs(dy))
    return 2 * longer + shorter


@kernel
def bound(heuristic: Heuristic, x: int, y: int) -> int:
    """Give the exact cost from the robot to a field if every field weighed the least.

    But the light field: a path over it may be the cheapest even where it is not the
    straightest.
    """
    (u, v), (light_x, light_y) = heuristic.robot, heuristic.light
    over_light = heuristic.least * max(abs(light_x - u), abs(light_y - v))
    then = max(abs(x - light_x), abs(y - light_y))
    if then > 0:
        over_light += heuristic.light_weight + heuristic.least * (then - 1)
    cost = min(heuristic.least * max(abs(x - u), abs(y - v)), over_light)
    return (cost << LENGTH_BITS) + length(x - u, y - v)


@kernel(inner=True)
def key_of(search: Search, heuristic: Heuristic, place: int) -> tuple[int, int]:
    """Give the two numbers by which the queue is ordered."""
    cols = search.table.shape[1]
    cost = min(search.g[place], search.rhs[place])
    y = place // cols
    return cost + bound(heuristic, place - y * cols, y) + heuristic.offset, cost


@kernel(inner=True)
def comes_before(search: Search, a: int, b: int) -> bool:
    """Compare two queued fields."""
    first, second = search.keys[a, 0], search.keys[b, 0]
    if first != second:
        return bool(first < second)
    return bool(search.keys[a, 1] < search.keys[b, 1])


@kernel(inner=True)
def sift(search: Search, size: int, at: int) -> None:
    """Move the field at a heap index up or down to where its key belongs."""
    queue, position = search.queue, search.position
    place = queue[at]
    while at > 0 and comes_before(search, place, queue[(at - 1) >> 1]):
        above = (at - 1) >> 1
        queue[at] = queue[above]
        position[queue[at]] = at
        at = above
    while True:
        below = 2 * at + 1
        if below + 1 < size and comes_before(search, queue[below + 1], queue[below]):
            below += 1
        if below >= size or not comes_before(search, queue[below], place):
            break
        queue[at] = queue[below]
        position[queue[at]] = at
        at = below
    queue[at] = place
    position[place] = at


@kernel
def update(search: Search, heuristic: Heuristic, size: int, place: int) -> int:
    """Queue a field if g and rhs differ, else take it out; give the new size."""
    at = search.position[place]
    if search.g[place] != search.rhs[place]:
        search.keys[place, 0], search.keys[place, 1] = key_of(search, heuristic, place)
        if at == FREE:
            at = size
            search.queue[at] = place
            size += 1
        sift(search, size, at)
    elif at != FREE:
        size -= 1
        search.position[place] = FREE
        if at < size:
            search.queue[at] = search.queue[size]
            sift(search, size, at)
    return size


@kernel(inner=True)
def step_cost(search: Search, x0: int, y0: int, step: int) -> int:
    """Give the cost of a step from a field, NO_PATH if it is impossible."""
    table = search.table
    x1, y1 = x0 + STEP_X[step], y0 + STEP_Y[step]
    if not (0 <= x1 < table.shape[1] and 0 <= y1 < table.shape[0]):
        return NO_PATH
    weight = np.int64(table[y0, x0])
    if weight >= OBSTACLE or table[y1, x1] >= OBSTACLE:
        return NO_PATH
    if cuts_corner(table, x0, y0, x1, y1, search.rule):
        return NO_PATH
    return (weight << LENGTH_BITS) + (2 if step < 4 else 3)


@kernel(inner=True)
def look_ahead(search: Search, x: int, y: int) -> tuple[int, int]:
    """Give the least cost to the target by one step and what g says there, and that step."""
    if (x, y) == search.target:
        return np.int64(0), -1
    cols = search.table.shape[1]
    least, best = np.int64(NO_PATH), -1
    for step in range(8):
        cost = step_cost(search, x, y, step)
        if cost < NO_PATH:
            cost += search.g[(y + STEP_Y[step]) * cols + x + STEP_X[step]]
            if cost < least:
                least, best = cost, step
    return least, best


@kernel
def begin(search: Search) -> int:
    """Fill the arrays of a new search; give the size of its queue."""
    search.g[:] = NO_PATH
    search.rhs[:] = NO_PATH
    search.position[:] = FREE
    place = search.target[1] * search.table.shape[1] + search.target[0]
    search.rhs[place] = 0
    search.queue[0] = place
    search.position[place] = 0
    search.keys[place] = 0
    return 1


@kernel
def requeue(search: Search, heuristic: Heuristic, size: int) -> None:
    """Give every queued field its key again: a smaller bound undercuts the old ones."""
    for i in range(size):
        place = search.queue[i]
        search.keys[place, 0], search.keys[place, 1] = key_of(search, heuristic, place)
        sift(search, i + 1, i)


@kernel(inner=True)
def take_over(
    search: Search,
    heuristic: Heuristic,
    size: int,
    known: NDArray[np.int32],
    changed: NDArray[np.int64],
) -> int:
    """Take over what changed on the known map; give the new size of the queue."""
    rows, cols = known.shape
    for i in range(changed.shape[0]):
        y = changed[i] // cols
        x = changed[i] - y * cols
        # a weight counts only for leaving the field, an obstacle for its neighbours too
        reach = 1 if max(search.table[y, x], known[y, x]) >= OBSTACLE else 0
        search.table[y, x] = known[y, x]
        for v in range(max(y - reach, 0), min(y + reach + 1, rows)):
            for u in range(max(x - reach, 0), min(x + reach + 1, cols)):
                search.rhs[v * cols + u], _ = look_ahead(search, u, v)
                size = update(search, heuristic, size, v * cols + u)
    return size


@kernel(inner=True)
def settle(search: Search, heuristic: Heuristic, size: int) -> tuple[int, int]:
    """Expand fields until the robot's cost is exact; give the queue's size and their number."""
    g, rhs, keys = search.g, search.rhs, search.keys
    rows, cols = search.table.shape
    robot = heuristic.robot[1] * cols + heuristic.robot[0]
    expansions = 0
    while size > 0:
        place = search.queue[0]
        first, second = keys[place, 0], keys[place, 1]
        limit, limit_cost = key_of(search, heuristic, robot)
        due = first < limit or (first == limit and second < limit_cost)
        if not due and rhs[robot] <= g[robot]:
            break
        now, now_cost = key_of(search, heuristic, place)
        if first < now or (first == now and second < now_cost):
            size = update(search, heuristic, size, place)
            continue
        expansions += 1
        y0 = place // cols
        x0 = place - y0 * cols
        old = g[place]
        lowered = old > rhs[place]
        g[place] = rhs[place] if lowered else NO_PATH
        size = update(search, heuristic, size, place)
        for step in range(8):
            x, y = x0 - STEP_X[step], y0 - STEP_Y[step]
            if not (0 <= x < cols and 0 <= y < rows):
                continue
            before = y * cols + x
            cost = step_cost(search, x, y, step)
            if cost >= NO_PATH or (x, y) == search.target:
                continue
            if lowered and cost + g[place] < rhs[before]:
                rhs[before] = cost + g[place]
                size = update(search, heuristic, size, before)
            elif not lowered and cost + old == rhs[before]:
                rhs[before], _ = look_ahead(search, x, y)
                size = update(search, heuristic, size, before)
    return size, expansions


@kernel
def repair(
    search: Search,
    heuristic: Heuristic,
    size: int,
    known: NDArray[np.int32],
    changed: NDArray[np.int64],
) -> tuple[int, int, NDArray[np.int32]]:
    """Repair the search after a change and follow the cheapest steps from the robot.

    Parameters
    ----------
    search : Search
        Changed in place.
    heuristic : Heuristic
        The robot's field and the bound now.
    size : int
        Size of the queue.
    known : (rows, cols) int32
        The known map.
    changed : (n,) int64
        Flat indices of the fields on which it differs from the search's.

    Returns
    -------
    size, expansions : int
        The new size of the queue, and the fields expanded.
    path : (n, 2) int32
        Fields (x, y) from the robot to the target; empty if there is no path. Its cost, the
        target left out, is the robot's rhs.
    """
    size = take_over(search, heuristic, size, known, changed)
    size, expansions = settle(search, heuristic, size)
    x, y = heuristic.robot
    path = np.empty((64, 2), dtype=np.int32)
    if search.rhs[y * known.shape[1] + x] >= NO_PATH:
        return size, expansions, path[:0]
    count = 0
    while True:
        if count == path.shape[0]:
            path = np.concatenate((path, np.empty_like(path)))
        path[count, 0], path[count, 1] = x, y
        count += 1
        if (x, y) == search.target:
            return size, expansions, path[:count]
        _, step = look_ahead(search, x, y)
        x, y = x + STEP_X[step], y + STEP_Y[step]
