"""A* and Dijkstra on the 8-connected grid, with one queue and one rule for ties.

A path is better if its weights sum up to less, and of equal ones if it has fewer fields: both
stand in one integer, weights above fields, and so does the estimate of what is left.

The queue is a radix heap (Ahuja, Mehlhorn, Orlin & Tarjan 1990), which priorities that never
fall below the last one taken allow: an item lies in the bucket of the highest digit in which its
priority differs from that one, and moves to lower buckets only. Of equal priorities the newest
goes first. As steps towards the target keep A*'s estimate equal, it goes on towards the target.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import too_narrow
from gapath.kernels.units import ALLOW, OBSTACLE

FIELD_BITS = 21
"""Bits below a path's weights in which its fields are counted."""

BY_LENGTH = -1
"""Instead of `FIELD_BITS`: minimise the octile length."""

STRAIGHT = 1 << 20
"""Length of a straight step, in the unit of lengths."""
DIAGONAL = 1482910
"""Length of a diagonal step, round(sqrt(2) * STRAIGHT)."""

# Straight steps first: at equal cost they win.
STEP_X = np.array([1, -1, 0, 0, 1, 1, -1, -1], dtype=np.int64)
STEP_Y = np.array([0, 0, 1, -1, 1, -1, 1, -1], dtype=np.int64)

NO_PATH, TOO_LONG = -1, -2
"""Instead of a cost."""

STATE_BITS = 4
"""A field's state is its cost and, in these bits, the step that led to it plus 2, 1 for the
start; negative once the field is settled, 0 as long as it is unseen."""

LIMIT = 1 << 58
"""A cost from which on a step might not fit into a state."""


def _worth() -> NDArray[np.int64]:
    x, y = (np.abs(np.add.outer(step, step)) for step in (STEP_X, STEP_Y))
    worth = np.full((2, 10, 9), -1, dtype=np.int64)
    worth[:, :2, :8] = np.arange(7, -1, -1)
    for rule, elsewhere in enumerate((np.maximum(x, y) > 1, x + y > 1)):
        for before in range(8):
            steps = np.flatnonzero(elsewhere[before])[::-1]
            worth[rule, before + 2, : len(steps)] = steps
    return worth


WORTH = _worth()
"""(2, 10, 9) steps worth a try after a step, the last first, then -1; by the rule (0 for ALLOW)
and that step as a state has it. Others lead where the field before leads in one step, if no rule
forbids diagonal ones: this way is longer by the weight of a field, or at least by the field."""

DIGIT_BITS = 4
DIGITS = 1 << DIGIT_BITS
BUCKETS = DIGITS * 64 // DIGIT_BITS

PRIORITY, LINK = 0, 1  # of an item
LINK_BITS = 32
NEXT = (1 << LINK_BITS) - 1
"""Bits of a LINK: the number of the next item in its bucket; above them is the item's field."""
NONE = 0
"""Number of no item."""


class Buckets(NamedTuple):
    """Where items are; bucket d has those equal to the last one taken but for the last digit d."""

    filled: NDArray[np.uint64]
    """(BUCKETS / 64,) a bit for each bucket that has items; of others nothing else counts."""
    firsts: NDArray[np.int64]
    """(BUCKETS,) the newest item."""
    oldest: NDArray[np.int64]
    """(BUCKETS,) the item that `spread` put last."""
    leasts: NDArray[np.int64]
    """(BUCKETS,) the least priority."""


@kernel(inner=True)
def bits_of(number: int) -> int:
    """Give the number of bits that a number has from its highest one on."""
    rest = np.uint64(number)
    bits = 0
    while rest != 0:  # one machine instruction, once compiled
        rest >>= np.uint64(1)
        bits += 1
    return bits


@kernel(inner=True)
def bucket_of(priority: int, last: int) -> np.uint64:
    """Give the bucket of a priority: the highest digit that differs from the last one's."""
    shift = (bits_of(priority ^ last | 1) - 1) // DIGIT_BITS * DIGIT_BITS
    digit = (priority >> shift) & (DIGITS - 1)
    return np.uint64(shift // DIGIT_BITS * DIGITS + digit)  # unsigned: numba looks for no sign


@kernel(inner=True)
def lowest(buckets: Buckets) -> np.uint64:
    """Give the lowest bucket that has items; BUCKETS if none has."""
    for word in range(BUCKETS // 64):
        filled = buckets.filled[word]
        if filled != 0:
            return np.uint64(64 * word + bits_of(filled & (~filled + np.uint64(1))) - 1)
    return np.uint64(BUCKETS)


@kernel(inner=True)
def mark(buckets: Buckets, bucket: np.uint64, least: int) -> bool:
    """Say that a bucket has such an item; give whether it had others."""
    word, bit = bucket >> np.uint64(6), np.uint64(1) << (bucket & np.uint64(63))
    had = buckets.filled[word] & bit != 0
    buckets.filled[word] |= bit
    buckets.leasts[bucket] = min(buckets.leasts[bucket], least) if had else least
    return had


@kernel(inner=True)
def clear(buckets: Buckets, bucket: np.uint64) -> None:
    """Say that a bucket has no items."""
    buckets.filled[bucket >> np.uint64(6)] &= ~(np.uint64(1) << (bucket & np.uint64(63)))


@kernel(inner=True)
def spread(items: NDArray[np.int64], buckets: Buckets, bucket: np.uint64) -> int:
    """Move the items of the lowest bucket to where the least of them is the last one taken.

    Parameters
    ----------
    items : (n, 2) int64
        PRIORITY and LINK of each item; changed in place.
    buckets : Buckets
        Changed in place.
    bucket : int
        The lowest that has items.

    Returns
    -------
    int
        Their least priority.
    """
    item, least = buckets.firsts[bucket], buckets.leasts[bucket]
    clear(buckets, bucket)
    while item != NONE:  # the newest first, and so they stay
        priority, link = items[item, PRIORITY], items[item, LINK]
        items[item, LINK] = link & ~NEXT
        bucket = bucket_of(priority, least)
        if mark(buckets, bucket, priority):
            items[buckets.oldest[bucket], LINK] |= item
        else:
            buckets.firsts[bucket] = item
        buckets.oldest[bucket] = item
        item = link & NEXT
    return least


@kernel
def search(
    table: NDArray[np.int32],
    start_x: int,
    start_y: int,
    target_x: int,
    target_y: int,
    rule: int,
    field_bits: int,
    informed: bool,
    least: int,
    states: NDArray[np.int64],
    expansions: NDArray[np.int64],
) -> int:
    """Find a cheapest path from start to target, and of several one of the fewest fields.

    A path's weights stand above the number of its fields in one integer, so that less is better
    in both, in this order; the target, which every path enters once, is not counted.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    start_x, start_y, target_x, target_y : int
        Free fields.
    rule : int
        Corner-cutting rule.
    field_bits : int
        `FIELD_BITS`; with 0 no fields are counted, with BY_LENGTH the octile length is minimised
        instead of the sum of weights.
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
        Cost of all fields entered, the start left out; NO_PATH, or TOO_LONG if there are more
        fields or weights to a path than can be counted.
    """
    rows, cols = table.shape
    weights = table.ravel()
    by_length = field_bits == BY_LENGTH
    bits = np.int64(0) if by_length else np.int64(field_bits)
    one = np.int64(bits > 0)  # what a field counts
    most = (np.int64(1) << bits) - 1
    # the estimate of what is left is linear in the straight and diagonal steps to the target,
    # but that the target is a field that is not counted, whose weight is its own
    straight, diagonal, rest = np.int64(0), np.int64(0), one
    if informed and by_length:
        straight, diagonal = STRAIGHT, DIAGONAL
    elif informed:
        straight = diagonal = (np.int64(least) << bits) + one
        rest = (table[target_y, target_x] - np.int64(least)) << bits
    end = np.uint64(target_y * cols + target_x)
    strict = np.uint64(rule != ALLOW)

    items = np.empty((256, 2), dtype=np.int64)
    used, spare = 2, np.int64(NONE)  # items made so far, and a list of those to be used again
    buckets = Buckets(
        np.zeros(BUCKETS // 64, dtype=np.uint64),
        np.empty(BUCKETS, dtype=np.int64),
        np.empty(BUCKETS, dtype=np.int64),
        np.empty(BUCKETS, dtype=np.int64),
    )
    begin, last = start_y * cols + start_x, np.int64(0)
    items[1, PRIORITY], items[1, LINK] = last, begin << LINK_BITS
    mark(buckets, np.uint64(0), last)
    buckets.firsts[0] = 1
    states[begin], expansions[0] = 1, 0
    while True:
        bucket = lowest(buckets)
        if bucket >= DIGITS:
            if bucket == BUCKETS:
                return np.int64(NO_PATH)
            last = spread(items, buckets, bucket)
            bucket = np.uint64(last & (DIGITS - 1))
        item = buckets.firsts[bucket]
        link = items[item, LINK]
        if link & NEXT == NONE:
            clear(buckets, bucket)
        else:
            buckets.firsts[bucket] = link & NEXT
        place = link >> LINK_BITS
        items[item, LINK], spare = spare, item
        state = states[place]
        if place == end:
            return state >> (STATE_BITS + bits)
        if state < 0:
            continue  # it was put in again when a cheaper way was found
        states[place] = -state
        cost = state >> STATE_BITS
        if one and (cost & most == most or cost >= LIMIT):
            return np.int64(TOO_LONG)
        expansions[0] += 1
        if used + 8 > items.shape[0]:
            more = np.empty((2 * items.shape[0], 2), dtype=np.int64)
            for i in range(used):
                more[i, PRIORITY], more[i, LINK] = items[i, PRIORITY], items[i, LINK]
            items = more
        worth = WORTH[strict, np.uint64(state & ((1 << STATE_BITS) - 1))]
        y0 = place // cols
        x0 = place - y0 * cols
        at_border = x0 == 0 or y0 == 0 or x0 == cols - 1 or y0 == rows - 1
        for step in worth:  # the last one put in goes first
            if step < 0:
                break
            x1, y1 = x0 + STEP_X[step], y0 + STEP_Y[step]
            if at_border and not (0 <= x1 < cols and 0 <= y1 < rows):
                continue
            neighbour = np.uint64(y1 * cols + x1)  # unsigned: numba need not look for a sign
            known = states[neighbour]
            weight = np.int64(weights[neighbour])
            if known < 0 or weight >= OBSTACLE:
                continue
            if rule != ALLOW and step >= 4:
                walls = np.int64(weights[np.uint64(y0 * cols + x1)] >= OBSTACLE)
                walls += weights[np.uint64(y1 * cols + x0)] >= OBSTACLE
                if too_narrow(walls, rule):
                    continue
            weight = (weight << bits) + one
            if by_length:
                weight = STRAIGHT if step < 4 else DIAGONAL
            through = cost + weight
            if known != 0 and through >= known >> STATE_BITS:
                continue
            states[neighbour] = (through << STATE_BITS) + step + 2
            priority = through - one
            if neighbour != end:
                dx, dy = abs(target_x - x1), abs(target_y - y1)
                longer, shorter = max(dx, dy), min(dx, dy)
                priority += (longer - shorter) * straight + shorter * diagonal + rest
            if spare == NONE:
                item = used
                used += 1
            else:
                item = spare
                spare = items[item, LINK]
            bucket = bucket_of(priority, last)
            link = np.int64(neighbour) << LINK_BITS
            if mark(buckets, bucket, priority):
                link |= buckets.firsts[bucket]
            items[item, PRIORITY], items[item, LINK] = priority, link
            buckets.firsts[bucket] = item


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
