"""The first path: straight towards the target, and with a hand on the wall round what is there.

Where the ray to the target is blocked, one or both hands follow the wall until a field is nearer
to the target than where the wall was met, and the next field towards the target is free, as Bug
algorithms do (Lumelsky & Stepanov 1987; Kamon & Rivlin 1997).

That a hand which comes round proves that there is no way takes more care on a grid, where the next
wall may begin right behind this one. Whoever came round was on all fields beside the obstacle on
this side. If the target can be reached, then the ray, where it leaves the obstacle for the last
time, is beside it again, on this side and nearer to the target. So if none of the fields is nearer
than where the wall was met, there is no way; else the ray from the nearest one never meets this
obstacle again, and the path goes on from there. Each ray begins nearer to the target than the one
before, so this ends.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.memetic.rays import append_ray, field_at, ray
from gapath.kernels.memetic.steps import (
    STEP_X,
    STEP_Y,
    X_BITS,
    X_MASK,
    is_free,
    may_step,
    towards,
    wall_of,
    wall_step,
)
from gapath.kernels.rng import Stream, fill, high, low

NO_WAY, GIVEN_UP = -1, -2
"""Instead of a number of fields: proved that there is no path; steps spent."""

LEFT, RIGHT, BOTH = 1, 2, 3
"""Hands that follow a wall."""

STRIDE = 4
"""Steps that a hand makes before it is the other's turn."""

SAMPLES = 16
"""Rows, and columns, of fields that are looked at for narrow corridors."""

AWAY, ROUND, FULL, SPENT = range(4)
"""How a walk along a wall stands."""

X, Y, WALL, FIRST, NEAREST, AT, LENGTH, PACE = range(8)
"""What is known of a hand: where it is, its first state, the least squared distance to the target
so far, and after how many steps that was."""


@kernel(inner=True)
def walk(
    table: NDArray[np.int32],
    target_x: int,
    target_y: int,
    rule: int,
    met: int,
    budget: int,
    state: NDArray[np.int64],
    steps: NDArray[np.uint32],
) -> tuple[int, int, int]:
    """Follow a wall with one or both hands until one gets away or comes round.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    target_x, target_y, rule : int
        As of `first_path`.
    met : int
        Squared distance to the target where the wall was met.
    budget : int
        Most steps.
    state : (2, 7) int64
        What is known of each hand; changed in place.
    steps : (2, n) uint32
        The fields that each hand came to.

    Returns
    -------
    how : int
        AWAY, ROUND, FULL if there is no room for another step, or SPENT.
    hand : int
        Which hand it was, 0 or 1.
    walked : int
        Steps made.
    """
    room = steps.shape[1]
    hand, turns, walked = 0, np.int64(0), np.int64(0)
    side = 1
    x, y, wall, length = state[0, X], state[0, Y], state[0, WALL], state[0, LENGTH]
    turns = state[0, PACE]
    while True:
        if turns == 0:  # the other hand's
            state[hand, X], state[hand, Y], state[hand, WALL] = x, y, wall
            state[hand, LENGTH] = length
            hand = 1 - hand
            side = 1 - 2 * hand
            x, y, wall, length = (
                state[hand, X],
                state[hand, Y],
                state[hand, WALL],
                state[hand, LENGTH],
            )
            turns = state[hand, PACE]
            continue
        turns -= 1
        if length >= room or walked >= budget:
            how = FULL if length >= room else SPENT
            break
        x, y, wall = wall_step(table, x, y, wall, side, rule)
        steps[hand, length] = (y << X_BITS) + x
        length += 1
        walked += 1
        if ((y << X_BITS) + x) << 3 | wall == state[hand, FIRST]:
            how = ROUND
            break
        if length == 1:
            state[hand, FIRST] = ((y << X_BITS) + x) << 3 | wall
        distance = (x - target_x) ** 2 + (y - target_y) ** 2
        if distance < met:
            if distance < state[hand, NEAREST]:
                state[hand, NEAREST], state[hand, AT] = distance, length
            dx, dy = towards(x, y, target_x, target_y)
            if distance == 0 or may_step(table, x, y, x + dx, y + dy, rule):
                how = AWAY
                break
    state[hand, X], state[hand, Y], state[hand, WALL] = x, y, wall
    state[hand, LENGTH] = length
    return how, hand, walked


@kernel(inner=True)
def grown(buffer: NDArray[np.uint32], count: int, needed: int) -> NDArray[np.uint32]:
    """Give a buffer with room for so many numbers, the first ones copied if it is another one."""
    if needed <= buffer.shape[0]:
        return buffer
    larger = np.empty(max(needed, 2 * buffer.shape[0]), dtype=np.uint32)
    for k in range(count):
        larger[k] = buffer[k]
    return larger


@kernel
def first_path(
    table: NDArray[np.int32],
    start_x: int,
    start_y: int,
    target_x: int,
    target_y: int,
    rule: int,
    hands: int,
    budget: int,
    varied: bool,
    path: NDArray[np.uint32],
    stream: Stream,
) -> tuple[int, int, NDArray[np.uint32]]:
    """Find a path from start to target by rays and walls.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    start_x, start_y, target_x, target_y : int
        Free fields.
    rule : int
        Corner-cutting rule.
    hands : int
        LEFT, RIGHT, or BOTH at once: the first that gets away is followed.
    budget : int
        Most steps along walls.
    varied : bool
        Instead, at each wall one hand may be up to eight times as fast as the other.
    path : (n,) uint32
        Room for the path; another one is made if it is too small.

    Returns
    -------
    count : int
        How many fields the path has, NO_WAY or GIVEN_UP.
    walked : int
        Steps along walls.
    path : (m,) uint32
        The fields from start to target (`gapath.kernels.memetic.steps`), each a neighbour of the
        one before; a field may come again.
    """
    state = np.empty((2, 8), dtype=np.int64)
    steps = np.empty((2, 128), dtype=np.uint32)
    x, y = np.int64(start_x), np.int64(start_y)
    path = grown(path, 0, 1)
    path[0] = (y << X_BITS) + x
    count, walked = 1, np.int64(0)
    while True:
        n = max(abs(target_x - x), abs(target_y - y))
        blocked, _ = ray(table, x, y, target_x, target_y, rule)
        free = blocked - 1 if blocked else n
        path = grown(path, count, count + 2 * free)
        count = append_ray(table, x, y, target_x, target_y, free, rule, path, count)
        if blocked == 0:
            return count, walked, path
        u, v = field_at(x, y, target_x, target_y, blocked)
        x, y = np.int64(path[count - 1] & X_MASK), np.int64(path[count - 1] >> X_BITS)
        met = (x - target_x) ** 2 + (y - target_y) ** 2
        for hand in range(2):
            wall = wall_of(table, x, y, u - x, v - y, 1 - 2 * hand, rule)
            state[hand, X], state[hand, Y], state[hand, WALL] = x, y, wall
            state[hand, FIRST], state[hand, NEAREST] = -1, met
            state[hand, LENGTH] = 0

        how, hand = FULL, 0
        state[0, PACE], state[1, PACE] = STRIDE * (hands & LEFT), STRIDE * (hands >> 1)
        if varied:
            word = np.empty(1, dtype=np.uint64)
            fill(stream, word)
            state[0, PACE] = STRIDE << low(word[0], 4)
            state[1, PACE] = STRIDE << high(word[0], 4)
        while how == FULL:
            how, hand, more = walk(
                table, target_x, target_y, rule, met, budget - walked, state, steps
            )
            walked += more
            if how == FULL:
                longer = np.empty((2, 2 * steps.shape[1]), dtype=np.uint32)
                for k in range(steps.shape[1]):
                    longer[0, k], longer[1, k] = steps[0, k], steps[1, k]
                steps = longer
        length = state[hand, LENGTH]
        if how == SPENT:
            return GIVEN_UP, walked, path
        if how == ROUND:
            hand = 0 if state[0, NEAREST] <= state[1, NEAREST] else 1
            if state[hand, NEAREST] == met:
                return NO_WAY, walked, path
            length = state[hand, AT]
        path = grown(path, count, count + length)
        for k in range(length):
            path[count + k] = steps[hand, k]
        count += length
        x, y = np.int64(path[count - 1] & X_MASK), np.int64(path[count - 1] >> X_BITS)
        if x == target_x and y == target_y:
            return count, walked, path


@kernel
def is_narrow(table: NDArray[np.int32]) -> bool:
    """Tell whether most free fields, of some all over the map, have at most three free neighbours.

    There a search sees about as many fields as hands do, and is the faster.
    """
    rows, cols = table.shape
    free, narrow = 0, 0
    for i in range(SAMPLES * SAMPLES):
        y, x = (2 * (i // SAMPLES) + 1) * rows // (2 * SAMPLES), (i % SAMPLES) * cols // SAMPLES
        x = (x + i // SAMPLES) % cols  # not all in one column of what repeats itself
        if not is_free(table, x, y):
            continue
        around = 0
        for k in range(8):
            around += is_free(table, x + STEP_X[k], y + STEP_Y[k])
        free += 1
        narrow += around <= 3
    return 2 * narrow > free
