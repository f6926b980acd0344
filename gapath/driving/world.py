"""The true map of a drive, which may change while the robot drives."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks
from gapath.grid import Field, GridMap, Table
from gapath.kernels.rng import fill, high, stream
from gapath.kernels.units import OBSTACLE

CHANGES = 1 << 62
"""Key of the random stream of a drive's changes; navigators' keys lie below it."""


@dataclass(frozen=True)
class Changes:
    """A seeded schedule of obstacles that appear and vanish.

    Parameters
    ----------
    every : int
        A square appears every so many steps; 0 for a map that does not change.
    lifetime : int
        Steps until it vanishes.
    side : int
        Side of the squares, in fields.
    """

    every: int
    lifetime: int
    side: int

    def __post_init__(self) -> None:
        check = Checks(self, "drive.changes")
        check.whole("every", 0, 10**6)
        check.whole("lifetime", 1, 10**6)
        check.whole("side", 1, 1000)


class World:
    """The true map, step by step.

    Parameters
    ----------
    grid : GridMap
        The map at the first step.
    changes : Changes
        What happens to it.
    ends : tuple of (x, y)
        Fields that stay free: start and target.
    seed, trial : int
        Keys of the schedule's random stream.
    """

    def __init__(
        self, grid: GridMap, changes: Changes, ends: tuple[Field, Field], seed: int, trial: int
    ) -> None:
        self.table: Table = grid.table
        self._grid, self._changes, self._ends = grid, changes, ends
        self._squares: list[tuple[int, NDArray[np.int64]]] = []
        if changes.every:
            self.table = grid.table.copy()
            self._stream = stream(seed, trial, CHANGES)

    def advance(self, step: int, robot: Field) -> None:
        """Make the changes of a step; never on the robot's field or beside it.

        Parameters
        ----------
        step : int
            Number of the step, from 0.
        robot : (x, y)
            The robot's field.
        """
        if not self._changes.every:
            return
        alive = [(until, square) for until, square in self._squares if until > step]
        if len(alive) < len(self._squares) or step % self._changes.every == 0:
            self._squares = alive
            if step % self._changes.every == 0:
                self._squares.append((step + self._changes.lifetime, self._draw(robot)))
            self.table[:] = self._grid.table
            for _, square in self._squares:
                self._block(square, robot)

    def _draw(self, robot: Field) -> NDArray[np.int64]:
        words = np.empty(2, dtype=np.uint64)
        fill(self._stream, words)
        x, y = int(high(words[0], self._grid.cols)), int(high(words[1], self._grid.rows))
        return np.array([x, y], dtype=np.int64)

    def _block(self, square: NDArray[np.int64], robot: Field) -> None:
        x, y = int(square[0]), int(square[1])
        side = self._changes.side
        block = np.zeros_like(self.table, dtype=np.bool_)
        block[y : y + side, x : x + side] = True
        u, v = robot
        block[max(v - 1, 0) : v + 2, max(u - 1, 0) : u + 2] = False
        for end_x, end_y in self._ends:
            block[end_y, end_x] = False
        self.table[block] = OBSTACLE
