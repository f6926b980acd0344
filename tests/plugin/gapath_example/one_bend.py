"""Two straight lines that meet in a random field."""

from dataclasses import dataclass

import numpy as np

from gapath.errors import require
from gapath.kernels.lines import ONE_OBSTACLE, line_key
from gapath.kernels.raster import polyline
from gapath.kernels.rng import Stream, fill, high, low
from gapath.kernels.units import SCALE
from gapath.problem import Plan, PlanStatus, Query


@dataclass(frozen=True)
class Planner:
    """Tries random fields to bend at.

    Parameters
    ----------
    tries : int
        Fields to try, at least 1.
    """

    tries: int

    exact = False
    minimises = "weights"

    def __post_init__(self) -> None:
        require(1 <= self.tries <= 10**6, "planner.tries", self.tries, "an integer from 1 to 10^6")

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Give the first free path, by way of one field."""
        grid, start, target = problem.map, problem.start, problem.target
        words = np.empty(self.tries, dtype=np.uint64)
        fill(stream, words)
        for word in words:
            bend = (high(word, grid.cols), low(word, grid.rows))
            key = int(grid.table[start[1], start[0]])
            for ends in ((*start, *bend), (*bend, *target)):
                key += line_key(grid.table, *ends, int(problem.corner_cutting))
            if key < ONE_OBSTACLE:
                path = polyline(np.array([start, bend, target], dtype=np.int32))
                return Plan(PlanStatus.FOUND, path, key / SCALE)
        return Plan(PlanStatus.NOT_FOUND)
