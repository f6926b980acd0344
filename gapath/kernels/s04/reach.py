"""Which vertices S04's genotype can reach: dynamic programming over all chromosomes at once.

A path is free if each of its joints is, and a joint depends on two successive vertices only. So
it is enough to know, for each vertex, mode and location, with how few switches a free path leads
there; of (n times 2)^n chromosomes about 8 n^3 joints remain.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import ONE_OBSTACLE, Ends
from gapath.kernels.s04.genotype import HORIZONTAL, Sums, run


@kernel(inner=True)
def is_free(sums: Sums, n: int, x: int, y: int, u: int, v: int, direction: int) -> bool:
    """Tell whether the L from (x, y), left out, to (u, v), included, meets no obstacle."""
    row = (y if direction == HORIZONTAL else v) * (n + 1) + (u > x)
    col = (u if direction == HORIZONTAL else x) * (n + 1) + (v > y)
    key = run(sums.rows, row + u, row + x) + run(sums.cols, col + v, col + y)
    return key < ONE_OBSTACLE


@kernel
def reach(
    sums: Sums, ends: Ends, column_wise: bool, least: NDArray[np.int32], origins: NDArray[np.int32]
) -> None:
    """Find all vertices to which a free path leads, each with as few switches as can be.

    Parameters
    ----------
    sums : Sums
        Of the map.
    ends : Ends
        Start and target.
    column_wise : bool
        Whether paths may begin column-wise.
    least : (n, 2, n) int32
        Overwritten: at [i, mode, location] the fewest switches of a free path to vertex i there;
        n, which no path needs, if none leads there. Outer vertices stand at location 0.
    origins : (n, 2, n) int32
        Overwritten, where a path leads: from where it comes, as 4 * location of the vertex before +
        2 * (the mode changed after it) + direction of the joint.
    """
    n = least.shape[0]
    least[:] = n
    least[0, : 2 if column_wise else 1, 0] = 0
    for i in range(n - 1):
        for mode in range(2):
            for a in range(n if i else 1):
                used = least[i, mode, a]
                if used == n:
                    continue
                x, y = ends.start_x, ends.start_y
                if i:
                    x, y = (i, a) if mode else (a, i)
                for toggled in range(2):
                    now = mode ^ toggled
                    for b in range(n if i + 1 < n - 1 else 1):
                        if least[i + 1, now, b] <= used + toggled:
                            continue
                        u, v = ends.target_x, ends.target_y
                        if i + 1 < n - 1:
                            u, v = (i + 1, b) if now else (b, i + 1)
                        for direction in range(2):
                            if is_free(sums, n, x, y, u, v, direction):
                                least[i + 1, now, b] = used + toggled
                                origins[i + 1, now, b] = 4 * a + 2 * toggled + direction
