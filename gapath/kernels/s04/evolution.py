"""The whole evolution of S04's genetic algorithm in one kernel (Sec. IV)."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.history.epochs import EPOCHS, History
from gapath.kernels.jit import kernel
from gapath.kernels.lines import KEY_BITS, ONE_OBSTACLE, Ends
from gapath.kernels.rng import Stream, fill
from gapath.kernels.s04.genotype import (
    SWITCHES,
    Genotype,
    empty_chromosomes,
    empty_measures,
    empty_sums,
    empty_walk,
    fitness,
    flatten,
    measure,
    running_sums,
)
from gapath.kernels.s04.operators import Parents, cross, mutate, pair, rank

SETTINGS = np.dtype(
    [
        ("population", np.int64),
        ("max_epochs", np.int64),
        ("stop_when_feasible", np.bool_),
        ("column_wise", np.bool_),
        ("switches", np.int64),
        ("crossover_threshold", np.uint64),
        ("mutation_threshold", np.uint64),
        ("length_weight", np.float64),
        ("turns_weight", np.float64),
    ]
)
"""Settings of the genetic algorithm, as the kernel takes them: an array of one row."""

CERTAIN = np.uint64(1 << 32)
"""The threshold of what always happens."""


def run_evolution(
    table: NDArray[np.int32],
    ends: tuple[int, int, int, int],
    flips: tuple[bool, bool],
    settings: NDArray[np.void],
    stream: Stream,
) -> History:
    """Run the genetic algorithm and cut its history to the epochs that it took.

    Parameters
    ----------
    table, ends, flips, settings, stream
        As of `evolve`.

    Returns
    -------
    History
        Its last row is the answer.
    """
    most = int(settings["max_epochs"][0])
    history = np.empty(most, dtype=EPOCHS)
    chromosomes = np.empty((most, 2 * max(table.shape) + 2), dtype=np.int32)
    epochs = evolve(table, ends, *flips, settings, stream, history, chromosomes)
    return History(history[:epochs], chromosomes[:epochs])


@kernel
def evolve(
    table: NDArray[np.int32],
    ends: tuple[int, int, int, int],
    flip_x: bool,
    flip_y: bool,
    settings: NDArray[np.void],
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
        `GridMap.table`; n is its longer side.
    ends : (x, y, x, y)
        Start and target on the mirrored map.
    flip_x, flip_y : bool
        Mirror the map.
    settings : (1,) SETTINGS
        Settings.
    stream : (4,) uint64
        Random stream, advanced in place.
    history : (max_epochs,) EPOCHS
        Overwritten.
    chromosomes : (max_epochs, 2 n + 2) int32
        Overwritten with each epoch's fittest individual.

    Returns
    -------
    int
        Epochs taken.
    """
    setting = settings[0]
    size, n = setting["population"], max(table.shape)
    genotype = Genotype(setting["column_wise"], setting["switches"])

    sums = empty_sums(n)
    running_sums(table, flip_x, flip_y, sums)
    population, children = empty_chromosomes(size, n), empty_chromosomes(size, n)
    measures, walk = empty_measures(size), empty_walk(size)
    values = np.empty(size)
    order, spare = np.empty(size, dtype=np.int64), np.empty(size, dtype=np.int64)
    chosen = np.empty((3, size), dtype=np.int32)
    parents = Parents(chosen[0], chosen[1], chosen[2])
    words = np.empty(2 * (size // 2) + (n + SWITCHES) * size, dtype=np.uint64)
    of_pairs = words[: 2 * (size // 2)].reshape(2, size // 2)
    of_genes = words[2 * (size // 2) :].reshape(n + SWITCHES, size)

    fill(stream, words[2 * (size // 2) :])
    mutate(population, 0, genotype, CERTAIN, of_genes)
    epoch = 0
    while True:
        measure(population, Ends(*ends), sums, measures, walk)
        fitness(measures, setting["length_weight"], setting["turns_weight"], values)
        rank(values, order, spare)

        obstacle_sum = np.int64(0)
        cost_sum = np.int64(0)
        for key in measures.keys:
            obstacle_sum += key >> KEY_BITS
            cost_sum += key & (ONE_OBSTACLE - 1)
        best = measures.keys[order[0]]
        now = history[epoch]
        now["key"] = best
        now["obstacle_sum"] = obstacle_sum
        now["cost_sum"] = cost_sum
        flatten(population, order[0], chromosomes[epoch])
        epoch += 1

        if setting["stop_when_feasible"] and best < ONE_OBSTACLE:
            break
        if epoch == setting["max_epochs"]:
            break

        fill(stream, words)
        pair(order, n, setting["crossover_threshold"], of_pairs, parents)
        cross(population, parents, children)
        mutate(children, 1, genotype, setting["mutation_threshold"], of_genes)
        population, children = children, population

    return epoch
