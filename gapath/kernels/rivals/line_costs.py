"""What a straight line costs a planner of any angle: its length times the mean weight on its way.

On maps of one weight that is the length alone. By the sum of weights, KG18 eq. (5), a diagonal step
costs no more than a straight one, so nothing would be gained by a line.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import ONE_OBSTACLE, line_key

IN_THE_WAY = -1
"""Instead of a cost."""

FINE = 1024
"""A cost of a table's unit is so many of a line's."""


@kernel(inner=True)
def euclidean(dx: int, dy: int) -> float:
    """Give the distance, in fields; exact but for one rounding of the root."""
    return np.sqrt(np.float64(dx * dx + dy * dy))


@kernel
def line_cost(table: NDArray[np.int32], x0: int, y0: int, x1: int, y1: int, rule: int) -> int:
    """Give the cost of a straight line between two fields.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    x0, y0, x1, y1 : int
        Two fields of the map.
    rule : int
        Corner-cutting rule, which every step of the line keeps.

    Returns
    -------
    int
        Length times the mean weight of the fields entered, each a unit (1 / SCALE) heavier than it
        is so that the shortest way goes first where fields cost nothing, in units of 1 / SCALE /
        FINE, rounded down; IN_THE_WAY if an obstacle or a corner is.
    """
    n = max(abs(x1 - x0), abs(y1 - y0))
    if n == 0:
        return np.int64(0)
    key = line_key(table, x0, y0, x1, y1, rule)
    if key >= ONE_OBSTACLE:
        return np.int64(IN_THE_WAY)
    return np.int64(np.float64((key + n) * FINE) * euclidean(x1 - x0, y1 - y0) / np.float64(n))
