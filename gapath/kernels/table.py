"""What kernels read of a map: weights as whole numbers, obstacles apart; which fields join."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.units import OBSTACLE, SCALE


@kernel
def fill_table(weights: NDArray[np.float64], table: NDArray[np.int32]) -> None:
    """Turn weights into table entries.

    Parameters
    ----------
    weights : (n,) float64
        Weights in [0, 1], flattened.
    table : (n,) int32
        Overwritten with the weights in units of 1 / SCALE, rounded half up; OBSTACLE for 1.
    """
    for i in range(weights.shape[0]):
        entry = np.int32(np.floor(weights[i] * SCALE + 0.5))
        table[i] = np.int32(OBSTACLE) if weights[i] == 1.0 else entry


def least_three(numbers: NDArray[np.int32]) -> list[tuple[int, int]]:
    """Find the least three numbers of an array; it is done once a map, and not worth compiling.

    Parameters
    ----------
    numbers : (n,) int32
        Of a map.

    Returns
    -------
    list of (int, int)
        Number and index, the least first, of equal ones the first; fewer where there are fewer.
    """
    rest, least = numbers.copy(), []
    for _ in range(min(3, rest.size)):
        i = int(rest.argmin())
        least.append((int(rest[i]), i))
        rest[i] = np.iinfo(rest.dtype).max
    return least


@kernel
def weights_of(table: NDArray[np.int32], path: NDArray[np.int32]) -> int:
    """Sum up the entries of a path's fields.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    path : (n, 2) int32
        Free fields (x, y).

    Returns
    -------
    int
        KG18 eq. (5) in units of 1 / SCALE.
    """
    total = np.int64(0)
    for i in range(path.shape[0]):
        total += table[path[i, 1], path[i, 0]]
    return total


@kernel
def fill_parts(table: NDArray[np.int32], diagonal: bool, parts: NDArray[np.int32]) -> None:
    """Give each part of a map, between which there is no way, a number.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    diagonal : bool
        Fields whose corners touch are neighbours, too.
    parts : (rows, cols) int32
        Zeros; overwritten with the number of each free field's part, from 1 on.
    """
    rows, cols = table.shape
    waiting = np.empty(table.size, dtype=np.int32)
    part = 0
    for begin in range(table.size):
        y, x = begin // cols, begin % cols
        if parts[y, x] != 0 or table[y, x] >= OBSTACLE:
            continue
        part += 1
        parts[y, x] = part
        waiting[0], count = begin, 1
        while count > 0:
            count -= 1
            y0, x0 = waiting[count] // cols, waiting[count] % cols
            for y in range(max(y0 - 1, 0), min(y0 + 2, rows)):
                for x in range(max(x0 - 1, 0), min(x0 + 2, cols)):
                    beside = diagonal or x == x0 or y == y0
                    if beside and parts[y, x] == 0 and table[y, x] < OBSTACLE:
                        parts[y, x] = part
                        waiting[count] = y * cols + x
                        count += 1
