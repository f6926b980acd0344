"""From field to field by jumps: which steps are worth a try, and to where nothing else is.

Harabor & Grastien 2011 for corners that may be cut; the other rules are pruned in the same way.
Their paper of 2014 has the two ways of going faster: lines are scanned as bits ("block-based"), and
from a diagonal the fields that lie straight on are found at once, none on the diagonal itself is
kept ("pruning").
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.graph_search import STEP_X, STEP_Y
from gapath.kernels.jit import kernel
from gapath.kernels.rivals.bits import COLUMNS, NOWHERE, ROWS, blocked, is_made, scan, tile_of
from gapath.kernels.units import ALLOW, FORBID, NO_DIAGONALS, ONE_SIDE

MOST_WALLS = np.array([2, 1, 0, 2], dtype=np.int64)
"""Obstacles that a diagonal step may pass between, by the corner-cutting rule."""


@kernel(inner=True)
def step_bit(dx: int, dy: int) -> int:
    """Give the bit of a step: those of `graph_search.STEP_X` and `STEP_Y` in their order."""
    if dx != 0 and dy != 0:
        return 16 << (2 * (dx < 0) + (dy < 0))
    return (1 << (dx < 0)) if dx != 0 else 4 << (dy < 0)


@kernel
def worth_after(
    words: NDArray[np.uint64], across: int, x: int, y: int, step: int, rule: int
) -> int:
    """Give the steps worth a try after a step: whatever else it leads to, another way does, too.

    Parameters
    ----------
    words, across : array and int
        As of `bits.no_tiles`.
    x, y : int
        The field to which the step led.
    step : int
        Number of the step.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    int
        A bit for each step; those that lead nowhere may be among them. Without diagonal steps only
        the target is reached by a horizontal one.
    """
    dx, dy = STEP_X[step], STEP_Y[step]
    beside = rule in (ALLOW, ONE_SIDE)
    steps = 1 << step
    if step >= 4:
        steps |= step_bit(dx, 0) | step_bit(0, dy)
        if beside and blocked(words, across, x - dx, y):
            steps |= step_bit(-dx, dy)
        if beside and blocked(words, across, x, y - dy):
            steps |= step_bit(dx, -dy)
        return steps
    for side in (-1, 1):
        sx, sy = side * abs(dy), side * abs(dx)
        if beside:
            if blocked(words, across, x + sx, y + sy):
                steps |= step_bit(dx + sx, dy + sy)
        elif blocked(words, across, x - dx + sx, y - dy + sy):
            steps |= step_bit(sx, sy)
            if rule == FORBID:
                steps |= step_bit(dx + sx, dy + sy)
    return steps


@kernel(inner=True)
def walk(
    words: NDArray[np.uint64],
    across: int,
    down: int,
    x: int,
    y: int,
    step: int,
    target: tuple[int, int],
    rule: int,
    jumps: NDArray[np.int32],
) -> int:
    """Go on in steps from each of which lines lead on: diagonally, or horizontally without that.

    Parameters
    ----------
    words, across, down : array and int
        As of `bits.no_tiles`.
    x, y : int
        A free field.
    step : int
        Number of the step.
    target : (x, y)
        Stop there.
    rule : int
        Corner-cutting rule.
    jumps : (2 * most + 1, 3) int32
        Overwritten with fields from which more than one step is worth a try: x, y, and number of
        the last step; there are `most` fields on the longest diagonal, or row.

    Returns
    -------
    int
        How many; if it meets a tile that is not made, minus its number - 1.
    """
    dx, dy = STEP_X[step], STEP_Y[step]
    count, tiles = 0, across * down
    while True:
        x1, y1 = x + dx, y + dy
        for tile in (tile_of(x1, y, across), tile_of(x, y1, across), tile_of(x1, y1, across)):
            if not is_made(words, tiles, tile):
                return -1 - tile
        walls = blocked(words, across, x1, y) + blocked(words, across, x, y1)
        if blocked(words, across, x1, y1) or walls > MOST_WALLS[rule]:
            return count
        x, y = x1, y1
        if walls > 0 or (x == target[0] and y == target[1]):
            jumps[count, 0], jumps[count, 1], jumps[count, 2] = x, y, step
            return count + 1
        goal = target[1] + 1 if x == target[0] else NOWHERE
        for side in (-1, 1):
            if side == -dy:
                continue
            at = scan(words, across, down, COLUMNS, x + 1, y + 1, side, goal, rule)
            if at < 0:
                return at
            if at != NOWHERE:
                jumps[count, 0], jumps[count, 1], jumps[count, 2] = x, at - 1, 2 + (side < 0)
                count += 1
        if dy == 0:
            continue
        goal = target[0] + 1 if y == target[1] else NOWHERE
        at = scan(words, across, down, ROWS, y + 1, x + 1, dx, goal, rule)
        if at < 0:
            return at
        if at != NOWHERE:
            jumps[count, 0], jumps[count, 1], jumps[count, 2] = at - 1, y, dx < 0
            count += 1


@kernel(inner=True)
def jump(
    words: NDArray[np.uint64],
    across: int,
    down: int,
    x: int,
    y: int,
    step: int,
    target: tuple[int, int],
    rule: int,
    jumps: NDArray[np.int32],
) -> int:
    """Go on from a field after a first step: as `walk`, or along one line."""
    if step >= 4 or (step < 2 and rule == NO_DIAGONALS):
        return walk(words, across, down, x, y, step, target, rule, jumps)
    if step < 2:
        goal = target[0] + 1 if y == target[1] else NOWHERE
        at = scan(words, across, down, ROWS, y + 1, x + 1, STEP_X[step], goal, rule)
        jumps[0, 0], jumps[0, 1] = at - 1, y
    else:
        goal = target[1] + 1 if x == target[0] else NOWHERE
        at = scan(words, across, down, COLUMNS, x + 1, y + 1, STEP_Y[step], goal, rule)
        jumps[0, 0], jumps[0, 1] = x, at - 1
    jumps[0, 2] = step
    return min(at, 1)
