"""KG18's settings on geneticalgorithm2."""

import warnings
from collections.abc import Sequence

from geneticalgorithm2 import geneticalgorithm2

from benchmarks.rivals.objective import Objective
from gapath.planners.bspline_ga import Planner


def evolve(planner: Planner, objective: Objective, seed: int) -> tuple[Sequence[float], float]:
    library = geneticalgorithm2(
        dimension=len(objective.most),
        variable_type="int",
        variable_boundaries=[(0, most) for most in objective.most],
        algorithm_parameters={
            "max_num_iteration": planner.max_epochs,
            "population_size": planner.population,
            "mutation_probability": planner.mutation_probability,
            "elit_ratio": 0.25,
            "parents_portion": 0.25,  # the elite, and one more where an odd number would be bred
            "crossover_type": "uniform",
            "selection_type": "ranking",
        },
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Python 3.11 of floats as bounds of integers
        result = library.run(
            no_plot=True,
            disable_printing=True,
            progress_bar_stream=None,
            function=objective,
            seed=seed,
        )
    return result.variable, float(result.score)
