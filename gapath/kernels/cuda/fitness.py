"""KG18's fitness in 32 bits wherever those are enough: `gapath.kernels.kg18.fitness`, for GPUs.

The processor divides and multiplies floats, whose floor is exact, and steps along lines in 64 bits.
A GPU is slow at both. Here are whole numbers only, and 32 bits of them on the lines that matter
most; all others are the processor's own `gapath.kernels.lines.line_key`.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import (
    KEY_BITS,
    MOST_OBSTACLES,
    ONE_OBSTACLE,
    WEIGHT_MASK,
    entry,
    line_key,
)
from gapath.kernels.raster import COORDINATE_LIMIT
from gapath.kernels.units import ALLOW, OBSTACLE_BITS

MOST_FIELDS = 255
"""So many entries may be added in 32 bits before obstacles and cost are told apart."""

MOST_PARTS = (1 << 31) // (2 * COORDINATE_LIMIT + 1)
"""Denominators up to this one leave twice a coordinate, multiplied by them, within 32 bits."""

ONE, TWO = np.int32(1), np.int32(2)


def way_rows(numerators: NDArray[np.int64], denominators: NDArray[np.int64]) -> NDArray[np.int32]:
    """Put basis functions into rows, without those that are 0.

    Parameters
    ----------
    numerators, denominators
        `gapath.kernels.kg18.bspline.fractions` of w way points and k control points.

    Returns
    -------
    (w, 5) int32
        The first of three control points that count, their numerators, and the denominator.
    """
    assert denominators.max() <= MOST_PARTS, "more control points and way points than a planner's"
    first = np.minimum((numerators != 0).argmax(axis=1), numerators.shape[1] - 3)
    three = np.take_along_axis(numerators, first[:, None] + np.arange(3), axis=1)
    return np.column_stack([first, three, denominators]).astype(np.int32)


@kernel
def way_point(chromosome: NDArray[np.int32], ways: NDArray[np.int32], j: int, axis: int) -> int:
    """Compute one coordinate of a way point, rounded half up to a field's centre.

    Parameters
    ----------
    chromosome : (2 k,) int32
        Control points x1, y1, ..., xk, yk.
    ways : (w, 5) int32
        `way_rows`.
    j : int
        Number of the way point.
    axis : int
        0 for x, 1 for y.

    Returns
    -------
    int
        `gapath.kernels.kg18.bspline.way_point`.
    """
    g = 2 * ways[j, 0] + axis
    total = np.int32(ways[j, 1] * chromosome[g])
    total = np.int32(total + np.int32(ways[j, 2] * chromosome[g + 2]))
    total = np.int32(total + np.int32(ways[j, 3] * chromosome[g + 4]))
    parts = ways[j, 4]
    return np.int32(np.int32(np.int32(TWO * total) + parts) // np.int32(TWO * parts))


@kernel
def short_line(flat: NDArray[np.int32], cols: int, x0: int, y0: int, x1: int, y1: int) -> int:
    """Sum a line's fields that lie on the map, the first one left out, whatever its corners.

    Field i is a + i d / n + 1/2, rounded down, on the axis across: a remainder that grows by 2 |d|
    a step, and carries at 2 n, gives it without division (Bresenham). It begins at n, or at n - 1
    where d < 0, so that ties go right and down; here 2 n is taken off beforehand.

    Parameters
    ----------
    flat : (rows * cols,) int32
        `GridMap.table`.
    cols : int32
        Fields from left to right.
    x0, y0, x1, y1 : int32
        Its ends, on the map.

    Returns
    -------
    int
        `gapath.kernels.lines.line_key` by the rule ALLOW.
    """
    dx, dy = np.int32(x1 - x0), np.int32(y1 - y0)
    wide, high = np.int32(abs(dx)), np.int32(abs(dy))
    step_x, step_y = ONE if dx >= 0 else np.int32(-1), cols if dy >= 0 else np.int32(-cols)
    left, rise, along, across, back = wide, np.int32(TWO * high), step_x, step_y, dy < 0
    if high > wide:
        left, rise, along, across, back = high, np.int32(TWO * wide), step_y, step_x, dx < 0
    run = np.int32(TWO * left)
    rest = np.int32(-left)
    if back:
        rest = np.int32(rest - ONE)
    at = np.int32(np.int32(y0 * cols) + x0)
    obstacles, cost = np.int64(0), np.int64(0)
    while left > 0:
        some = min(left, np.int32(MOST_FIELDS))
        entries = np.uint32(0)
        for _ in range(some):
            at = np.int32(at + along)
            rest = np.int32(rest + rise)
            if rest >= 0:
                at = np.int32(at + across)
                rest = np.int32(rest - run)
            entries = np.uint32(entries + np.uint32(flat[np.uint32(at)]))
        obstacles += np.int64(entries >> np.uint32(OBSTACLE_BITS))
        cost += np.int64(entries & np.uint32(WEIGHT_MASK))
        left = np.int32(left - some)
    return (obstacles << KEY_BITS) + cost


@kernel
def fitness(
    table: NDArray[np.int32],
    flat: NDArray[np.int32],
    chromosome: NDArray[np.int32],
    ways: NDArray[np.int32],
    rule: int,
) -> int:
    """Evaluate a chromosome (KG18 eq. (5)).

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    flat : (rows * cols,) int32
        The same, from wherever it is read sooner.
    chromosome : (2 k,) int32
        Control points x1, y1, ..., xk, yk.
    ways : (w, 5) int32
        `way_rows`.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    int
        `gapath.kernels.kg18.fitness.fitness`.
    """
    rows, cols = np.int32(table.shape[0]), np.int32(table.shape[1])
    x0, y0 = way_point(chromosome, ways, 0, 0), way_point(chromosome, ways, 0, 1)
    start = np.int64(entry(table, x0, y0))
    obstacles = start >> OBSTACLE_BITS
    cost = start & WEIGHT_MASK
    here = 0 <= x0 < cols and 0 <= y0 < rows
    for j in range(1, ways.shape[0]):
        x1, y1 = way_point(chromosome, ways, j, 0), way_point(chromosome, ways, j, 1)
        there = 0 <= x1 < cols and 0 <= y1 < rows
        if here and there and rule == ALLOW:
            line = short_line(flat, cols, x0, y0, x1, y1)
        else:
            line = line_key(table, np.int64(x0), np.int64(y0), np.int64(x1), np.int64(y1), rule)
        obstacles += line >> KEY_BITS
        cost += line & (ONE_OBSTACLE - 1)
        x0, y0, here = x1, y1, there
    return (np.int64(min(obstacles, MOST_OBSTACLES)) << KEY_BITS) + cost
