"""Obstacles as bits, 64 fields a word, by rows and by columns, made where a search comes by.

A border of obstacles surrounds the map, so field (x, y) is bit x + 1 of row y + 1, and bit y + 1
of column x + 1. Words come in tiles of 64 x 64 fields, each read from the table at the first look;
what no search comes near costs nothing. All of it is one array, and who meets a tile that is not
made says so to its caller: a kernel that passes arrays on pays for each of them at every call.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.graph_search import bits_of
from gapath.kernels.jit import kernel
from gapath.kernels.units import ALLOW, OBSTACLE, OBSTACLE_BITS, ONE_SIDE

ROWS, COLUMNS = 0, 1
"""What lines are."""

NOWHERE = 0
"""Instead of a position on a line: that of the border."""

NO_BIT, ONE, ALL = np.uint64(0), np.uint64(1), np.uint64(2**64 - 1)
TOP = np.uint64(63)


@kernel
def no_tiles(rows: int, cols: int) -> tuple[NDArray[np.uint64], int, int]:
    """Begin without a tile.

    Parameters
    ----------
    rows, cols : int
        Fields of the map.

    Returns
    -------
    words : (130 * across * down,) uint64
        All rows, then all columns, of which nothing is made; then for each tile whether it is, row
        by row, and again column by column.
    across, down : int
        Tiles from left to right, and from top to bottom.
    """
    across, down = (cols + 65) >> 6, (rows + 65) >> 6
    tiles = across * down
    words = np.empty(130 * tiles, dtype=np.uint64)
    words[128 * tiles :] = 0
    return words, across, down


@kernel
def make_tile(
    table: NDArray[np.int32], words: NDArray[np.uint64], across: int, down: int, tile: int
) -> None:
    """Read a tile of the table.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    words, across, down : array and int
        As of `no_tiles`; the words are changed in place.
    tile : int
        Its number, row by row.
    """
    rows, cols = table.shape
    i, j, tiles = tile // across, tile % across, across * down
    columns = np.empty(64, dtype=np.uint64)
    row = np.full(64, OBSTACLE, dtype=np.int32)
    flat = table.ravel()
    left, right = max(64 * j - 1, 0), min(64 * j + 63, cols)
    for k in range(64):
        y, word = 64 * i + k - 1, ALL
        if 0 <= y < rows:
            for x in range(left, right):  # unsigned: numba looks for no sign, and makes vectors
                row[np.uint64(x + 1 - 64 * j)] = flat[np.uint64(y * cols + x)]
            word = NO_BIT
            for x in range(64):
                word |= np.uint64(row[np.uint64(x)] >> OBSTACLE_BITS) << np.uint64(x)
        columns[k] = word
        words[(64 * i + k) * across + j] = word
    # transposed: halves, quarters, ... change places (Warren, Hacker's Delight, Sec. 7-3)
    half, mask = 32, np.uint64(0xFFFFFFFF)
    while half > 0:
        shift = np.uint64(half)
        for first in range(0, 64, 2 * half):
            for k in range(first, first + half):
                upper, lower = np.uint64(k), np.uint64(k + half)
                swap = ((columns[upper] >> shift) ^ columns[lower]) & mask
                columns[upper] ^= swap << shift
                columns[lower] ^= swap
        half >>= 1
        mask ^= mask << np.uint64(half)
    for k in range(64):
        words[64 * tiles + (64 * j + k) * down + i] = columns[k]
    words[128 * tiles + tile] = 1
    words[129 * tiles + j * down + i] = 1


@kernel(inner=True)
def tile_of(x: int, y: int, across: int) -> int:
    """Give the number of the tile of a field, or of one of the border."""
    return ((y + 1) >> 6) * across + ((x + 1) >> 6)


@kernel(inner=True)
def is_made(words: NDArray[np.uint64], tiles: int, tile: int) -> bool:
    """Tell whether a tile is made."""
    return words[np.uint64(128 * tiles + tile)] != 0


@kernel(inner=True)
def blocked(words: NDArray[np.uint64], across: int, x: int, y: int) -> int:
    """Give 1 for an obstacle, on the map or of the border, else 0; its tile is made."""
    word = words[np.uint64((y + 1) * across + ((x + 1) >> 6))]
    return np.int64(word >> np.uint64((x + 1) & 63) & ONE)


@kernel
def scan(
    words: NDArray[np.uint64],
    across: int,
    down: int,
    lines: int,
    line: int,
    at: int,
    step: int,
    goal: int,
    rule: int,
) -> int:
    """Go on along a line to the next field from which more than straight on is worth a try.

    That is where an obstacle beside the line ends: a step to its end may be the best way there.

    Parameters
    ----------
    words, across, down : array and int
        As of `no_tiles`.
    lines : int
        ROWS or COLUMNS.
    line, at : int
        A free field.
    step : int
        1 or -1.
    goal : int
        Where the target lies on this line; NOWHERE if it does not.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    int
        Where it is on the line, the goal if that comes first; NOWHERE if an obstacle does. With
        ALLOW and ONE_SIDE it is the last field beside the obstacle, else the first one after it.
        If it meets a tile that is not made, minus its number - 1.
    """
    tiles, a_line = across * down, across if lines == ROWS else down
    first = 64 * lines * tiles + line * a_line
    above = (128 + lines) * tiles + ((line - 1) >> 6) * a_line
    below = (128 + lines) * tiles + ((line + 1) >> 6) * a_line
    beside = rule in (ALLOW, ONE_SIDE)
    here = ONE << np.uint64(at & 63)
    ahead = ~(here | (here - ONE)) if step > 0 else here - ONE
    hidden = here if beside else NO_BIT  # an obstacle beside the first field is the caller's
    word, carry_0, carry_1 = at >> 6, NO_BIT, NO_BIT
    while True:
        if words[np.uint64(above + word)] == 0 or words[np.uint64(below + word)] == 0:
            upper = words[np.uint64(above + word)] == 0
            band = (line - 1 if upper else line + 1) >> 6
            return -1 - (band * across + word if lines == ROWS else word * across + band)
        k = first + word
        walls = words[np.uint64(k)]
        side_0 = words[np.uint64(k - a_line)] & ~hidden
        side_1 = words[np.uint64(k + a_line)] & ~hidden
        if step > 0:
            ends = (side_0 << ONE | carry_0) & ~side_0 | (side_1 << ONE | carry_1) & ~side_1
            carry_0, carry_1 = side_0 >> TOP, side_1 >> TOP
        else:
            ends = (side_0 >> ONE | carry_0) & ~side_0 | (side_1 >> ONE | carry_1) & ~side_1
            carry_0, carry_1 = side_0 << TOP, side_1 << TOP
        stops = (walls | ends) & ahead
        if stops != 0:
            break
        word, ahead, hidden = word + step, ALL, NO_BIT
    bit = np.int64(bits_of(stops & (~stops + ONE) if step > 0 else stops) - 1)
    stop, here = 64 * word + bit, ONE << np.uint64(bit)
    is_wall = walls & here != 0
    last = stop - step if beside or is_wall else stop
    if goal != NOWHERE and (goal - at) * step > 0 and (last - goal) * step >= 0:
        return goal
    if is_wall and (rule != ALLOW or ends & here == 0):
        return np.int64(NOWHERE)
    return last
