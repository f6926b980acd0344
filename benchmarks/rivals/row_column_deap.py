"""S04's genetic algorithm on DEAP, written as its users write one: the library to beat.

Only paths are measured and rated by gapath's kernels, the whole population at once, as fitness
is relative to it. An individual is a list of genes (location, direction), with flag and
switches beside it, so DEAP's own one-point crossover is S04's.
"""

import random
from typing import Any

import numpy as np
from deap import algorithms, base, creator, tools

from gapath.kernels.s04.genotype import (
    Chromosomes,
    empty_measures,
    empty_sums,
    empty_walk,
    fitness,
    measure,
    running_sums,
)
from gapath.planners.row_column_ga import Planner
from gapath.problem import Problem
from gapath.survey.row_column import SquareView

creator.create("Fitness", base.Fitness, weights=(1.0,))
creator.create("Individual", list, fitness=creator.Fitness, flag=int, switch=list)


def make_individual(n: int, planner: Planner) -> Any:
    individual = creator.Individual((0, 0) for _ in range(n))
    individual.switch = [n - 1, n - 1]
    return mutate(individual, planner, 1.0)[0]


def clone(individual: Any) -> Any:
    """Copy what is to be copied: DEAP's own deepcopy would take most of the time."""
    copy = creator.Individual(individual)
    copy.flag, copy.switch = individual.flag, individual.switch[:]
    return copy


def select_by_rank(population: list[Any], k: int) -> list[Any]:
    ranked = tools.selBest(population, len(population))
    return random.choices(ranked, weights=range(len(population), 0, -1), k=k)


def mutate(individual: Any, planner: Planner, probability: float) -> tuple[Any]:
    n = len(individual)
    for gene in range(n):
        if random.random() < probability:
            individual[gene] = random.randrange(n), random.randrange(2)
            individual.flag = random.randrange(2) if planner.column_wise else 0
    for s in range(planner.switches):
        if random.random() < probability:
            individual.switch[s] = random.randrange(n)
    return (individual,)


class Rating:
    """Gives every individual of a population its fitness."""

    def __init__(self, problem: Problem, planner: Planner) -> None:
        self.view = SquareView.of(problem)
        self.weights = planner.length_weight, planner.turns_weight
        self.sums = empty_sums(self.view.side)
        running_sums(self.view.table, *self.view.flips, self.sums)
        self.measures = empty_measures(planner.population)
        self.walk = empty_walk(planner.population)
        self.values = np.empty(planner.population)

    def __call__(self, population: list[Any]) -> None:
        """Rate individuals against one another."""
        chromosomes = as_chromosomes(population)
        measure(chromosomes, self.view.ends, self.sums, self.measures, self.walk)
        fitness(self.measures, *self.weights, self.values)
        for individual, value in zip(population, self.values.tolist(), strict=True):
            individual.fitness.values = (value,)


def as_chromosomes(population: list[Any]) -> Chromosomes:
    genes = np.array(population, dtype=np.int32)
    return Chromosomes(
        np.array([individual.flag for individual in population], dtype=np.int32),
        genes[:, :, 0].T.copy(),
        genes[:, :-1, 1].T.copy(),
        np.array([individual.switch for individual in population], dtype=np.int32).T.copy(),
    )


def evolve(problem: Problem, planner: Planner, seed: int) -> Chromosomes:
    """Evolve for `planner.max_epochs` and give the fittest."""
    random.seed(seed)
    n, size = max(problem.map.weights.shape), planner.population
    toolbox = base.Toolbox()
    toolbox.register("clone", clone)
    toolbox.register("individual", make_individual, n, planner)
    toolbox.register("population", tools.initRepeat, list, toolbox.individual)
    toolbox.register("rate", Rating(problem, planner))
    toolbox.register("select", select_by_rank)
    toolbox.register("mate", tools.cxOnePoint)
    toolbox.register("mutate", mutate, planner=planner, probability=planner.mutation_probability)

    population = toolbox.population(size)
    toolbox.rate(population)
    for _ in range(planner.max_epochs - 1):
        elite = [toolbox.clone(best) for best in tools.selBest(population, 1)]
        parents = toolbox.select(population, size)
        children = algorithms.varAnd(parents, toolbox, planner.crossover_probability, 1.0)
        population = elite + children[: size - 1]
        toolbox.rate(population)
    return as_chromosomes(tools.selBest(population, 1))
