"""Shortcuts between random fields of a path (as in Geraerts & Overmars 2007)."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.rivals.line_costs import IN_THE_WAY, line_cost
from gapath.kernels.rivals.rrt_connect import field_of_line
from gapath.kernels.rng import Stream, fill, high, low


@kernel(inner=True)
def steps_of(points: NDArray[np.int32], i: int) -> int:
    """Give the number of steps of the line that ends at a way point."""
    dx, dy = abs(points[i, 0] - points[i - 1, 0]), abs(points[i, 1] - points[i - 1, 1])
    return np.int64(max(dx, dy))


@kernel(inner=True)
def at_step(points: NDArray[np.int32], step: int) -> tuple[int, int, int]:
    """Give where a step of the path ends: number of the line, by its end, and the field."""
    i = 1
    while step > steps_of(points, i):
        step -= steps_of(points, i)
        i += 1
    x0, y0 = np.int64(points[i - 1, 0]), np.int64(points[i - 1, 1])
    x, y = field_of_line(x0, y0, np.int64(points[i, 0]), np.int64(points[i, 1]), step)
    return i, x, y


@kernel
def shorten(
    table: NDArray[np.int32],
    way_points: NDArray[np.int32],
    count: int,
    rule: int,
    tries: int,
    stream: Stream,
) -> int:
    """Replace what lies between two random fields of a path by a line wherever that is cheaper.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    way_points : (n, 2) int32
        The first ones are a path, each another field than the one before, joined by lines that are
        free; changed in place.
    count : int
        How many, 2 <= count <= n - tries.
    rule : int
        Corner-cutting rule.
    tries : int
        Pairs of fields to draw.
    stream : (4,) uint64
        A random stream, advanced by a word a try.

    Returns
    -------
    int
        How many way points there are now.
    """
    word = np.empty(1, dtype=np.uint64)
    piece = np.empty((4, 2), dtype=np.int32)
    for _ in range(tries):
        total = np.int64(0)
        for i in range(1, count):
            total += steps_of(way_points, i)
        fill(stream, word)
        one, another = high(word[0], total + 1), low(word[0], total + 1)
        begin, x0, y0 = at_step(way_points, min(one, another))
        end, x1, y1 = at_step(way_points, max(one, another))
        if begin == end:
            continue
        before = np.int64(0)
        for i in range(begin, end + 1):
            x, y = np.int64(way_points[i - 1, 0]), np.int64(way_points[i - 1, 1])
            before += line_cost(
                table, x, y, np.int64(way_points[i, 0]), np.int64(way_points[i, 1]), rule
            )
        piece[0], piece[3] = way_points[begin - 1], way_points[end]
        piece[1, 0], piece[1, 1], piece[2, 0], piece[2, 1] = x0, y0, x1, y1
        # a line in two pieces need not cross the fields of the whole
        after = np.int64(0)
        for i in range(1, 4):
            x, y = np.int64(piece[i - 1, 0]), np.int64(piece[i - 1, 1])
            cost = line_cost(table, x, y, np.int64(piece[i, 0]), np.int64(piece[i, 1]), rule)
            if cost == IN_THE_WAY:
                after = before
                break
            after += cost
        if after >= before:
            continue
        new = 0  # of the piece's fields those that differ from the one before; the first stays
        for i in range(1, 4):
            if steps_of(piece, i) > 0:
                new += 1
                piece[new] = piece[i]
        shift = begin + new - 1 - end
        moved = range(count - 1, end, -1) if shift > 0 else range(end + 1, count)
        for i in moved:
            way_points[i + shift] = way_points[i]
        for i in range(new):
            way_points[begin + i] = piece[1 + i]
        count += shift
    return count
