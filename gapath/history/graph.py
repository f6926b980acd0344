"""What a planner made of the map before it searched."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Graph(NamedTuple):
    """What a planner made of the map before it searched: points, and free lines between them."""

    obstacles: NDArray[np.bool_]
    """Obstacles as the planner took them, grown by the robot's radius, (rows, cols) of blocks."""
    block: int
    """Fields of the map, along a side, that are one block."""
    points: NDArray[np.int32]
    """(n, 2) fields (x, y) of the map: the start, the target, the keypoints."""
    edges: NDArray[np.int32]
    """(m, 2) numbers of the points that a free line joins, the smaller one first."""

    def grown(self, rows: int, cols: int) -> NDArray[np.bool_]:
        """Give the obstacles in the size of the map, (rows, cols)."""
        blocks = np.kron(self.obstacles, np.ones((self.block, self.block), dtype=np.bool_))
        return np.asarray(blocks[:rows, :cols])
