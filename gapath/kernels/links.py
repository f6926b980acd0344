"""How many straight pieces a path needs: the proof that a map is too hard for few way points."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import ONE_OBSTACLE, line_key
from gapath.kernels.units import ALLOW, OBSTACLE


@kernel
def link_distances(
    table: NDArray[np.int32], origin: tuple[int, int], pieces: int
) -> NDArray[np.int64]:
    """Count the DDA lines that a free polyline needs from one field to every other.

    The lines end on any fields of the map, so this bounds what *any* way points can do, from
    a B-spline or not. Corner cutting is allowed, which can only make polylines shorter.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    origin : (x, y)
        A free field.
    pieces : int
        Stop after this many pieces.

    Returns
    -------
    (rows, cols) int64
        Number of pieces; -1 where more are needed or the field is an obstacle.
    """
    rows, cols = table.shape
    distances = np.full((rows, cols), -1, dtype=np.int64)
    distances[origin[1], origin[0]] = 0
    for distance in range(1, pieces + 1):
        for y0 in range(rows):
            for x0 in range(cols):
                if distances[y0, x0] != distance - 1:
                    continue
                for y1 in range(rows):
                    for x1 in range(cols):
                        if distances[y1, x1] >= 0 or table[y1, x1] >= OBSTACLE:
                            continue
                        if line_key(table, x0, y0, x1, y1, ALLOW) < ONE_OBSTACLE:
                            distances[y1, x1] = distance
    return distances
