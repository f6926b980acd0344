"""Mutations of a polygon: other vertices in a place, or another way along the walls.

Vertices are changed by a proposal: two vertices, and what shall lie between them. It is taken if
all rays are free and the polygon is cheaper then, or as cheap with fewer vertices, so that no
mutation ever makes one dearer.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.graph_search import bits_of
from gapath.kernels.jit import kernel
from gapath.kernels.memetic.polygon import splice
from gapath.kernels.memetic.rays import field_at, ray
from gapath.kernels.rng import high, low
from gapath.kernels.units import OBSTACLE

REFUSED = -1
"""Instead of what a proposal saves."""

SHORTCUT, MOVE, CUT, INSERT = range(4)
"""Proposals: no vertex between two; one moved; a ray from a point on a ray to one on a later ray;
one more vertex."""


@kernel
def distance_below(bits: int, word: np.uint64) -> int:
    """Draw a distance whose order of magnitude is uniform: short ones as often as long ones.

    Parameters
    ----------
    bits : int
        Distances are below 2**bits.
    word : uint64
        A random word.

    Returns
    -------
    int
        At least 0.
    """
    order = high(word, bits + 1)
    return (np.int64(1) << order >> 1) + low(word, (np.int64(1) << order) + 1 >> 1)


@kernel
def propose(
    kind: int,
    points: NDArray[np.int32],
    size: int,
    rows: int,
    cols: int,
    words: NDArray[np.uint64],
    new: NDArray[np.int32],
) -> tuple[int, int, int]:
    """Draw a proposal.

    Parameters
    ----------
    kind : int
        SHORTCUT, MOVE or CUT for at least three vertices, INSERT for at least two.
    points : (n, 2) int32
        Vertices.
    size : int
        How many.
    rows, cols : int
        Size of the map.
    words : (4,) uint64
        Random words.
    new : (2, 2) int32
        Overwritten with the new vertices.

    Returns
    -------
    i, j, count : int
        ``count`` new ones shall come between vertices i and j, i < j.
    """
    if kind == INSERT:
        i = high(words[0], size - 1)
        j = i + 1
        x, y = on_ray(points, i, words[1])
    else:
        i = high(words[0], size - 2)
        j = min(i + 2 + distance_below(bits_of(size) - 1, words[1]), size - 1)
        if kind == SHORTCUT:
            return i, j, 0
        if kind == CUT:
            new[0, 0], new[0, 1] = on_ray(points, i, words[2])
            new[1, 0], new[1, 1] = on_ray(points, j - 1, words[3])
            return i, j, 2
        j = i + 2
        x, y = np.int64(points[i + 1, 0]), np.int64(points[i + 1, 1])
    bits = bits_of(max(rows, cols)) - 1
    along = low(words[0], 3)  # both axes, or one alone
    step_x, step_y = distance_below(bits, words[2]), distance_below(bits, words[3])
    if along != 1:
        x += step_x if words[1] & np.uint64(1) else -step_x
    if along != 2:
        y += step_y if words[1] & np.uint64(2) else -step_y
    new[0, 0], new[0, 1] = min(max(x, 0), cols - 1), min(max(y, 0), rows - 1)
    return i, j, 1


@kernel(inner=True)
def on_ray(points: NDArray[np.int32], i: int, word: np.uint64) -> tuple[int, int]:
    """Draw a field of the ray from a vertex to the next."""
    x, y = np.int64(points[i, 0]), np.int64(points[i, 1])
    u, v = np.int64(points[i + 1, 0]), np.int64(points[i + 1, 1])
    return field_at(x, y, u, v, low(word, max(abs(u - x), abs(v - y)) + 1))


@kernel
def replace(
    table: NDArray[np.int32],
    points: NDArray[np.int32],
    costs: NDArray[np.int64],
    size: int,
    i: int,
    j: int,
    new: NDArray[np.int32],
    count: int,
    rule: int,
) -> tuple[int, int]:
    """Put new vertices between two, if that is better.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    points : (n, 2) int32
        Vertices, n >= size + count; changed in place.
    costs : (n,) int64
        What their rays cost; changed in place.
    size : int
        How many vertices there are.
    i, j : int
        Two of them, i < j.
    new : (2, 2) int32
        The first ``count``, fields on the map, come between them.
    count : int
        How many vertices are new, at most 2.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    gain : int
        What it saves, in units of 1 / SCALE, or REFUSED.
    size : int
        How many vertices there are now.
    """
    old = np.int64(0)
    for k in range(i, j):
        old += costs[k]
    for k in range(count):
        if table[new[k, 1], new[k, 0]] >= OBSTACLE:
            return np.int64(REFUSED), size
    new_costs = np.empty(3, dtype=np.int64)
    x, y = np.int64(points[i, 0]), np.int64(points[i, 1])
    cost = np.int64(0)
    for k in range(count + 1):
        u = np.int64(new[k, 0]) if k < count else np.int64(points[j, 0])
        v = np.int64(new[k, 1]) if k < count else np.int64(points[j, 1])
        blocked, new_costs[k] = ray(table, x, y, u, v, rule)
        cost += new_costs[k]
        if blocked or cost > old:
            return np.int64(REFUSED), size
        x, y = u, v
    if cost == old and count >= j - i - 1:
        return np.int64(REFUSED), size
    return old - cost, splice(points, costs, size, i, j, new, new_costs, count)
