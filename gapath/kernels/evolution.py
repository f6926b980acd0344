"""KG18's whole evolution in one kernel (Secs 3.3-3.8)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath._jit import kernel
from gapath.kernels.bspline import Basis
from gapath.kernels.fitness import KEY_BITS, ONE_OBSTACLE, fitness
from gapath.kernels.population import Ends, InitialPopulation, cross, initialise, mutate, rank_best
from gapath.rng import Stream, fill, high, low


class EvolutionSettings(NamedTuple):
    """Settings of the genetic algorithm, as the kernel takes them."""

    population: int
    control_points: int
    min_epochs: int
    max_epochs: int
    mixing: tuple[int, int]
    mutation_threshold: np.uint64
    clip_to_map: bool
    initial: InitialPopulation


class EvolutionResult(NamedTuple):
    """History of an evolution of E epochs; epoch 1 is the initial population."""

    keys: NDArray[np.int64]
    """(E,) key of the best individual."""
    obstacle_sums: NDArray[np.int64]
    """(E,) obstacle fields of the whole population."""
    cost_sums: NDArray[np.int64]
    """(E,) cost of the whole population, in units of 1 / SCALE."""
    chromosomes: NDArray[np.int32]
    """(E, 2 k) the best individual."""


def run_evolution(
    table: NDArray[np.int32],
    ends: Ends,
    rule: int,
    settings: EvolutionSettings,
    basis: Basis,
    stream: Stream,
) -> EvolutionResult:
    """Run the genetic algorithm and cut its history to the epochs that it took.

    Parameters
    ----------
    table, ends, rule, settings, basis, stream
        As of `evolve`.

    Returns
    -------
    EvolutionResult
        Its last row is the answer.
    """
    most = settings.max_epochs
    history = EvolutionResult(
        np.empty(most, dtype=np.int64),
        np.empty(most, dtype=np.int64),
        np.empty(most, dtype=np.int64),
        np.empty((most, 2 * settings.control_points), dtype=np.int32),
    )
    epochs = evolve(table, ends, rule, settings, basis, stream, history)
    return EvolutionResult(*(part[:epochs] for part in history))


def evaluations(settings: EvolutionSettings, epochs: int) -> int:
    """Count the chromosomes evaluated: the selected quarter, copied, is not evaluated again."""
    size = settings.population
    return size + (epochs - 1) * (size - size // 4)


@kernel
def evolve(
    table: NDArray[np.int32],
    ends: Ends,
    rule: int,
    settings: EvolutionSettings,
    basis: Basis,
    stream: Stream,
    history: EvolutionResult,
) -> int:
    """Run the genetic algorithm.

    It returns one number, because an interrupt that comes while numba makes Python objects
    of a result kills the process.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    ends : Ends
        Start and target.
    rule : int
        Corner-cutting rule.
    settings : EvolutionSettings
        Settings; the population is at least 4.
    basis : Basis
        Basis functions at the way points.
    stream : (4,) uint64
        Random stream, advanced in place.
    history : EvolutionResult
        Arrays for ``max_epochs`` epochs, overwritten.

    Returns
    -------
    int
        Epochs taken.
    """
    rows, cols = table.shape
    size, genes = settings.population, 2 * settings.control_points
    inner = genes - 4
    selected = size // 4

    population = np.empty((size, genes), dtype=np.int32)
    offspring = np.empty((size, genes), dtype=np.int32)
    keys = np.empty(size, dtype=np.int64)
    offspring_keys = np.empty(size, dtype=np.int64)
    best = np.empty(selected, dtype=np.int64)
    words = np.empty(size * (inner + 1), dtype=np.uint64)

    first = words[: size * inner]
    fill(stream, first)
    initialise(population, ends, rows, cols, settings.clip_to_map, settings.initial, first)
    evaluated = 0  # individuals before this one carry their key over
    epoch = 0
    while True:
        for i in range(evaluated, size):
            keys[i] = fitness(table, population[i], basis, rule)
        rank_best(keys, best)

        obstacle_sum = np.int64(0)
        cost_sum = np.int64(0)
        for i in range(size):
            obstacle_sum += keys[i] >> KEY_BITS
            cost_sum += keys[i] & (ONE_OBSTACLE - 1)
        history.keys[epoch] = keys[best[0]]
        history.obstacle_sums[epoch] = obstacle_sum
        history.cost_sums[epoch] = cost_sum
        history.chromosomes[epoch] = population[best[0]]
        epoch += 1

        # KG18 Sec. 3.8: a feasible path ends it, never before min_epochs
        feasible = history.keys[epoch - 1] < ONE_OBSTACLE
        if (feasible and epoch >= settings.min_epochs) or epoch == settings.max_epochs:
            break

        for i in range(selected):
            offspring[i] = population[best[i]]
            offspring_keys[i] = keys[best[i]]
        draws = words[: (size - selected) * (inner + 1)]
        fill(stream, draws)
        w = 0
        for i in range(selected, size):
            a, b = best[high(draws[w], selected)], best[low(draws[w], selected)]
            if keys[a] >= keys[b]:  # on equal fitness B dominates, eq. (6)
                a, b = b, a
            cross(population[a], population[b], offspring[i], settings.mixing)
            mutate(
                offspring[i],
                rows,
                cols,
                settings.clip_to_map,
                settings.mutation_threshold,
                draws[w + 1 : w + 1 + inner],
            )
            w += 1 + inner
        population, offspring = offspring, population
        keys, offspring_keys = offspring_keys, keys
        evaluated = selected

    return epoch


@kernel
def fitness_history(
    result: EvolutionResult, population: int, vln: float, scale: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Give the paper's numbers: eq. (5) of the best individual, and its mean.

    Parameters
    ----------
    result : EvolutionResult
        History of E epochs.
    population : int
        Individuals.
    vln : float
        What an obstacle field counts.
    scale : int
        Units of cost in a cost of 1.

    Returns
    -------
    best, mean : (E,) float64
        Epoch by epoch.
    """
    best = np.empty(result.keys.shape[0])
    mean = np.empty(result.keys.shape[0])
    for i in range(best.shape[0]):
        key = result.keys[i]
        best[i] = (key >> KEY_BITS) * vln + (key & (ONE_OBSTACLE - 1)) / scale
        mean[i] = (result.obstacle_sums[i] * vln + result.cost_sums[i] / scale) / population
    return best, mean
