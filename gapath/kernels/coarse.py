"""Coarse maps: blocks of fields as one, and how a path on them bounds a search on the finer map."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.units import OBSTACLE, OBSTACLE_BITS

FACTOR = 4
"""Fields of a block along a side."""


@kernel
def pool(table: NDArray[np.int32], coarse: NDArray[np.int32]) -> None:
    """Make a coarse map: a block weighs what its free fields weigh in the mean.

    Obstacles in it make it dearer, up to fourfold; a block with four fifths of them is one.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`, or a coarse one.
    coarse : (ceil(rows / FACTOR), ceil(cols / FACTOR)) int32
        Overwritten.
    """
    rows, cols = table.shape
    weights, blocked = np.empty(cols, dtype=np.int32), np.empty(cols, dtype=np.int32)
    for v in range(coarse.shape[0]):
        height = min(FACTOR, rows - v * FACTOR)
        weights[:], blocked[:] = 0, 0
        for y in range(v * FACTOR, v * FACTOR + height):
            for x in range(cols):
                weights[x] += table[y, x] & (OBSTACLE - 1)
                blocked[x] += table[y, x] >> OBSTACLE_BITS
        for u in range(coarse.shape[1]):
            width = min(FACTOR, cols - u * FACTOR)
            weight, obstacles = np.int64(0), np.int64(0)
            for x in range(u * FACTOR, u * FACTOR + width):
                weight += weights[x]
                obstacles += blocked[x]
            n = height * width
            if 5 * obstacles >= 4 * n:
                coarse[v, u] = OBSTACLE
            else:
                mean = weight // (n - obstacles)
                coarse[v, u] = min(mean * (n + 3 * obstacles) // n, OBSTACLE - 1)


@kernel
def fence(path: NDArray[np.int32], rows: int, cols: int, states: NDArray[np.int64]) -> None:
    """Keep a search within the blocks of a coarse path and their neighbours.

    Parameters
    ----------
    path : (n, 2) int32
        Blocks as (x, y).
    rows, cols : int
        Size of the finer map.
    states : (rows * cols,) int64
        Zeros, for `gapath.kernels.graph_search.search`; the fields of all blocks around those are
        marked as settled.
    """
    height, width = -(-rows // FACTOR), -(-cols // FACTOR)
    near = np.zeros((height, width), dtype=np.uint8)
    for reach in (2, 1):
        for u, v in path:
            near[max(v - reach, 0) : v + reach + 1, max(u - reach, 0) : u + reach + 1] = reach
    for v in range(height):
        for u in range(width):
            if near[v, u] == 2:
                for y in range(v * FACTOR, min(v * FACTOR + FACTOR, rows)):
                    for x in range(u * FACTOR, min(u * FACTOR + FACTOR, cols)):
                        states[y * cols + x] = -1
