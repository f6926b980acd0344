"""What M22's genetic algorithm gets of a scene."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import gapath
from benchmarks.measure import make_visibility_ga
from gapath.planning.stages import Stages
from gapath.problem import Problem


class Scene(NamedTuple):
    """What the genetic algorithm gets of a scene."""

    problem: Problem
    lengths: NDArray[np.int64]
    genes: int
    penalty: float
    """Pixels."""

    @classmethod
    def of(cls, name: str) -> "Scene":
        """Make the graph of one of gapath's scenes, with the settings of visibility_ga."""
        grid = gapath.load_map(name)
        assert grid.start is not None and grid.target is not None
        problem = Problem(grid, grid.start, grid.target)
        graph = make_visibility_ga().survey(problem, Stages())
        penalty = float(2 * (grid.rows + grid.cols))
        return cls(problem, graph.lengths, graph.obstacle_count, penalty)
