"""A chromosome: the vertices of a polygon, joined by free rays, and what each ray costs."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.memetic.rays import append_ray
from gapath.kernels.memetic.steps import X_BITS

CROWD, FEW = 6, 64
"""A path is crowded that has a vertex for fewer fields than CROWD, and FEW fields at least."""


@kernel
def splice(
    points: NDArray[np.int32],
    costs: NDArray[np.int64],
    size: int,
    i: int,
    j: int,
    new: NDArray[np.int32],
    new_costs: NDArray[np.int64],
    count: int,
) -> int:
    """Replace what lies between two vertices.

    Parameters
    ----------
    points : (n, 2) int32
        Vertices, n >= size + count; changed in place.
    costs : (n,) int64
        What their rays cost; changed in place.
    size : int
        How many vertices there are.
    i, j : int
        Two of them, i < j.
    new : (m, 2) int32
        The first ``count`` come between them.
    new_costs : (p,) int64
        What the ``count`` + 1 rays between i and j cost.
    count : int
        How many vertices are new.

    Returns
    -------
    int
        How many vertices there are now.
    """
    shift = i + 1 + count - j
    if shift > 0:
        for k in range(size - 1, j - 1, -1):
            points[k + shift, 0], points[k + shift, 1] = points[k, 0], points[k, 1]
            costs[k + shift] = costs[k]
    elif shift < 0:
        for k in range(j, size):
            points[k + shift, 0], points[k + shift, 1] = points[k, 0], points[k, 1]
            costs[k + shift] = costs[k]
    for k in range(count):
        points[i + 1 + k, 0], points[i + 1 + k, 1] = new[k, 0], new[k, 1]
    for k in range(count + 1):
        costs[i + k] = new_costs[k]
    return size + shift


@kernel
def fields_of(
    table: NDArray[np.int32],
    points: NDArray[np.int32],
    size: int,
    backward: bool,
    rule: int,
    path: NDArray[np.uint32],
) -> tuple[int, NDArray[np.uint32]]:
    """Give the fields of a polygon.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    points : (n, 2) int32
        Vertices.
    size : int
        How many.
    backward : bool
        From the last one to the first.
    rule : int
        Corner-cutting rule.
    path : (m,) uint32
        Room for the fields; another one is made if it is too small.

    Returns
    -------
    count : int
        How many fields.
    path : (p,) uint32
        The fields (`gapath.kernels.memetic.steps`).
    """
    needed = 1
    for i in range(1, size):
        dx, dy = points[i, 0] - points[i - 1, 0], points[i, 1] - points[i - 1, 1]
        needed += 2 * max(abs(dx), abs(dy))
    if needed > path.shape[0]:
        path = np.empty(2 * needed, dtype=np.uint32)
    step = -1 if backward else 1
    at = size - 1 if backward else 0
    path[0] = (np.int64(points[at, 1]) << X_BITS) + points[at, 0]
    count = 1
    for _ in range(size - 1):
        x0, y0 = np.int64(points[at, 0]), np.int64(points[at, 1])
        at += step
        x1, y1 = np.int64(points[at, 0]), np.int64(points[at, 1])
        steps = max(abs(x1 - x0), abs(y1 - y0))
        count = append_ray(table, x0, y0, x1, y1, steps, rule, path, count)
    return count, path


@kernel
def length_of(points: NDArray[np.int32], size: int) -> int:
    """Give how many fields the rays between so many vertices enter."""
    length = np.int64(0)
    for k in range(1, size):
        dx, dy = points[k, 0] - points[k - 1, 0], points[k, 1] - points[k - 1, 1]
        length += max(abs(dx), abs(dy))
    return length


@kernel
def is_crowded(points: NDArray[np.int32], size: int) -> bool:
    """Tell whether obstacles bend a polygon of so many vertices every few fields."""
    length = length_of(points, size)
    return length >= FEW and CROWD * size > length
