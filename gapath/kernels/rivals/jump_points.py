"""Jump point search (Harabor & Grastien 2011) without preprocessing, for all corner-cutting rules.

Of equally good paths it follows one only: that of the fewest diagonal steps, and these as early
as can be. So after a step few others are worth a try (`jumps.worth_after`). Without diagonal steps
horizontal ones come first instead. That holds for any lengths of steps with straight <= diagonal <
2 straight, also where a diagonal step costs what a straight one does.

Where two ways to a field are equally good, what is worth a try after either is tried: the path
that is followed may have come by the other one.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.graph_search import NO_PATH, STEP_X, STEP_Y
from gapath.kernels.jit import kernel
from gapath.kernels.rivals.bits import make_tile, no_tiles, tile_of
from gapath.kernels.rivals.jumps import jump, worth_after
from gapath.kernels.rivals.queue import EMPTY, USED, empty_buckets, is_full, more, put, take
from gapath.kernels.units import NO_DIAGONALS

PLACE, COST, BEFORE, STEPS = 0, 1, 2, 3
"""Of a field reached: number, cost, the entry of the field before it, and a bit for each step
worth a try from it, `TRIED` bits higher for those tried."""

TRIED = 8

HASH = np.uint64(0x9E3779B1)

ALL_STEPS, STRAIGHT_STEPS = 0b11111111, 0b1111


SECTORS = [(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1)]
TOWARDS = np.array([np.argsort(x * STEP_X + y * STEP_Y, kind="stable") for x, y in SECTORS])
"""(9, 8) steps by how much they lead towards where the target lies. Of what is equally near the
newest goes first, so they are tried in this order."""


@kernel(inner=True)
def slot_of(entries: NDArray[np.int64], slots: NDArray[np.int32], place: int) -> np.uint64:
    """Find a place in a hash table of the few that were reached.

    Parameters
    ----------
    entries : (n, 4) int64
        PLACE, COST, BEFORE and STEPS of each, in the order in which they were reached.
    slots : (2 n,) int32
        Numbers of entries, from 1 on, 0 where there is none; n is a power of 2.
    place : int
        Number of a field.

    Returns
    -------
    int
        The slot in which it stands, or would.
    """
    mask = np.uint64(slots.shape[0] - 1)
    slot = ((np.uint64(place) * HASH) >> np.uint64(12)) & mask
    while slots[slot] != 0 and entries[slots[slot] - 1, PLACE] != place:
        slot = (slot + np.uint64(1)) & mask
    return slot


@kernel(inner=True)
def slots_for(entries: NDArray[np.int64], count: int) -> NDArray[np.int32]:
    """Make the slots of so many entries, twice as many as there is room for."""
    slots = np.zeros(2 * entries.shape[0], dtype=np.int32)
    for i in range(count):
        slots[slot_of(entries, slots, entries[i, PLACE])] = i + 1
    return slots


@kernel(inner=True)
def distance(x0: int, y0: int, x1: int, y1: int, straight: int, diagonal: int) -> int:
    """Give the length of the shortest way between two fields if nothing stands in it."""
    dx, dy = abs(x1 - x0), abs(y1 - y0)
    return abs(dx - dy) * straight + min(dx, dy) * diagonal


@kernel
def jump_search(
    table: NDArray[np.int32],
    start_x: int,
    start_y: int,
    target_x: int,
    target_y: int,
    rule: int,
    straight: int,
    diagonal: int,
    turns: NDArray[np.int64],
    counts: NDArray[np.int64],
) -> int:
    """Find a shortest path from start to target.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    start_x, start_y, target_x, target_y : int
        Free fields.
    rule : int
        Corner-cutting rule.
    straight, diagonal : int
        Lengths of steps, straight <= diagonal < 2 straight, below 2**32.
    turns : (rows * cols,) int64
        Overwritten with the fields (y * cols + x) between which the path jumps, the target first.
    counts : (1,) int64
        Overwritten with the number of fields expanded.

    Returns
    -------
    int
        How many fields `turns` holds; NO_PATH.
    """
    rows, cols = table.shape
    target = (target_x, target_y)
    if rule == NO_DIAGONALS:
        diagonal = 2 * straight
    words, across, down = no_tiles(rows, cols)
    make_tile(table, words, across, down, tile_of(start_x, start_y, across))
    jumps = np.empty((2 * max(rows, cols) + 1, 3), dtype=np.int32)
    items, buckets = np.empty((256, 2), dtype=np.int64), empty_buckets()
    marks = np.zeros(3, dtype=np.int64)
    marks[USED] = 1

    end = target_y * cols + target_x
    entries, count = np.empty((256, 4), dtype=np.int64), 1
    entries[0, PLACE] = start_y * cols + start_x
    entries[0, COST], entries[0, BEFORE] = 0, -1
    entries[0, STEPS] = STRAIGHT_STEPS if rule == NO_DIAGONALS else ALL_STEPS
    slots = slots_for(entries, count)
    put(items, buckets, marks, 0, 0)
    counts[0] = 0
    while True:
        number = take(items, buckets, marks)
        if number == EMPTY:
            return np.int64(NO_PATH)
        place, cost = entries[number, PLACE], entries[number, COST]
        if place == end:
            break
        steps = entries[number, STEPS]
        steps &= ~(steps >> TRIED)
        if steps & ALL_STEPS == 0:
            continue  # it was put in again when a cheaper way was found
        counts[0] += 1
        entries[number, STEPS] |= steps << TRIED
        y = place // cols
        x = place - y * cols
        sector = 3 * (1 + (target_y > y) - (target_y < y)) + 1 + (target_x > x) - (target_x < x)
        for k in range(8):
            step = TOWARDS[sector, k]
            if steps >> step & 1 == 0:
                continue
            found = jump(words, across, down, x, y, step, target, rule, jumps)
            while found < 0:
                make_tile(table, words, across, down, -1 - found)
                found = jump(words, across, down, x, y, step, target, rule, jumps)
            for i in range(found):
                x1, y1, last = np.int64(jumps[i, 0]), np.int64(jumps[i, 1]), np.int64(jumps[i, 2])
                through = cost + distance(x, y, x1, y1, straight, diagonal)
                slot = slot_of(entries, slots, y1 * cols + x1)
                at = np.int64(slots[slot]) - 1
                worth = worth_after(words, across, x1, y1, last, rule)
                if at < 0:
                    if count == entries.shape[0]:
                        entries = more(entries, 4)
                        slots = slots_for(entries, count)
                        slot = slot_of(entries, slots, y1 * cols + x1)
                    at, count = np.int64(count), count + 1
                    slots[slot] = count
                    entries[at, PLACE] = y1 * cols + x1
                elif through == entries[at, COST]:
                    # another way, as good: what is worth a try after either is
                    if worth & ~entries[at, STEPS] == 0:
                        continue
                    worth |= entries[at, STEPS]
                elif through > entries[at, COST]:
                    continue
                entries[at, COST], entries[at, BEFORE], entries[at, STEPS] = through, number, worth
                if is_full(items, marks):
                    items = more(items, 2)
                ahead = distance(x1, y1, target[0], target[1], straight, diagonal)
                put(items, buckets, marks, at, through + ahead)
    length = 0
    while number >= 0:
        turns[length] = entries[number, PLACE]
        number = entries[number, BEFORE]
        length += 1
    return length


@kernel
def jumped_path(turns: NDArray[np.int64], cols: int, rule: int) -> NDArray[np.int32]:
    """Fill in the fields between those of a path from which it turns.

    Parameters
    ----------
    turns : (n,) int64
        As `jump_search` left them.
    cols : int
        Width of the map.
    rule : int
        As in the search.

    Returns
    -------
    (m, 2) int32
        Fields (x, y) from start to target: of each jump the diagonal steps first, or the
        horizontal ones.
    """
    count = 1
    for i in range(1, turns.shape[0]):
        dx = abs(turns[i] % cols - turns[i - 1] % cols)
        dy = abs(turns[i] // cols - turns[i - 1] // cols)
        count += dx + dy if rule == NO_DIAGONALS else max(dx, dy)
    path = np.empty((count, 2), dtype=np.int32)
    x, y = turns[-1] % cols, turns[-1] // cols
    path[0, 0], path[0, 1] = x, y
    at = 1
    for i in range(turns.shape[0] - 2, -1, -1):
        to_x, to_y = turns[i] % cols, turns[i] // cols
        while x != to_x or y != to_y:
            across = x != to_x
            if across:
                x += 1 if to_x > x else -1
            if y != to_y and not (across and rule == NO_DIAGONALS):
                y += 1 if to_y > y else -1
            path[at, 0], path[at, 1] = x, y
            at += 1
    return path
