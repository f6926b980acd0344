"""RRT-Connect (Kuffner & LaValle 2000): two trees of straight lines, one from either end.

A tree grows by a step towards a random field; then the other grows towards where that led, step
by step, until it is there or something is in the way, and they change places. The nearest field of
a tree is looked for in squares of the map, from near to far.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.graph_search import NO_PATH
from gapath.kernels.jit import kernel
from gapath.kernels.lines import ONE_OBSTACLE, Ends, line_key
from gapath.kernels.raster import HALF, SHIFT, slope
from gapath.kernels.rivals.queue import more
from gapath.kernels.rng import Stream, fill, high, low

X, Y, BEFORE, NEXT = 0, 1, 2, 3
"""Of a tree's field: where it is, the number of the one from which it grew, and that of the next
in the same square, -1 for none."""

SQUARE_BITS = 4
"""Squares are 16 fields wide."""


@kernel
def field_of_line(x0: int, y0: int, x1: int, y1: int, i: int) -> tuple[int, int]:
    """Give field i of a straight line of n = max(|dx|, |dy|) >= 1 steps, 0 <= i <= n."""
    dx, dy = x1 - x0, y1 - y0
    n = max(abs(dx), abs(dy))
    x, y = (x0 << SHIFT) + HALF + i * slope(dx, n), (y0 << SHIFT) + HALF + i * slope(dy, n)
    return x >> SHIFT, y >> SHIFT


@kernel(inner=True)
def add(
    nodes: NDArray[np.int64],
    count: int,
    firsts: NDArray[np.int32],
    x: int,
    y: int,
    before: int,
) -> None:
    """Add a field to a tree, whose squares' first fields are given."""
    row, col = y >> SQUARE_BITS, x >> SQUARE_BITS
    nodes[count, X], nodes[count, Y], nodes[count, BEFORE] = x, y, before
    nodes[count, NEXT] = firsts[row, col]
    firsts[row, col] = count


@kernel
def nearest(nodes: NDArray[np.int64], firsts: NDArray[np.int32], x: int, y: int) -> int:
    """Find the field of a tree nearest to another, the first that grew of several.

    Parameters
    ----------
    nodes : (n, 4) int64
        X, Y, BEFORE and NEXT of fields, of this tree and of others.
    firsts : (down, across) int32
        A field of the tree in each square, -1 for none; it has one at least.
    x, y : int
        A field of the map.

    Returns
    -------
    int
        Its number.
    """
    down, across = firsts.shape
    row, col = y >> SQUARE_BITS, x >> SQUARE_BITS
    best, least = np.int64(-1), np.int64(1) << 62
    reach = 0
    while True:
        # fields of squares so far away are at least so far away
        gap = max(reach - 1, 0) << SQUARE_BITS
        if best >= 0 and gap * gap > least:
            return best
        for i in range(max(row - reach, 0), min(row + reach + 1, down)):
            inside = abs(i - row) < reach
            for j in range(max(col - reach, 0), min(col + reach + 1, across)):
                if inside and abs(j - col) < reach:
                    continue
                number = np.int64(firsts[i, j])
                while number >= 0:
                    dx, dy = nodes[number, X] - x, nodes[number, Y] - y
                    far = dx * dx + dy * dy
                    if far < least or (far == least and number < best):
                        best, least = number, far
                    number = nodes[number, NEXT]
        reach += 1


@kernel
def rrt_connect(
    table: NDArray[np.int32],
    ends: Ends,
    rule: int,
    iterations: int,
    step: int,
    way_points: NDArray[np.int32],
    counts: NDArray[np.int64],
    stream: Stream,
) -> int:
    """Grow two trees until they meet.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    ends : Ends
        Free fields that differ.
    rule : int
        Corner-cutting rule.
    iterations : int
        Random fields to draw.
    step : int
        Steps of a line at most, at least 1.
    way_points : (2 * rows * cols, 2) int32
        Overwritten with the way points (x, y) from start to target.
    counts : (1,) int64
        Overwritten with the number of fields in both trees.
    stream : (4,) uint64
        A random stream, advanced by a word an iteration.

    Returns
    -------
    int
        How many way points; NO_PATH if the trees have not met.
    """
    rows, cols = table.shape
    shape = (((rows - 1) >> SQUARE_BITS) + 1, ((cols - 1) >> SQUARE_BITS) + 1)
    own, other = np.full(shape, -1, dtype=np.int32), np.full(shape, -1, dtype=np.int32)
    nodes, count = np.empty((256, 4), dtype=np.int64), np.int64(2)
    add(nodes, 0, own, ends.start_x, ends.start_y, -1)
    add(nodes, 1, other, ends.target_x, ends.target_y, -1)
    word = np.empty(1, dtype=np.uint64)
    for iteration in range(iterations):
        fill(stream, word)
        to_x, to_y = high(word[0], cols), low(word[0], rows)
        at = nearest(nodes, own, to_x, to_y)
        grown, connects = np.int64(-1), False
        while True:
            x0, y0 = nodes[at, X], nodes[at, Y]
            n = max(abs(to_x - x0), abs(to_y - y0))
            if n == 0:
                break
            reach = min(step, n)
            x, y = field_of_line(x0, y0, to_x, to_y, reach)
            while reach > 0 and line_key(table, x0, y0, x, y, rule) >= ONE_OBSTACLE:
                reach >>= 1
                x, y = field_of_line(x0, y0, to_x, to_y, reach)
            if reach == 0:
                break
            if count == nodes.shape[0]:
                nodes = more(nodes, 2)
            add(nodes, count, other if connects else own, x, y, at)
            at, count = count, count + 1
            if not connects:  # the other tree's turn
                grown, connects, to_x, to_y = at, True, x, y
                at = nearest(nodes, other, to_x, to_y)
        counts[0] = count
        if connects and nodes[at, X] == to_x and nodes[at, Y] == to_y:
            # even iterations grow the start's tree
            return joined(nodes, grown, at, iteration & 1 == 1, way_points)
        own, other = other, own
    counts[0] = count
    return np.int64(NO_PATH)


@kernel(inner=True)
def joined(
    nodes: NDArray[np.int64],
    one: int,
    another: int,
    backwards: bool,
    way_points: NDArray[np.int32],
) -> int:
    """Write down the way from the root of one's tree to the root of another's, or back."""
    if backwards:
        one, another = another, one
    length, at = 0, one
    while at >= 0:
        length, at = length + 1, nodes[at, BEFORE]
    at = one
    for i in range(length - 1, -1, -1):
        way_points[i, 0], way_points[i, 1] = nodes[at, X], nodes[at, Y]
        at = nodes[at, BEFORE]
    at = nodes[another, BEFORE]  # where they meet both have been
    while at >= 0:
        way_points[length, 0], way_points[length, 1] = nodes[at, X], nodes[at, Y]
        length, at = length + 1, nodes[at, BEFORE]
    return length
