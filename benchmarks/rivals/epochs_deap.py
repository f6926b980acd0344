"""KG18's settings on DEAP: its operators, in a loop as its users write one."""

import random
from collections.abc import Sequence
from typing import Any

from deap import algorithms, base, creator, tools

from benchmarks.rivals.objective import Objective
from gapath.planners.bspline_ga import Planner

creator.create("Smallest", base.Fitness, weights=(-1.0,))
creator.create("Points", list, fitness=creator.Smallest)


def evolve(planner: Planner, objective: Objective, seed: int) -> tuple[Sequence[float], float]:
    random.seed(seed)
    size, genes = planner.population, len(objective.most)
    toolbox = base.Toolbox()
    toolbox.register("clone", creator.Points)  # a list of integers needs no deepcopy
    toolbox.register("mate", tools.cxUniform, indpb=0.5)
    toolbox.register(
        "mutate",
        tools.mutUniformInt,
        low=[0] * genes,
        up=objective.most,
        indpb=planner.mutation_probability,
    )

    def evaluate(individuals: list[Any]) -> None:
        for individual in individuals:
            individual.fitness.values = (objective(individual),)

    population = [
        creator.Points(random.randint(0, most) for most in objective.most) for _ in range(size)
    ]
    evaluate(population)
    for _ in range(planner.max_epochs - 1):
        parents = tools.selBest(population, size // 4)
        mating = random.choices(parents, k=size - len(parents))
        children = algorithms.varAnd(mating, toolbox, cxpb=1.0, mutpb=1.0)
        evaluate(children)
        population = parents + children
    best = tools.selBest(population, 1)[0]
    return best, best.fitness.values[0]
