"""KG18's fitness as a user of a library of genetic algorithms writes it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.kg18.bspline import Basis, basis
from gapath.kernels.kg18.fitness import fitness
from gapath.planners.bspline_ga import Planner
from gapath.problem import Problem


@kernel
def rate(
    table: NDArray[np.int32],
    chromosome: NDArray[np.int32],
    weights: NDArray[np.float64],
    rounding: NDArray[np.float64],
    rule: int,
) -> int:
    """Call the fitness without a NamedTuple, which takes as long to unpack as all the rest."""
    return fitness(table, chromosome, Basis(weights, rounding), rule)


class Objective:
    """KG18's fitness of the inner control points, as a user of a library writes it.

    Parameters
    ----------
    problem : Problem
        Map, start and target.
    planner : Planner
        Tells how many control and way points there are.
    """

    def __init__(self, problem: Problem, planner: Planner):
        self.table, self.rule = problem.map.table, int(problem.corner_cutting)
        self.basis = basis(planner.control_points, planner.way_points, planner.sampling == "span")
        self.chromosome = np.zeros(2 * planner.control_points, dtype=np.int32)
        self.chromosome[:2], self.chromosome[-2:] = problem.start, problem.target
        inner = planner.control_points - 2
        self.most = [problem.map.cols - 1, problem.map.rows - 1] * inner
        """The greatest value of every gene; the least is 0."""
        self.calls = 0

    def __call__(self, genes: Sequence[float]) -> float:
        """Evaluate x, y of each inner control point; smaller is fitter."""
        self.calls += 1
        self.chromosome[2:-2] = genes
        return float(rate(self.table, self.chromosome, *self.basis, self.rule))
