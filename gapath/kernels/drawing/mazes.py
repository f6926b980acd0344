"""Perfect mazes: between any two cells there is one way."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.rng import high


@kernel
def carve(words: NDArray[np.uint64], right: NDArray[np.bool_], below: NDArray[np.bool_]) -> None:
    """Open walls between cells, depth first: from the newest cell that has a closed neighbour.

    Parameters
    ----------
    words : (rows * cols - 1,) uint64
        Random words: one chooses among a cell's closed neighbours, from the left one on, then the
        right one, the one above and the one below.
    right, below : (rows, cols) bool
        False everywhere; overwritten with whether a cell is open to its right, and downwards.
    """
    rows, cols = right.shape
    seen = np.zeros(rows * cols, dtype=np.bool_)
    way = np.empty(rows * cols, dtype=np.int32)
    around = np.empty(4, dtype=np.int32)
    way[0], length, drawn = 0, 1, 0
    seen[0] = True
    while drawn < words.shape[0]:
        here = way[length - 1]
        y, x = here // cols, here % cols
        closed = 0
        for beside, inside in (
            (here - 1, x > 0),
            (here + 1, x < cols - 1),
            (here - cols, y > 0),
            (here + cols, y < rows - 1),
        ):
            if inside and not seen[beside]:
                around[closed] = beside
                closed += 1
        if closed == 0:
            length -= 1
            continue
        there = around[high(words[drawn], closed)]
        drawn += 1
        first = min(here, there)
        if abs(there - here) == 1 and cols > 1:
            right[first // cols, first % cols] = True
        else:
            below[first // cols, first % cols] = True
        seen[there] = True
        way[length] = there
        length += 1
