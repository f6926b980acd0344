"""KG18's settings on pygad."""

from collections.abc import Sequence
from typing import Any

import pygad

from benchmarks.rivals.objective import Objective
from gapath.planners.bspline_ga import Planner


def evolve(planner: Planner, objective: Objective, seed: int) -> tuple[Sequence[float], float]:
    def fitness(ga: Any, genes: Sequence[float], index: int) -> float:
        return -objective(genes)  # pygad looks for the greatest

    quarter = planner.population // 4
    ga = pygad.GA(
        num_generations=planner.max_epochs - 1,  # the initial population is not counted
        sol_per_pop=planner.population,
        num_parents_mating=quarter,
        keep_elitism=quarter,
        fitness_func=fitness,
        num_genes=len(objective.most),
        gene_type=int,
        gene_space=[range(most + 1) for most in objective.most],
        parent_selection_type="sss",  # the best ones
        crossover_type="uniform",
        mutation_type="random",
        mutation_probability=planner.mutation_probability,
        random_seed=seed,
        suppress_warnings=True,
    )
    ga.run()
    genes, value, _ = ga.best_solution(ga.last_generation_fitness)
    return genes, -float(value)
