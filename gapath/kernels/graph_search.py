"""A* and Dijkstra on the 8-connected grid, with one queue and one rule for ties.

The queue is a radix heap (Ahuja, Mehlhorn, Orlin & Tarjan 1990), which priorities that never
fall below the last one taken allow: an item lies in the bucket of the highest bit in which its
priority differs from that one, and moves to lower buckets only. Of equal priorities the newest
goes first. As steps towards the target keep A*'s estimate equal, it goes on towards the target.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import cuts_corner
from gapath.kernels.units import ALLOW, OBSTACLE

STRAIGHT = 1 << 20
"""Length of a straight step, in the unit of lengths."""
DIAGONAL = 1482910
"""Length of a diagonal step, round(sqrt(2) * STRAIGHT)."""

# Straight steps first: at equal cost they win.
STEP_X = np.array([1, -1, 0, 0, 1, 1, -1, -1], dtype=np.int64)
STEP_Y = np.array([0, 0, 1, -1, 1, -1, 1, -1], dtype=np.int64)

BUCKETS = 64
NONE = -1
PRIORITY, FIELD, NEXT = 0, 1, 2  # of an item; NEXT is the number of the next one in its bucket

STATE_BITS = 4
"""A field's state is its cost and, in these bits, the step that led to it plus 2, 1 for the
start; negative once the field is settled, 0 as long as it is unseen."""


@kernel(inner=True)
def bucket_of(priority: int, last: int) -> int:
    """Give the number of bits from the highest on in which two priorities differ."""
    difference = np.uint64(priority ^ last)
    bits = 0
    while difference != 0:  # one machine instruction, once compiled
        difference >>= np.uint64(1)
        bits += 1
    return bits


@kernel(inner=True)
def refill(items: NDArray[np.int64], firsts: NDArray[np.int64]) -> int:
    """Move the items of the lowest bucket that has any to where the least of them is the last.

    Parameters
    ----------
    items : (n, 3) int64
        PRIORITY, FIELD, NEXT of each item; changed in place.
    firsts : (BUCKETS,) int64
        Newest item of each bucket or NONE, bucket 0 being empty; changed in place.

    Returns
    -------
    int
        The least priority, whose items are now in bucket 0; NONE if there are no items.
    """
    bucket = 1
    while bucket < BUCKETS and firsts[bucket] == NONE:
        bucket += 1
    if bucket == BUCKETS:
        return np.int64(NONE)
    item, oldest = firsts[bucket], np.int64(NONE)
    firsts[bucket] = NONE
    least = items[item, PRIORITY]
    while item != NONE:  # turn the list round, so that the newest is put last
        least = min(least, items[item, PRIORITY])
        after = items[item, NEXT]
        items[item, NEXT] = oldest
        item, oldest = after, item
    item = oldest
    while item != NONE:
        after = items[item, NEXT]
        bucket = bucket_of(items[item, PRIORITY], least)
        items[item, NEXT] = firsts[bucket]
        firsts[bucket] = item
        item = after
    return least


@kernel
def search(
    table: NDArray[np.int32],
    start_x: int,
    start_y: int,
    target_x: int,
    target_y: int,
    rule: int,
    by_length: bool,
    informed: bool,
    least: int,
    states: NDArray[np.int64],
    expansions: NDArray[np.int64],
) -> int:
    """Find a cheapest path from start to target.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    start_x, start_y, target_x, target_y : int
        Free fields.
    rule : int
        Corner-cutting rule.
    by_length : bool
        Minimise the octile length instead of the sum of weights.
    informed : bool
        True for A*, False for Dijkstra.
    least : int
        The least weight of any free field but start and target.
    states : (rows * cols,) int64
        Zeros; holds the state of every field seen (`STATE_BITS`).
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
    # the estimate of what is left is linear in the straight and diagonal steps to the target
    straight, diagonal, rest = np.int64(0), np.int64(0), np.int64(0)
    if informed and by_length:
        straight, diagonal = STRAIGHT, DIAGONAL
    elif informed:  # the last step costs the target's weight
        straight = diagonal = least
        rest = table[target_y, target_x] - least
    end = np.uint64(target_y * cols + target_x)

    items = np.empty((256, 3), dtype=np.int64)
    firsts = np.empty(BUCKETS, dtype=np.int64)
    firsts[:] = NONE
    used, spare = 1, np.int64(NONE)  # items made so far, and a list of those to be used again
    items[0, PRIORITY], items[0, FIELD], items[0, NEXT] = 0, start_y * cols + start_x, NONE
    firsts[0] = 0
    last = np.int64(0)
    states[items[0, FIELD]] = 1
    expansions[0] = 0
    while True:
        if firsts[0] == NONE:
            last = refill(items, firsts)
            if last == NONE:
                return np.int64(-1)
        item = firsts[0]
        place = items[item, FIELD]
        firsts[0] = items[item, NEXT]
        items[item, NEXT] = spare
        spare = item
        state = states[place]
        if place == end:
            return state >> STATE_BITS
        if state < 0:
            continue  # it was put in again when a cheaper way was found
        states[place] = -state
        cost = state >> STATE_BITS
        expansions[0] += 1
        if used + 8 > items.shape[0]:
            more = np.empty((2 * items.shape[0], 3), dtype=np.int64)
            for i in range(used):
                for j in range(3):
                    more[i, j] = items[i, j]
            items = more
        y0 = place // cols
        x0 = place - y0 * cols
        at_border = x0 == 0 or y0 == 0 or x0 == cols - 1 or y0 == rows - 1
        for step in range(7, -1, -1):  # the last one put in goes first
            x1, y1 = x0 + STEP_X[step], y0 + STEP_Y[step]
            if at_border and not (0 <= x1 < cols and 0 <= y1 < rows):
                continue
            neighbour = np.uint64(y1 * cols + x1)  # unsigned: numba need not look for a sign
            known = states[neighbour]
            weight = np.int64(weights[neighbour])
            if known < 0 or weight >= OBSTACLE:
                continue
            if rule != ALLOW and cuts_corner(table, x0, y0, x1, y1, rule):
                continue
            if by_length:
                weight = STRAIGHT if step < 4 else DIAGONAL
            through = cost + weight
            if known != 0 and through >= known >> STATE_BITS:
                continue
            states[neighbour] = (through << STATE_BITS) + step + 2
            priority = through
            if neighbour != end:
                dx, dy = abs(target_x - x1), abs(target_y - y1)
                longer, shorter = max(dx, dy), min(dx, dy)
                priority += (longer - shorter) * straight + shorter * diagonal + rest
            if spare == NONE:
                item = used
                used += 1
            else:
                item = spare
                spare = items[item, NEXT]
            bucket = bucket_of(priority, last)
            items[item, PRIORITY], items[item, FIELD] = priority, neighbour
            items[item, NEXT] = firsts[bucket]
            firsts[bucket] = item


@kernel
def path_to(
    states: NDArray[np.int64], cols: int, target_x: int, target_y: int
) -> NDArray[np.int32]:
    """Follow the steps back from the target.

    Parameters
    ----------
    states : (rows * cols,) int64
        As `search` left it.
    cols : int
        Width of the map.
    target_x, target_y : int
        As in the search.

    Returns
    -------
    (n, 2) int32
        Fields (x, y) from start to target.
    """
    mask = (1 << STATE_BITS) - 1
    x, y, count = target_x, target_y, 1
    step = (abs(states[y * cols + x]) & mask) - 2
    while step >= 0:
        x, y, count = x - STEP_X[step], y - STEP_Y[step], count + 1
        step = (abs(states[y * cols + x]) & mask) - 2
    path = np.empty((count, 2), dtype=np.int32)
    x, y = target_x, target_y
    for i in range(count - 1, -1, -1):
        path[i, 0], path[i, 1] = x, y
        step = (abs(states[y * cols + x]) & mask) - 2
        x, y = x - STEP_X[step], y - STEP_Y[step]
    return path
