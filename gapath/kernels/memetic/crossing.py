"""The crossover: where two paths meet, each piece between is inherited from the cheaper parent.

Both ways from one meeting field to the next are ways of the child, too, so that one crossover
takes the best of all that the parents have (the partition crossover of Whitley, Hains & Howe 2009,
for paths): it is never dearer than the cheaper one of them.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.memetic.steps import X_BITS, X_MASK


@kernel
def cross(
    table: NDArray[np.int32],
    first: NDArray[np.uint32],
    first_count: int,
    second: NDArray[np.uint32],
    second_count: int,
    order: NDArray[np.int32],
    child: NDArray[np.uint32],
) -> tuple[int, int, int]:
    """Inherit from two paths with the same ends the cheaper piece between fields of both.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    first, second : (n,) uint32
        Fields (`gapath.kernels.memetic.steps`).
    first_count, second_count : int
        How many.
    order : (rows * cols,) int32
        Anything; overwritten where the first path is.
    child : (m,) uint32
        Overwritten with the path that comes out, m >= first_count + second_count.

    Returns
    -------
    count : int
        How many fields it has.
    cost : int
        What it costs, its first field left out, in units of 1 / SCALE.
    pieces : int
        How many pieces are the second's.
    """
    cols = table.shape[1]
    sums = np.empty(first_count, dtype=np.int64)
    total = np.int64(0)
    for i in range(first_count):
        x, y = np.int64(first[i] & X_MASK), np.int64(first[i] >> X_BITS)
        order[y * cols + x] = i
        total += table[y, x]
        sums[i] = total
    at, met = np.int64(0), 0
    child[0] = first[0]
    count, pieces = 1, 0
    cost, through = np.int64(0), np.int64(0)
    for j in range(1, second_count):
        x, y = np.int64(second[j] & X_MASK), np.int64(second[j] >> X_BITS)
        through += table[y, x]
        # What was never written may hold any number; of a field of the path the path says so.
        i = np.int64(order[y * cols + x])
        if not (at < i < first_count and first[i] == second[j]):
            continue
        old = sums[i] - sums[at]
        if through < old:
            for k in range(met + 1, j + 1):
                child[count] = second[k]
                count += 1
            pieces += 1
        else:
            for k in range(at + 1, i + 1):
                child[count] = first[k]
                count += 1
        cost += min(through, old)
        at, met, through = i, j, np.int64(0)
    return count, cost, pieces
