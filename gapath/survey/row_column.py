"""S04's genotype on a given map: where its square lies, and whether it can express a path."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.grid import Table
from gapath.kernels.lines import Ends
from gapath.kernels.s04.genotype import Genotype, decode, empty_sums, running_sums
from gapath.kernels.s04.reach import reach
from gapath.problem import Query


class SquareView(NamedTuple):
    """How a problem looks to S04's kernels: the start at the upper left of the target.

    The map is mirrored, if need be, and counts as padded to a square at its end.
    """

    table: Table
    """The map as it is."""
    ends: Ends
    """Start and target on the mirrored map."""
    flips: tuple[bool, bool]
    """Whether x and y are mirrored."""

    @classmethod
    def of(cls, problem: Query) -> "SquareView":
        """Look at a problem."""
        grid, (x, y), (u, v) = problem.map, problem.start, problem.target
        flips = u < x, v < y
        if flips[0]:
            x, u = grid.cols - 1 - x, grid.cols - 1 - u
        if flips[1]:
            y, v = grid.rows - 1 - y, grid.rows - 1 - v
        return cls(grid.table, Ends(x, y, u, v), flips)

    @property
    def side(self) -> int:
        """n, the number of genes."""
        return int(max(self.table.shape))

    def paths(self, chromosomes: NDArray[np.int32]) -> NDArray[np.int32]:
        """Give the paths of chromosomes on the map as it is.

        Parameters
        ----------
        chromosomes : (P, 2 n + 2) int32
            Each as flag, n locations, n - 1 directions, 2 switches.

        Returns
        -------
        (P, 2 n - 1, 2) int32
            Points (x, y) that straight lines join.
        """
        points = decode(chromosomes, self.ends)
        for axis in range(2):
            if self.flips[axis]:
                points[:, :, axis] = self.table.shape[1 - axis] - 1 - points[:, :, axis]
        return points


class Class(NamedTuple):
    """Which chromosomes have a free path on a map."""

    row_wise: bool
    """Row-wise ones: Geisler's planner can find a path."""
    column_wise: bool
    """Column-wise ones; with `row_wise` all that Hermanu's planner has."""
    switches: int | None
    """The fewest switches of a free path; S04 allows `SWITCHES`. None if no number helps."""


def classify(problem: Query) -> Class:
    """Prove which chromosomes have a free path.

    Parameters
    ----------
    problem : Query
        Start and target on a known map.

    Returns
    -------
    Class
        By dynamic programming over all chromosomes (`gapath.kernels.s04.reach`).
    """
    least, _ = _reached(problem, column_wise=True)
    last = least[-1, :, 0]
    fewest = int(last.min())
    return Class(bool(last[0] == 0), bool(last[1] == 0), fewest if fewest < len(least) else None)


def express(problem: Query, genotype: Genotype) -> NDArray[np.int32] | None:
    """Find a chromosome whose path is free, or prove that there is none.

    The witness of what `classify` says, for people and tests: gapath itself needs only that.

    Parameters
    ----------
    problem : Query
        Start and target on a known map.
    genotype : Genotype
        What chromosomes can be.

    Returns
    -------
    (2 n + 2,) int32 or None
        The chromosome, with as few switches as any; None if no chromosome has a free path.
    """
    least, origins = _reached(problem, genotype.column_wise)
    n = len(least)
    mode = int(least[n - 1, :, 0].argmin())
    used = int(least[n - 1, mode, 0])
    if used > genotype.switches or used == n:
        return None
    row = np.zeros(2 * n + 2, dtype=np.int32)
    row[2 * n :] = n - 1
    at = 0
    for i in range(n - 1, 0, -1):
        code = int(origins[i, mode, at])
        before, toggled, direction = code >> 2, code >> 1 & 1, code & 1
        row[1 + i], row[n + i] = at, direction
        if toggled:
            row[2 * n - 1 + used] = i - 1
            used, mode = used - 1, 1 - mode
        at = before
    row[0] = mode
    return row


def _reached(problem: Query, column_wise: bool) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Run the dynamic programming (`gapath.kernels.s04.reach.reach`)."""
    view = SquareView.of(problem)
    n = view.side
    sums = empty_sums(n)
    running_sums(view.table, *view.flips, sums)
    least, origins = np.empty((2, n, 2, n), dtype=np.int32)
    reach(sums, view.ends, column_wise, least, origins)
    return least, origins
