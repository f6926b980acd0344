"""KG18's fitness, eq. (5), as an exact integer: obstacle fields first, then the cost.

The paper adds VLN for each obstacle field. Here both are kept apart in one key
(`gapath.kernels.lines`). Keys order like the paper's sums as long as those stay below VLN.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.kg18.bspline import Basis, way_point
from gapath.kernels.lines import (
    KEY_BITS,
    MOST_OBSTACLES,
    ONE_OBSTACLE,
    WEIGHT_MASK,
    entry,
    line_key,
)
from gapath.kernels.units import OBSTACLE_BITS


@kernel
def fitness(
    table: NDArray[np.int32], chromosome: NDArray[np.int32], basis: Basis, rule: int
) -> int:
    """Evaluate a chromosome (KG18 eq. (5)).

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    chromosome : (2 k,) int32
        Control points x1, y1, ..., xk, yk.
    basis : Basis
        Basis functions at the way points.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    int
        The key of the path, start and target included; smaller is fitter.
    """
    x0 = way_point(chromosome, basis, 0, 0)
    y0 = way_point(chromosome, basis, 0, 1)
    start = entry(table, x0, y0)
    obstacles = start >> OBSTACLE_BITS
    cost = start & WEIGHT_MASK
    for j in range(1, basis.rounding.shape[0]):
        x1 = way_point(chromosome, basis, j, 0)
        y1 = way_point(chromosome, basis, j, 1)
        line = line_key(table, x0, y0, x1, y1, rule)
        obstacles += line >> KEY_BITS
        cost += line & (ONE_OBSTACLE - 1)
        x0, y0 = x1, y1
    return (min(obstacles, MOST_OBSTACLES) << KEY_BITS) + cost
