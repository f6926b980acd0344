"""KG18's fitness of many chromosomes at once: `gapath.kernels.fitness.fitness`, but faster.

All way points first, chromosome beside chromosome, so that the compiler makes vectors of the
loops; then the slopes of all lines; then, chromosome by chromosome, the places of the fields
(`gapath.kernels.lanes`) and the sum of what stands there.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath._jit import kernel
from gapath.kernels.bspline import Basis
from gapath.kernels.fitness import (
    ALLOW,
    KEY_BITS,
    MOST_OBSTACLES,
    OBSTACLE_BITS,
    WEIGHT_MASK,
    corners_cut,
    steps_inside,
)
from gapath.kernels.lanes import FRACTION, LANES, read, store_fields
from gapath.kernels.raster import HALF, SHIFT

MOST_FIELDS = 255
"""So many entries may be added before obstacles and cost are told apart: with one more the
cost might carry into the obstacles."""

EXCESS = 1.0 / 1024
"""Lifts a slope above what two roundings take off; less than one unit is left of it."""


class Workspace(NamedTuple):
    """Memory of `evaluate`, for up to L chromosomes of k control points and w way points."""

    genes: NDArray[np.float64]
    """(k, 2 L) x of all chromosomes, then y."""
    points: NDArray[np.float64]
    """(w, 2 L) way points, likewise."""
    steps: NDArray[np.int64]
    """(w - 1, L) steps of each line."""
    slopes: NDArray[np.int64]
    """(w - 1, 2 L) slopes with `SHIFT` fractional bits, x of all, then y."""
    indices: NDArray[np.int32]
    """Places of fields in the flattened table."""


@kernel
def workspace(basis: Basis, chromosomes: int) -> Workspace:
    """Allocate memory.

    Parameters
    ----------
    basis : Basis
        Basis functions at w way points.
    chromosomes : int
        The most to be evaluated at a time.

    Returns
    -------
    Workspace
        Genes are zeros: a lane that holds no chromosome is computed, too.
    """
    w, k = basis.weights.shape
    most = _whole_vectors(chromosomes)
    return Workspace(
        np.zeros((k, 2 * most)),
        np.empty((w, 2 * most)),
        np.empty((w - 1, most), dtype=np.int64),
        np.empty((w - 1, 2 * most), dtype=np.int64),
        np.empty(MOST_FIELDS + LANES, dtype=np.int32),
    )


@kernel
def _whole_vectors(chromosomes: int) -> int:
    """Round up to eights: loops over so many need no rest that is no vector."""
    return (chromosomes + 7) // 8 * 8


@kernel
def _place_way_points(chromosomes: NDArray[np.int32], basis: Basis, memory: Workspace) -> None:
    """Compute all way points, as `gapath.kernels.bspline.way_point` does one."""
    half = _whole_vectors(chromosomes.shape[0])
    genes, points = memory.genes[:, : 2 * half], memory.points[:, : 2 * half]
    for i in range(chromosomes.shape[0]):
        for g in range(genes.shape[0]):
            genes[g, i] = chromosomes[i, 2 * g]
            genes[g, half + i] = chromosomes[i, 2 * g + 1]
    for j in range(points.shape[0]):
        sums = points[j]
        sums[:] = basis.rounding[j]
        for g in range(genes.shape[0]):
            weight = basis.weights[j, g]
            if weight != 0.0:  # at most three are not
                coordinates = genes[g]
                for lane in range(sums.shape[0]):
                    sums[lane] += weight * coordinates[lane]
        for lane in range(sums.shape[0]):
            sums[lane] = np.floor(sums[lane])


@kernel
def _find_slopes(chromosomes: int, memory: Workspace) -> None:
    """Compute steps and slopes of all lines between way points.

    A slope lies up to one unit and a little above d / n, never below: as good as
    `gapath.kernels.raster.slope` while 4 n**2 < 2**SHIFT.
    """
    half = _whole_vectors(chromosomes)
    for j in range(memory.steps.shape[0]):
        x0, x1 = memory.points[j, :half], memory.points[j + 1, :half]
        y0, y1 = memory.points[j, half : 2 * half], memory.points[j + 1, half : 2 * half]
        steps = memory.steps[j, :half]
        slope_x, slope_y = memory.slopes[j, :half], memory.slopes[j, half : 2 * half]
        for lane in range(half):
            dx, dy = x1[lane] - x0[lane], y1[lane] - y0[lane]
            n = max(abs(dx), abs(dy))
            scale = float(1 << SHIFT) / max(n, 1.0)
            steps[lane] = np.int64(n)
            slope_x[lane] = np.int64(np.ceil(dx * scale + EXCESS))
            slope_y[lane] = np.int64(np.ceil(dy * scale + EXCESS))


@kernel
def evaluate(
    table: NDArray[np.int32],
    chromosomes: NDArray[np.int32],
    basis: Basis,
    rule: int,
    keys: NDArray[np.int64],
    memory: Workspace,
) -> None:
    """Evaluate chromosomes (KG18 eq. (5)).

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    chromosomes : (n, 2 k) int32
        Control points x1, y1, ..., xk, yk.
    basis : Basis
        Basis functions at the way points.
    rule : int
        Corner-cutting rule.
    keys : (n,) int64
        Overwritten with the keys of `gapath.kernels.fitness.fitness`.
    memory : Workspace
        For at least n chromosomes.
    """
    _place_way_points(chromosomes, basis, memory)
    _find_slopes(chromosomes.shape[0], memory)
    rows, cols = table.shape
    flat = table.reshape(rows * cols)
    points, steps, slopes, indices = memory.points, memory.steps, memory.slopes, memory.indices
    half = _whole_vectors(chromosomes.shape[0])
    low = (1 << SHIFT) - 1
    for i in range(chromosomes.shape[0]):
        obstacles, cost, at = np.int64(0), np.int64(0), 0
        x0, y0 = np.int64(points[0, i]), np.int64(points[0, half + i])
        inside0 = 0 <= x0 < cols and 0 <= y0 < rows
        if inside0:
            indices[0] = y0 * cols + x0
            at = 1
        else:
            obstacles = np.int64(1)
        for j in range(steps.shape[0]):
            x1, y1 = np.int64(points[j + 1, i]), np.int64(points[j + 1, half + i])
            inside1 = 0 <= x1 < cols and 0 <= y1 < rows
            n, slope_x, slope_y = steps[j, i], slopes[j, i], slopes[j, half + i]
            x, y = (x0 << SHIFT) + HALF, (y0 << SHIFT) + HALF
            if rule != ALLOW:
                obstacles += corners_cut(table, x, y, slope_x, slope_y, n, rule)
            first, last = 1, n
            if not (inside0 and inside1):  # the steps on the map are one run: it is convex
                first, last = steps_inside(x, slope_x, cols, n)
                first_y, last_y = steps_inside(y, slope_y, rows, n)
                first, last = max(first, first_y), min(last, last_y)
                obstacles += n - max(last - first + 1, 0)
            x += first * slope_x
            y += first * slope_y
            for step in range(first, last + 1, LANES):
                store_fields(
                    indices,
                    at,
                    (y >> SHIFT) * cols + (x >> SHIFT),
                    ((x & low) >> (SHIFT - FRACTION)) + 1,
                    ((y & low) >> (SHIFT - FRACTION)) + 1,
                    (slope_x >> (SHIFT - FRACTION)) + 1,
                    (slope_y >> (SHIFT - FRACTION)) + 1,
                    cols,
                )
                x += LANES * slope_x
                y += LANES * slope_y
                at += min(LANES, last + 1 - step)
                if at > MOST_FIELDS - LANES:
                    entries = _total(flat, indices, at)
                    obstacles += entries >> OBSTACLE_BITS
                    cost += entries & WEIGHT_MASK
                    at = 0
            x0, y0, inside0 = x1, y1, inside1
        entries = _total(flat, indices, at)
        obstacles += entries >> OBSTACLE_BITS
        cost += entries & WEIGHT_MASK
        counted = MOST_OBSTACLES if obstacles > MOST_OBSTACLES else obstacles
        keys[i] = (counted << KEY_BITS) + cost


@kernel
def _total(flat: NDArray[np.int32], indices: NDArray[np.int32], count: int) -> int:
    """Add up the entries at the first indices."""
    total = np.int64(0)
    for k in range(count):
        total += read(flat, np.int64(indices[k]))
    return total
