"""KG18's whole evolution in one kernel (Secs 3.3-3.8).

What goes in and out are arrays and plain numbers: to unpack a NamedTuple of as many settings
takes numba longer than an epoch.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath._jit import kernel
from gapath.kernels.bspline import Basis
from gapath.kernels.evaluation import evaluate, workspace
from gapath.kernels.fitness import KEY_BITS, ONE_OBSTACLE
from gapath.kernels.history import EPOCHS
from gapath.kernels.population import (
    Ends,
    InitialPopulation,
    cross,
    gene_limits,
    initialise,
    mutate,
    rank_best,
)
from gapath.rng import Stream, fill, high, low

SETTINGS = np.dtype(
    [
        ("population", np.int64),
        ("min_epochs", np.int64),
        ("max_epochs", np.int64),
        ("mixing_numerator", np.int64),
        ("mixing_denominator", np.int64),
        ("mutation_threshold", np.uint64),
        ("clip_to_map", np.bool_),
        ("line_jitter", np.int64),
        ("line_jitter_threshold", np.uint64),
        ("neighbourhood", np.int64),
        ("margin", np.int64),
    ]
)
"""Settings of the genetic algorithm, as the kernel takes them: an array of one row."""


class EvolutionResult(NamedTuple):
    """History of an evolution of E epochs; epoch 1 is the initial population."""

    epochs: NDArray[np.void]
    """(E,) `EPOCHS`."""
    chromosomes: NDArray[np.int32]
    """(E, 2 k) the best individual."""


def run_evolution(
    table: NDArray[np.int32],
    ends: tuple[int, int, int, int],
    rule: int,
    settings: NDArray[np.void],
    basis: Basis,
    stream: Stream,
) -> EvolutionResult:
    """Run the genetic algorithm and cut its history to the epochs that it took.

    Parameters
    ----------
    table, ends, rule, settings, stream
        As of `evolve`.
    basis : Basis
        Basis functions at w way points.

    Returns
    -------
    EvolutionResult
        Its last row is the answer.
    """
    most = int(settings["max_epochs"][0])
    history = np.empty(most, dtype=EPOCHS)
    chromosomes = np.empty((most, 2 * basis.weights.shape[1]), dtype=np.int32)
    epochs = evolve(table, ends, rule, settings, *basis, stream, history, chromosomes)
    return EvolutionResult(history[:epochs], chromosomes[:epochs])


def evaluations(population: int, epochs: int) -> int:
    """Count the chromosomes evaluated: the selected quarter, copied, is not evaluated again."""
    return population + (epochs - 1) * (population - population // 4)


@kernel
def evolve(
    table: NDArray[np.int32],
    ends: tuple[int, int, int, int],
    rule: int,
    settings: NDArray[np.void],
    weights: NDArray[np.float64],
    rounding: NDArray[np.float64],
    stream: Stream,
    history: NDArray[np.void],
    chromosomes: NDArray[np.int32],
) -> int:
    """Run the genetic algorithm.

    It returns one number, because an interrupt that comes while numba makes Python objects
    of a result kills the process.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    ends : (x, y, x, y)
        Start and target.
    rule : int
        Corner-cutting rule.
    settings : (1,) SETTINGS
        Settings; the population is at least 4.
    weights, rounding
        `gapath.kernels.bspline.Basis`.
    stream : (4,) uint64
        Random stream, advanced in place.
    history : (max_epochs,) EPOCHS
        Overwritten.
    chromosomes : (max_epochs, 2 k) int32
        Overwritten with each epoch's best individual.

    Returns
    -------
    int
        Epochs taken.
    """
    rows, cols = table.shape
    setting = settings[0]
    size, genes = setting["population"], chromosomes.shape[1]
    mixing = setting["mixing_numerator"], setting["mixing_denominator"]
    half = min(rows, cols) // 2
    selected = size // 4
    basis = Basis(weights, rounding)

    padded = (genes + 15) // 16 * 16  # whole vectors
    population = np.zeros((size, padded), dtype=np.int32)
    offspring = np.zeros((size, padded), dtype=np.int32)
    limits = np.empty((2, padded), dtype=np.int32)
    keys = np.empty(size, dtype=np.int64)
    offspring_keys = np.empty(size, dtype=np.int64)
    best = np.empty(selected, dtype=np.int64)
    words = np.zeros(padded, dtype=np.uint64)
    drawn = words[1 : genes - 2]  # one for the parents, one for each inner gene
    memory = workspace(basis, size)

    initial = InitialPopulation(
        setting["line_jitter"],
        setting["line_jitter_threshold"],
        setting["neighbourhood"],
        setting["margin"],
    )
    gene_limits(limits, Ends(*ends), genes, rows, cols, setting["clip_to_map"])
    first = np.empty(size * (genes - 4), dtype=np.uint64)
    fill(stream, first)
    initialise(population[:, :genes], Ends(*ends), rows, cols, limits, initial, first)
    evaluated = 0  # individuals before this one carry their key over
    epoch = 0
    while True:
        evaluate(table, population[evaluated:], basis, rule, keys[evaluated:], memory)
        rank_best(keys, best)

        obstacle_sum = np.int64(0)
        cost_sum = np.int64(0)
        for i in range(size):
            obstacle_sum += keys[i] >> KEY_BITS
            cost_sum += keys[i] & (ONE_OBSTACLE - 1)
        now = history[epoch]
        now["key"] = keys[best[0]]
        now["obstacle_sum"] = obstacle_sum
        now["cost_sum"] = cost_sum
        chromosomes[epoch] = population[best[0], :genes]
        epoch += 1

        # KG18 Sec. 3.8: a feasible path ends it, never before min_epochs
        feasible = keys[best[0]] < ONE_OBSTACLE
        if (feasible and epoch >= setting["min_epochs"]) or epoch == setting["max_epochs"]:
            break

        for i in range(selected):
            offspring[i] = population[best[i]]
            offspring_keys[i] = keys[best[i]]
        for i in range(selected, size):
            fill(stream, drawn)
            a, b = best[high(drawn[0], selected)], best[low(drawn[0], selected)]
            if keys[a] >= keys[b]:  # on equal fitness B dominates, eq. (6)
                a, b = b, a
            cross(population[a], population[b], offspring[i], mixing)
            mutate(offspring[i], limits, half, setting["mutation_threshold"], words)
        population, offspring = offspring, population
        keys, offspring_keys = offspring_keys, keys
        evaluated = selected

    return epoch
