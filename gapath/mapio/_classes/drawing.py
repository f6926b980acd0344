"""What the generators of maps share: the frame of a reconstructed one, and dice."""

import numpy as np
from numpy.typing import NDArray

from gapath.grid import Field, Table
from gapath.kernels.lines import ONE_OBSTACLE, line_key
from gapath.kernels.rng import fill, high, stream
from gapath.kernels.units import ALLOW, OBSTACLE

ROWS, COLS = 50, 100  # KG18 Sec. 2
START, TARGET = (0, 24), (98, 24)  # KG18 Sec. 5

MAX_DRAWS = 1000

Obstacles = NDArray[np.bool_]


class Draw:
    """Integers from the stream of one instance."""

    def __init__(self, seed: int, instance: int) -> None:
        self._stream = stream(seed, instance)
        self._word = np.empty(1, dtype=np.uint64)

    def integer(self, lowest: int, highest: int) -> int:
        """Draw an integer, both ends included."""
        fill(self._stream, self._word)
        return lowest + int(high(self._word[0], highest - lowest + 1))

    def words(self, count: int) -> NDArray[np.uint64]:
        """Draw so many words at once, (count,)."""
        words = np.empty(count, dtype=np.uint64)
        fill(self._stream, words)
        return words

    def rectangle(self, widths: Field, heights: Field) -> tuple[int, int]:
        """Draw a width and a height, both ends of either range included."""
        return self.integer(*widths), self.integer(*heights)


def empty_map() -> Obstacles:
    """Give a map without obstacles, (rows, cols)."""
    return np.zeros((ROWS, COLS), dtype=bool)


def as_table(blocked: Obstacles) -> Table:
    """Give what kernels read, all free fields of one weight."""
    return np.where(blocked, OBSTACLE, 1).astype(np.int32)


def straight_line_is_free(table: Table) -> bool:
    """Tell whether the DDA line from start to target meets no obstacle."""
    return bool(line_key(table, *START, *TARGET, ALLOW) < ONE_OBSTACLE)
