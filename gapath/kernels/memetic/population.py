"""The population: polygons of different homotopy, and a diary of all that it took in.

Numbers are copied one by one: numba takes seconds to compile the copying of slices.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.memetic.account import BEST, CHANGES, INDIVIDUAL, NUMBERS, POINTS
from gapath.kernels.memetic.polygon import fields_of, length_of
from gapath.kernels.memetic.rays import field_at, ray
from gapath.kernels.memetic.steps import X_BITS, X_MASK

RUNGS = 8
"""Places at which two polygons are compared."""


class Individuals(NamedTuple):
    """P polygons, one a row."""

    points: NDArray[np.int32]
    """(P, n, 2) vertices as (x, y), start and target included."""
    costs: NDArray[np.int64]
    """(P, n) what each vertex's ray to the next one costs, in units of 1 / SCALE."""
    sizes: NDArray[np.int64]
    """(P,) how many vertices count."""
    totals: NDArray[np.int64]
    """(P,) the sum of the costs: the weights of all fields but the start."""


class Diary(NamedTuple):
    """Every polygon that the population took in, in order."""

    changes: NDArray[np.int64]
    """(n, 6) EPOCH, INDIVIDUAL, OPERATOR, GAIN, TOTAL and END of each."""
    vertices: NDArray[np.int32]
    """(m, 2) their vertices, one polygon after the other."""
    counts: NDArray[np.int64]
    """(2,) how many changes and vertices count."""


EPOCH, ROW, OPERATOR, GAIN, TOTAL, END = range(6)
"""Columns of a diary: by how much the individual became cheaper, what it costs then, and the end
of its vertices."""


@kernel
def individuals(population: int, vertices: int) -> Individuals:
    """Make room for a population of so many polygons with so many vertices; none is there yet."""
    return Individuals(
        np.empty((population, vertices, 2), dtype=np.int32),
        np.empty((population, vertices), dtype=np.int64),
        np.zeros(population, dtype=np.int64),
        np.zeros(population, dtype=np.int64),
    )


@kernel
def with_room(members: Individuals, vertices: int) -> Individuals:
    """Give a population with room for polygons of so many vertices."""
    if vertices <= members.points.shape[1]:
        return members
    wider = individuals(members.points.shape[0], 2 * vertices)
    for k in range(members.points.shape[0]):
        wider.sizes[k], wider.totals[k] = members.sizes[k], members.totals[k]
        for i in range(members.sizes[k]):
            wider.points[k, i, 0] = members.points[k, i, 0]
            wider.points[k, i, 1] = members.points[k, i, 1]
            wider.costs[k, i] = members.costs[k, i]
    return wider


@kernel
def put(
    members: Individuals,
    row: int,
    points: NDArray[np.int32],
    costs: NDArray[np.int64],
    size: int,
    total: int,
) -> Individuals:
    """Put a polygon in a row; gives the population, which may have moved."""
    members = with_room(members, size)
    for i in range(size):
        members.points[row, i, 0], members.points[row, i, 1] = points[i, 0], points[i, 1]
    for i in range(size - 1):
        members.costs[row, i] = costs[i]
    members.sizes[row], members.totals[row] = size, total
    return members


@kernel(inner=True)
def opened(vertices: int) -> Diary:
    """Open a diary with room for a few changes of polygons of so many vertices."""
    return Diary(
        np.empty((2, 6), dtype=np.int64),
        np.empty((vertices, 2), dtype=np.int32),
        np.zeros(2, dtype=np.int64),
    )


@kernel
def noted(
    diary: Diary, members: Individuals, epoch: int, row: int, operator: int, gain: int
) -> Diary:
    """Write down a row of the population; gives the diary, which may have moved."""
    changes, vertices, counts = diary
    n, m, size = counts[0], counts[1], members.sizes[row]
    if n == changes.shape[0]:
        more = np.empty((2 * n, 6), dtype=np.int64)
        for i in range(n):
            for k in range(6):
                more[i, k] = changes[i, k]
        changes = more
    if m + size > vertices.shape[0]:
        further = np.empty((2 * (m + size), 2), dtype=np.int32)
        for i in range(m):
            further[i, 0], further[i, 1] = vertices[i, 0], vertices[i, 1]
        vertices = further
    for i in range(size):
        vertices[m + i, 0] = members.points[row, i, 0]
        vertices[m + i, 1] = members.points[row, i, 1]
    counts[0], counts[1] = n + 1, m + size
    changes[n, EPOCH], changes[n, ROW], changes[n, OPERATOR] = epoch, row, operator
    changes[n, GAIN], changes[n, TOTAL], changes[n, END] = gain, members.totals[row], m + size
    return Diary(changes, vertices, counts)


@kernel
def same_side(
    table: NDArray[np.int32],
    first: NDArray[np.int32],
    first_size: int,
    second: NDArray[np.int32],
    second_size: int,
    rule: int,
) -> bool:
    """Tell whether two polygons pass obstacles on the same sides, as far as some rays can see.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    first, second : (n, 2) int32
        Vertices of polygons with the same ends.
    first_size, second_size : int
        How many.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    bool
        True if the ray is free from one polygon to the other at `RUNGS` places, each after the same
        share of both. (Two of the same homotopy may be told apart where a bend hides one from the
        other; an obstacle that lies between two rays is overlooked.)
    """
    length, other_length = length_of(first, first_size), length_of(second, second_size)
    i, j = 0, 0
    passed, other_passed = np.int64(0), np.int64(0)
    for rung in range(1, RUNGS):
        i, passed, x, y = after(first, i, passed, length * rung // RUNGS)
        j, other_passed, u, v = after(second, j, other_passed, other_length * rung // RUNGS)
        blocked, _ = ray(table, x, y, u, v, rule)
        if blocked:
            return False
    return True


@kernel(inner=True)
def after(points: NDArray[np.int32], i: int, passed: int, fields: int) -> tuple[int, int, int, int]:
    """Go on along a polygon, from vertex i before which some fields were passed, to a field.

    Gives the last vertex before it, the fields passed up to that one, and the field.
    """
    while True:
        x, y = np.int64(points[i, 0]), np.int64(points[i, 1])
        u, v = np.int64(points[i + 1, 0]), np.int64(points[i + 1, 1])
        steps = max(abs(u - x), abs(v - y))
        if passed + steps >= fields:
            x, y = field_at(x, y, u, v, fields - passed)
            return i, passed, x, y
        passed += steps
        i += 1


@kernel(inner=True)
def finished(
    table: NDArray[np.int32],
    rule: int,
    members: Individuals,
    diary: Diary,
    numbers: NDArray[np.int64],
    path: NDArray[np.uint32],
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Give what `gapath.kernels.memetic.evolution.evolve` does, of the best individual.

    ``path`` is room for its fields.
    """
    best = numbers[INDIVIDUAL]
    numbers[BEST] = members.totals[best]
    numbers[CHANGES], numbers[POINTS] = diary.counts[0], diary.counts[1]
    count, path = fields_of(table, members.points[best], members.sizes[best], False, rule, path)
    fields = np.empty((count, 2), dtype=np.int32)
    for k in range(count):
        fields[k, 0], fields[k, 1] = path[k] & X_MASK, path[k] >> X_BITS
    n, m = diary.counts[0], diary.counts[1]
    told = np.empty(NUMBERS + 6 * n + m, dtype=np.int64)
    for k in range(NUMBERS):
        told[k] = numbers[k]
    for k in range(6 * n):
        told[NUMBERS + k] = diary.changes[k // 6, k % 6]
    for k in range(m):
        point = (np.int64(diary.vertices[k, 1]) << X_BITS) + diary.vertices[k, 0]
        told[NUMBERS + 6 * n + k] = point
    return told, fields
