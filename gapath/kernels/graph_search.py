"""A* and Dijkstra on the 8-connected grid, with one heap and one rule for ties.

The priority of a field is its estimated cost in the upper 47 bits and its Chebyshev
distance to the target in the lower 16, so that equal costs are settled towards the target.
"""

import numpy as np
from numpy.typing import NDArray

from gapath._jit import kernel
from gapath.kernels.fitness import ALLOW, cuts_corner
from gapath.units import OBSTACLE

TIE_BITS = 16
"""Bits of the Chebyshev distance: maps have at most 2**16 fields a side."""

STRAIGHT = 1 << 20
"""Length of a straight step, in the unit of lengths."""
DIAGONAL = 1482910
"""Length of a diagonal step, round(sqrt(2) * STRAIGHT)."""

# Straight steps first: at equal cost they win.
STEP_X = np.array([1, -1, 0, 0, 1, 1, -1, -1], dtype=np.int64)
STEP_Y = np.array([0, 0, 1, -1, 1, -1, 1, -1], dtype=np.int64)


@kernel
def push(
    keys: NDArray[np.int64], fields: NDArray[np.int64], size: int, key: int, place: int
) -> None:
    """Put an item into a binary heap of `size` items that has room for one more."""
    at = size
    while at > 0:
        above = (at - 1) >> 1
        if keys[above] <= key:
            break
        keys[at], fields[at] = keys[above], fields[above]
        at = above
    keys[at], fields[at] = key, place


@kernel
def drop_first(keys: NDArray[np.int64], fields: NDArray[np.int64], size: int) -> None:
    """Take the first item out of a heap of `size` items; size - 1 remain."""
    last = size - 1
    key, place = keys[last], fields[last]
    at = 0
    while True:
        below = 2 * at + 1
        if below >= last:
            break
        if below + 1 < last and keys[below + 1] < keys[below]:
            below += 1
        if keys[below] >= key:
            break
        keys[at], fields[at] = keys[below], fields[below]
        at = below
    keys[at], fields[at] = key, place


@kernel
def estimate(dx: int, dy: int, by_length: bool, least: int, target_weight: int) -> int:
    """Give a lower bound of the cost from a field to the target.

    Parameters
    ----------
    dx, dy : int
        Distances to the target along the axes, not negative.
    by_length : bool
        Count lengths instead of weights.
    least : int
        The least weight of any field between.
    target_weight : int
        The weight of the target.

    Returns
    -------
    int
        Octile distance, or least * (Chebyshev distance - 1) + target_weight.
    """
    longer, shorter = max(dx, dy), min(dx, dy)
    if longer == 0:
        return 0
    if by_length:
        return (longer - shorter) * STRAIGHT + shorter * DIAGONAL
    return (longer - 1) * least + target_weight


@kernel
def search(
    table: NDArray[np.int32],
    start: tuple[int, int],
    target: tuple[int, int],
    rule: int,
    by_length: bool,
    informed: bool,
    least: int,
    costs: NDArray[np.int64],
    arrivals: NDArray[np.int8],
    expansions: NDArray[np.int64],
) -> int:
    """Find a cheapest path from start to target.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    start, target : (x, y)
        Free fields.
    rule : int
        Corner-cutting rule.
    by_length : bool
        Minimise the octile length instead of the sum of weights.
    informed : bool
        True for A*, False for Dijkstra.
    least : int
        The least weight of any free field but start and target.
    costs : (rows * cols,) int64
        Zeros; holds the cost of every field seen plus one, negative once it is settled.
    arrivals : (rows * cols,) int8
        Holds the step by which every field seen was entered.
    expansions : (1,) int64
        Overwritten with the number of fields expanded. (A kernel that runs for long returns
        one number only: an interrupt while numba makes Python objects kills the process.)

    Returns
    -------
    int
        Cost of all fields entered, the start left out, or -1 if there is no path.
    """
    rows, cols = table.shape
    weights = table.ravel()
    if informed:
        target_weight = np.int64(table[target[1], target[0]])
    else:
        least = target_weight = 0
    moves = STEP_Y * cols + STEP_X

    keys = np.empty(1024, dtype=np.int64)
    fields = np.empty(1024, dtype=np.int64)
    end = target[1] * cols + target[0]
    keys[0] = 0
    fields[0] = start[1] * cols + start[0]
    costs[fields[0]] = 1
    size = 1
    expansions[0] = 0
    while size > 0:
        place = fields[0]
        drop_first(keys, fields, size)
        size -= 1
        cost = costs[place]
        if place == end:
            return cost - 1
        if cost < 0:
            continue  # settled: it was pushed again when a cheaper way was found
        costs[place] = -cost
        expansions[0] += 1
        if size + 8 > keys.shape[0]:
            keys = np.concatenate((keys, np.empty_like(keys)))
            fields = np.concatenate((fields, np.empty_like(fields)))
        y0 = place // cols
        x0 = place - y0 * cols
        at_border = x0 == 0 or y0 == 0 or x0 == cols - 1 or y0 == rows - 1
        for step in range(8):
            x1, y1 = x0 + STEP_X[step], y0 + STEP_Y[step]
            if at_border and not (0 <= x1 < cols and 0 <= y1 < rows):
                continue
            neighbour = place + moves[step]
            known = costs[neighbour]
            weight = np.int64(weights[neighbour])
            if known < 0 or weight >= OBSTACLE:
                continue
            if rule != ALLOW and cuts_corner(table, x0, y0, x1, y1, rule):
                continue
            if by_length:
                weight = STRAIGHT if step < 4 else DIAGONAL
            through = cost + weight
            if known == 0 or through < known:
                costs[neighbour] = through
                arrivals[neighbour] = step
                dx, dy = abs(target[0] - x1), abs(target[1] - y1)
                bound = through
                if informed:
                    bound += estimate(dx, dy, by_length, least, target_weight)
                push(keys, fields, size, (bound << TIE_BITS) + max(dx, dy), neighbour)
                size += 1
    return np.int64(-1)


@kernel
def path_to(
    arrivals: NDArray[np.int8], cols: int, start: tuple[int, int], target: tuple[int, int]
) -> NDArray[np.int32]:
    """Follow the steps back from the target.

    Parameters
    ----------
    arrivals : (rows * cols,) int8
        As `search` left it.
    cols : int
        Width of the map.
    start, target : (x, y)
        As in the search.

    Returns
    -------
    (n, 2) int32
        Fields (x, y) from start to target.
    """
    x, y = target
    count = 1
    while (x, y) != start:
        step = arrivals[y * cols + x]
        x, y = x - STEP_X[step], y - STEP_Y[step]
        count += 1
    path = np.empty((count, 2), dtype=np.int32)
    x, y = target
    for i in range(count - 1, -1, -1):
        path[i, 0], path[i, 1] = x, y
        if i > 0:
            step = arrivals[y * cols + x]
            x, y = x - STEP_X[step], y - STEP_Y[step]
    return path
