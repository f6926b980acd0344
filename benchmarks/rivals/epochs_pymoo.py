"""KG18's settings on pymoo."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.problem import Problem
from pymoo.operators.crossover.ux import UniformCrossover
from pymoo.operators.mutation.pm import PM
from pymoo.operators.repair.rounding import RoundingRepair
from pymoo.operators.sampling.rnd import IntegerRandomSampling
from pymoo.operators.selection.rnd import RandomSelection
from pymoo.optimize import minimize

from benchmarks.rivals.objective import Objective
from gapath.planners.bspline_ga import Planner


class Points(Problem):  # type: ignore[misc]
    """All chromosomes of an epoch are handed over at once, and rated one by one as elsewhere."""

    def __init__(self, objective: Objective):
        super().__init__(
            n_var=len(objective.most), n_obj=1, xl=0, xu=np.array(objective.most), vtype=int
        )
        self.objective = objective

    def _evaluate(self, x: Any, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
        out["F"] = [self.objective(genes) for genes in x]


def evolve(planner: Planner, objective: Objective, seed: int) -> tuple[Sequence[float], float]:
    quarter = planner.population // 4
    algorithm = GA(
        pop_size=quarter,  # those that survive, and breed
        n_offsprings=planner.population - quarter,
        sampling=IntegerRandomSampling(),
        selection=RandomSelection(),
        crossover=UniformCrossover(prob=1.0),
        mutation=PM(prob_var=planner.mutation_probability, vtype=float, repair=RoundingRepair()),
        eliminate_duplicates=False,
    )
    found = minimize(Points(objective), algorithm, ("n_gen", planner.max_epochs), seed=seed)
    return found.X, float(found.F[0])
