"""KG18's fitness of many chromosomes: `gapath.kernels.kg18.fitness.fitness`, but faster.

Way points and lines of a few chromosomes side by side (`gapath.kernels.kg18.lanes`), then,
chromosome by chromosome, the places of the fields on its lines and the sum of what stands there
(`gapath.kernels.kg18.field_lanes`).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.kg18.bspline import Basis
from gapath.kernels.kg18.field_lanes import FIELDS, FRACTION, READ, store_fields, sum_entries
from gapath.kernels.kg18.fitness import fitness
from gapath.kernels.kg18.lanes import (
    ACROSS,
    ALONG,
    BASE,
    CHROMOSOMES,
    LINE,
    SLOPE,
    STEPS,
    Way,
    join_way_points,
    place_way_points,
    turn,
)
from gapath.kernels.lines import (
    KEY_BITS,
    MOST_OBSTACLES,
    WEIGHT_MASK,
    corners_cut,
    steps_inside,
)
from gapath.kernels.raster import HALF, SHIFT, slope
from gapath.kernels.units import ALLOW, OBSTACLE_BITS

MOST_FIELDS = 255
"""So many entries may be added before obstacles and cost are told apart: with one more the
cost might carry into the obstacles."""

_PART = (1 << SHIFT) - 1  # of a position: where within its field


class Workspace(NamedTuple):
    """Memory of vectors for k control points and w way points; rows as in `lanes`."""

    genes: NDArray[np.int32]
    """2 k rows and some more: x and y of each control point."""
    points: NDArray[np.int32]
    """2 w rows: x and y of each way point."""
    lines: NDArray[np.int32]
    """`LINE` rows for each of w - 1 lines."""
    slopes: NDArray[np.float64]
    """A row for each line: its slope across, with `SHIFT` fractional bits."""
    indices: NDArray[np.int32]
    """Places of fields in the flattened table."""


@kernel
def workspace(basis: Basis) -> Workspace:
    """Allocate memory.

    Parameters
    ----------
    basis : Basis
        Basis functions at w way points.

    Returns
    -------
    Workspace
        Not filled.
    """
    w, k = basis.weights.shape
    genes = (2 * k + CHROMOSOMES - 1) // CHROMOSOMES * CHROMOSOMES
    return Workspace(
        np.empty(genes * CHROMOSOMES, dtype=np.int32),
        np.empty(2 * w * CHROMOSOMES, dtype=np.int32),
        np.empty((w - 1) * LINE * CHROMOSOMES, dtype=np.int32),
        np.empty((w - 1) * CHROMOSOMES, dtype=np.float64),
        np.empty(MOST_FIELDS + FIELDS + READ, dtype=np.int32),
    )


@kernel(inner=True)
def _place(
    chromosomes: NDArray[np.int32],
    first: int,
    basis: Basis,
    rows: int,
    cols: int,
    memory: Workspace,
) -> None:
    """Compute way points, and the lines that join them, of the next `CHROMOSOMES` chromosomes."""
    weights, rounding = basis.weights, basis.rounding
    w, k = weights.shape
    for g in range(0, 2 * k, CHROMOSOMES):
        turn(chromosomes, first, g, memory.genes)
    g = 0  # of the k basis functions, three that follow one another may differ from 0
    for j in range(w):
        while g < k - 3 and weights[j, g] == 0.0:
            g += 1
        for axis in range(2):
            place_way_points(
                memory.genes,
                2 * g + axis,
                memory.points,
                2 * j + axis,
                rounding[j],
                weights[j, g],
                weights[j, g + 1],
                weights[j, g + 2],
            )
    for j in range(w - 1):
        join_way_points(memory.points, j, memory.lines, memory.slopes, rows, cols)


@kernel(inner=True)
def _line(memory: Workspace, j: int, i: int) -> tuple[int, int, int, int, int]:
    """Give the ends of line j of chromosome i, and its steps."""
    at = 2 * j * CHROMOSOMES + i
    x0, y0 = np.int64(memory.points[at]), np.int64(memory.points[at + CHROMOSOMES])
    x1 = np.int64(memory.points[at + 2 * CHROMOSOMES])
    y1 = np.int64(memory.points[at + 3 * CHROMOSOMES])
    return x0, y0, x1, y1, max(abs(x1 - x0), abs(y1 - y0))


@kernel(inner=True)
def _across(memory: Workspace, j: int, i: int) -> int:
    """Give the slope across of line j of chromosome i, with `SHIFT` fractional bits.

    It lies up to one unit and a little above d / n, never below: as good as
    `gapath.kernels.raster.slope` while 4 n**2 < 2**SHIFT.
    """
    positive = memory.slopes[j * CHROMOSOMES + i] + float(2 << SHIFT)
    return np.int64(positive) - (2 << SHIFT) + 1


@kernel(inner=True)
def _add_line(
    flat: NDArray[np.int32], rows: int, cols: int, memory: Workspace, j: int, i: int, at: int
) -> tuple[int, int, int]:
    """Store the fields of a line that leaves the map, or of more fields than there is room for.

    Returns
    -------
    obstacles, cost : int
        Of fields off the map, and of those added up to make room.
    at : int
        Fields that are stored now.
    """
    x0, y0, x1, _, n = _line(memory, j, i)
    row = LINE * j * CHROMOSOMES + i
    along = np.int64(memory.lines[row + ALONG * CHROMOSOMES])
    across = np.int64(memory.lines[row + ACROSS * CHROMOSOMES])
    slope_across = _across(memory, j, i)
    obstacles, cost = np.int64(0), np.int64(0)
    first, last = 1, n
    if memory.lines[row + STEPS * CHROMOSOMES] < 0:
        # the map is convex, so the steps on it are one run
        slope_x = slope_y = (1 if along > 0 else -1) << SHIFT
        if abs(x1 - x0) == n:
            slope_y = slope_across
        else:
            slope_x = slope_across
        first, last = steps_inside((x0 << SHIFT) + HALF, slope_x, cols, n)
        first_y, last_y = steps_inside((y0 << SHIFT) + HALF, slope_y, rows, n)
        first, last = max(first, first_y), min(last, last_y)
        obstacles += n - max(last - first + 1, 0)
    for step in range(first, last + 1, FIELDS):
        if at > MOST_FIELDS - FIELDS:
            entries = sum_entries(flat, memory.indices, at)
            obstacles += entries >> OBSTACLE_BITS
            cost += entries & WEIGHT_MASK
            at = 0
        position = HALF + (step - 1) * slope_across
        base = y0 * cols + x0 + (step - 1) * along + (position >> SHIFT) * across
        part = ((position & _PART) >> (SHIFT - FRACTION)) + 1
        coarse = np.int64(memory.lines[row + SLOPE * CHROMOSOMES])
        store_fields(memory.indices, at, base, along, across, part, coarse)
        at += min(FIELDS, last + 1 - step)
    return obstacles, cost, at


@kernel(inner=True)
def _corners(table: NDArray[np.int32], memory: Workspace, lines: int, i: int, rule: int) -> int:
    """Count the steps of chromosome i that break the corner-cutting rule, one by one."""
    count = 0
    for j in range(lines):
        x0, y0, x1, y1, n = _line(memory, j, i)
        if n > 0:
            x, y = (x0 << SHIFT) + HALF, (y0 << SHIFT) + HALF
            count += corners_cut(table, x, y, slope(x1 - x0, n), slope(y1 - y0, n), n, rule)
    return count


@kernel
def evaluate(
    way: Way,
    table: NDArray[np.int32],
    chromosomes: NDArray[np.int32],
    begin: int,
    end: int,
    basis: Basis,
    rule: int,
    keys: NDArray[np.int64],
    memory: Workspace,
) -> None:
    """Evaluate chromosomes (KG18 eq. (5)).

    Parameters
    ----------
    way : None or True
        `SIDE_BY_SIDE` or `ONE_BY_ONE`; the keys are the same.
    table : (rows, cols) int32
        `GridMap.table`.
    chromosomes : (n, m) int32
        Control points x1, y1, ..., xk, yk, a chromosome a row. Side by side whole vectors are read
        of them: a `gapath.kernels.kg18.lanes.chromosome_matrix`.
    begin, end : int
        Rows to evaluate: from the first to before the second.
    basis : Basis
        Basis functions at the way points.
    rule : int
        Corner-cutting rule.
    keys : (p,) int64
        Those from `begin` to before `end` are overwritten, as `gapath.kernels.kg18.fitness.fitness`
        gives them.
    memory : Workspace
        Memory for vectors.
    """
    if way is not None:
        genes = 2 * basis.weights.shape[1]
        for i in range(begin, end):
            keys[i] = fitness(table, chromosomes[i, :genes], basis, rule)
        return
    rows, cols = table.shape
    flat = table.reshape(rows * cols)
    values, indices = memory.lines, memory.indices
    lines = basis.rounding.shape[0] - 1
    for first in range(begin, end, CHROMOSOMES):
        count = min(CHROMOSOMES, end - first)
        _place(chromosomes, first, basis, rows, cols, memory)
        for i in range(count):
            obstacles, cost, at = np.int64(0), np.int64(0), 0
            x, y = memory.points[i], memory.points[CHROMOSOMES + i]
            if 0 <= x < cols and 0 <= y < rows:
                indices[0] = values[BASE * CHROMOSOMES + i]
                at = 1
            else:
                obstacles += 1
            for j in range(lines):
                row = LINE * j * CHROMOSOMES + i
                steps = np.int64(values[row + STEPS * CHROMOSOMES])
                if steps < 0 or at + steps > MOST_FIELDS:
                    off, weight, at = _add_line(flat, rows, cols, memory, j, i, at)
                    obstacles += off
                    cost += weight
                    continue
                along = np.int64(values[row + ALONG * CHROMOSOMES])
                across = np.int64(values[row + ACROSS * CHROMOSOMES])
                coarse = np.int64(values[row + SLOPE * CHROMOSOMES])
                base = np.int64(values[row + BASE * CHROMOSOMES])
                store_fields(indices, at, base, along, across, 1 << (FRACTION - 1), coarse)
                if steps > FIELDS:
                    slope_across = _across(memory, j, i)
                    position, to = HALF, at
                    for _ in range(FIELDS, steps, FIELDS):
                        position += FIELDS * slope_across
                        base += FIELDS * along
                        to += FIELDS
                        part = ((position & _PART) >> (SHIFT - FRACTION)) + 1
                        start = base + (position >> SHIFT) * across
                        store_fields(indices, to, start, along, across, part, coarse)
                at += steps
            entries = sum_entries(flat, indices, at)
            obstacles += entries >> OBSTACLE_BITS
            cost += entries & WEIGHT_MASK
            if rule != ALLOW:
                obstacles += _corners(table, memory, lines, i, rule)
            counted = MOST_OBSTACLES if obstacles > MOST_OBSTACLES else obstacles
            keys[first + i] = (counted << KEY_BITS) + cost
