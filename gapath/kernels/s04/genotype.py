"""The genotype of Sedighi et al. 2004 (S04 Sec. III) and what a path of it comes to.

On a grid of n x n fields a chromosome has n genes, and gene i places vertex i: in row i, its
column free (row-wise), or in column i, its row free (column-wise). The mode at the beginning is
the flag; at each switch gene it turns into the other. Two successive vertices are joined by a
horizontal and a vertical piece, whose order is the direction. Start and target are the first
and the last vertex.

Here everything counts from 0, in the paper from 1. The kernels see a map whose target lies
right of and below the start, and whose sides are made equal by obstacles. A population is kept
gene by gene: loops run over chromosomes side by side, and the compiler makes vectors of them.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import KEY_BITS, ONE_OBSTACLE, Ends
from gapath.kernels.units import OBSTACLE

MAX_SIDE = 700
"""Longest side of a map: so that a path's obstacle fields, below n**2 + 2 n, fit into a key."""

HORIZONTAL = 1
"""The direction that goes first along the row; 0 goes first along the column."""

SWITCHES = 2
"""Switch genes of a chromosome (S04 Sec. III.C.4)."""


class Genotype(NamedTuple):
    """What the chromosomes of a planner can be."""

    column_wise: bool
    """The flag may be 1."""
    switches: int
    """So many switch genes may change the mode, at most `SWITCHES`."""


class Chromosomes(NamedTuple):
    """P chromosomes on a grid of n x n fields."""

    flag: NDArray[np.int32]
    """(P,) the first mode: 0 row-wise, 1 column-wise."""
    location: NDArray[np.int32]
    """(n, P) column of vertex i row-wise, its row column-wise; the outer two are not read."""
    direction: NDArray[np.int32]
    """(n - 1, P) how vertex i is joined to the next: `HORIZONTAL` first, or 0."""
    switch: NDArray[np.int32]
    """(2, P) the mode changes after these vertices; n - 1: not at all, two equal ones: once."""


class Sums(NamedTuple):
    """Keys (`gapath.kernels.kg18.fitness`) of runs of fields, as differences of running sums."""

    rows: NDArray[np.int64]
    """(n (n + 1),) at y (n + 1) + x: the fields of row y left of x."""
    cols: NDArray[np.int64]
    """(n (n + 1),) at x (n + 1) + y: the fields of column x above y."""


class Measures(NamedTuple):
    """What the paths of P chromosomes come to."""

    keys: NDArray[np.int64]
    """(P,) fields that are obstacles, and the cost of the others (KG18 eq. (5)); a field
    counts as often as it is entered."""
    lengths: NDArray[np.int32]
    """(P,) steps."""
    turns: NDArray[np.int32]
    """(P,) steps that go another way than the one before."""


class Walk(NamedTuple):
    """Where P paths are while they are measured."""

    here: NDArray[np.int32]
    """(2, P) x and y."""
    there: NDArray[np.int32]
    """(2, P) x and y of the next vertex."""
    mode: NDArray[np.int32]
    """(P,) 0 row-wise, 1 column-wise."""
    heading: NDArray[np.int32]
    """(P,) of the last step: 1 +x, 2 +y, 3 -x, 4 -y; 0 before the first."""
    ends: NDArray[np.int32]
    """(4, P) where the sums of the next joint's row and of its column end and begin."""


@kernel
def empty_chromosomes(size: int, n: int) -> Chromosomes:
    """Give chromosomes whose switches change nothing, without values otherwise."""
    return Chromosomes(
        np.zeros(size, dtype=np.int32),
        np.empty((n, size), dtype=np.int32),
        np.empty((n - 1, size), dtype=np.int32),
        np.full((SWITCHES, size), n - 1, dtype=np.int32),
    )


@kernel
def empty_sums(n: int) -> Sums:
    """Give room for the sums of a grid."""
    return Sums(np.empty(n * (n + 1), dtype=np.int64), np.empty(n * (n + 1), dtype=np.int64))


@kernel
def empty_measures(size: int) -> Measures:
    """Give room for the measures of so many chromosomes."""
    return Measures(
        np.empty(size, dtype=np.int64),
        np.empty(size, dtype=np.int32),
        np.empty(size, dtype=np.int32),
    )


@kernel
def empty_walk(size: int) -> Walk:
    """Give room to measure so many chromosomes."""
    return Walk(
        np.empty((2, size), dtype=np.int32),
        np.empty((2, size), dtype=np.int32),
        np.empty(size, dtype=np.int32),
        np.empty(size, dtype=np.int32),
        np.empty((4, size), dtype=np.int32),
    )


@kernel
def running_sums(table: NDArray[np.int32], flip_x: bool, flip_y: bool, sums: Sums) -> None:
    """Add up keys along rows and columns of a map made square.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    flip_x, flip_y : bool
        Mirror it, so that the target comes to lie right of and below the start.
    sums : Sums
        Overwritten; n is the longer side. Fields outside the map are obstacles.
    """
    rows, cols = table.shape
    n = max(rows, cols)
    along_rows, along_cols = sums.rows.reshape(n, n + 1), sums.cols.reshape(n, n + 1)
    along_rows[:, 0] = 0
    along_cols[:, 0] = 0
    for y in range(n):
        for x in range(n):
            key = np.int64(ONE_OBSTACLE)
            if x < cols and y < rows:
                entry = table[rows - 1 - y if flip_y else y, cols - 1 - x if flip_x else x]
                if entry < OBSTACLE:
                    key = np.int64(entry)
            along_rows[y, x + 1] = along_rows[y, x] + key
            along_cols[x, y + 1] = along_cols[x, y] + key


@kernel
def run(sums: NDArray[np.int64], end: int, begin: int) -> int:
    """Give the key of the fields between two places in running sums."""
    return abs(sums[np.uint32(end)] - sums[np.uint32(begin)])


@kernel
def flatten(chromosomes: Chromosomes, individual: int, row: NDArray[np.int32]) -> None:
    """Write a chromosome as one row: flag, n locations, n - 1 directions, 2 switches."""
    n = chromosomes.location.shape[0]
    row[0] = chromosomes.flag[individual]
    row[1 : n + 1] = chromosomes.location[:, individual]
    row[n + 1 : 2 * n] = chromosomes.direction[:, individual]
    row[2 * n :] = chromosomes.switch[:, individual]


@kernel
def decode(rows: NDArray[np.int32], ends: Ends) -> NDArray[np.int32]:
    """Give the paths of chromosomes as points joined by straight lines (S04 Sec. III.C).

    Parameters
    ----------
    rows : (P, 2 n + 2) int32
        Chromosomes as `flatten` writes them.
    ends : Ends
        Start and target.

    Returns
    -------
    (P, 2 n - 1, 2) int32
        (x, y) of every vertex and, in between, of the corner of each L.
    """
    n = rows.shape[1] // 2 - 1
    points = np.empty((rows.shape[0], 2 * n - 1, 2), dtype=np.int32)
    for individual in range(rows.shape[0]):
        row, path = rows[individual], points[individual]
        x, y = ends.start_x, ends.start_y
        first, second = row[2 * n], row[2 * n + 1]
        path[0, 0], path[0, 1] = x, y
        for i in range(1, n):
            u, v = ends.target_x, ends.target_y
            if i < n - 1:
                # a switch at gene s takes effect after vertex s
                column_wise = row[0] ^ (i > first) ^ (i > second and first != second)
                u, v = (i, row[1 + i]) if column_wise else (row[1 + i], i)
            horizontal = row[n + i] == HORIZONTAL
            path[2 * i - 1, 0], path[2 * i - 1, 1] = (u, y) if horizontal else (x, v)
            path[2 * i, 0], path[2 * i, 1] = u, v
            x, y = u, v
    return points


@kernel
def measure(
    chromosomes: Chromosomes, ends: Ends, sums: Sums, measures: Measures, walk: Walk
) -> None:
    """Measure the paths of all chromosomes.

    Nothing branches on a gene: they are random, and every other guess of a processor would be
    wrong.

    Parameters
    ----------
    chromosomes : Chromosomes
        P of them.
    ends : Ends
        Start and target.
    sums : Sums
        Of the map.
    measures : Measures
        Overwritten.
    walk : Walk
        Overwritten.
    """
    n = chromosomes.location.shape[0]
    begin = ends.start_y * (n + 1) + ends.start_x
    measures.keys[:] = run(sums.rows, begin + 1, begin)
    measures.lengths[:] = 0
    measures.turns[:] = 0
    walk.here[0], walk.here[1] = ends.start_x, ends.start_y
    walk.mode[:] = chromosomes.flag
    walk.heading[:] = 0
    for i in range(1, n):
        if i < n - 1:
            _place(chromosomes, np.int32(i), walk)
        else:
            walk.there[0], walk.there[1] = ends.target_x, ends.target_y
        _join(chromosomes.direction[i - 1], np.int32(n + 1), measures, walk)
        for p in range(measures.keys.shape[0]):
            measures.keys[p] += run(sums.rows, walk.ends[0, p], walk.ends[1, p])
            measures.keys[p] += run(sums.cols, walk.ends[2, p], walk.ends[3, p])


@kernel(inner=True)
def _place(chromosomes: Chromosomes, i: int, walk: Walk) -> None:
    """Place vertex i of every path, which is not the last."""
    first, second = chromosomes.switch[0], chromosomes.switch[1]
    location, mode = chromosomes.location[i], walk.mode
    u, v = walk.there[0], walk.there[1]
    # two loops: of arrays that may overlap, for all the compiler knows, it takes no more at once
    for p in range(location.shape[0]):
        # a switch at gene s takes effect after vertex s
        mode[p] ^= np.int32(first[p] == i - 1) | np.int32(second[p] == i - 1)
    for p in range(location.shape[0]):
        u[p] = i if mode[p] else location[p]
        v[p] = location[p] if mode[p] else i


@kernel(inner=True)
def _join(direction: NDArray[np.int32], stride: int, measures: Measures, walk: Walk) -> None:
    """Join every path's vertex to the next by an L: its length, turns and fields."""
    here_x, here_y, there_x, there_y = walk.here[0], walk.here[1], walk.there[0], walk.there[1]
    for p in range(direction.shape[0]):
        x, y, u, v = here_x[p], here_y[p], there_x[p], there_y[p]
        horizontal = direction[p] == HORIZONTAL
        # a piece leaves out the field where it begins: ahead sums move on by one, back not
        right, down = np.int32(u > x), np.int32(v > y)
        row = (y if horizontal else v) * stride + right
        col = (u if horizontal else x) * stride + down
        walk.ends[0, p], walk.ends[1, p] = row + u, row + x
        walk.ends[2, p], walk.ends[3, p] = col + v, col + y
        measures.lengths[p] += abs(u - x) + abs(v - y)
        along_row = right + np.int32(3) * np.int32(u < x)
        along_col = np.int32(2) * down + np.int32(4) * np.int32(v < y)
        first = along_row if horizontal else along_col
        second = along_col if horizontal else along_row
        heading = walk.heading[p]
        turns = _turned(heading, first)
        heading = first if first else heading
        measures.turns[p] += turns + _turned(heading, second)
        walk.heading[p] = second if second else heading
        here_x[p], here_y[p] = u, v


@kernel(inner=True)
def _turned(before: int, now: int) -> int:
    """Count a turn if both headings are some and differ."""
    return np.int32(before != 0) & np.int32(now != 0) & np.int32(before != now)


@kernel
def share(value: int, least: int, most: int) -> float:
    """Scale a value over the population: 1 for the least, 0 for the most, 1 if all are equal."""
    return (most - value) / (most - least) if most > least else 1.0


@kernel
def fitness(
    measures: Measures, length_weight: float, turns_weight: float, values: NDArray[np.float64]
) -> None:
    """Rate paths against one another (S04 eqs (1) and (2)).

    Length, turns and collisions are scaled over the population that is rated, so the same path
    has another fitness among others. Where all have the same value of one, it is 1.

    Parameters
    ----------
    measures : Measures
        Of the population.
    length_weight, turns_weight : float
        L and T.
    values : (P,) float64
        Overwritten; from 0 to 100, the larger the fitter.
    """
    keys, lengths, turns = measures
    fewest, most = keys.min() >> KEY_BITS, keys.max() >> KEY_BITS
    shortest, longest = lengths.min(), lengths.max()
    straightest, crookedest = turns.min(), turns.max()
    for i in range(values.shape[0]):
        collisions = keys[i] >> KEY_BITS
        weighted = length_weight * share(lengths[i], shortest, longest)
        weighted += turns_weight * share(turns[i], straightest, crookedest)
        value = share(collisions, fewest, most) * weighted
        value = value * 100 / (length_weight + turns_weight)  # eq. (1)
        if collisions:
            value = 0.1 * value / (float(collisions) * float(collisions))  # eq. (2)
        values[i] = value
