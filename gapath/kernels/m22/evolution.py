"""The genetic algorithm of M22 in one kernel: that of the library geneticalgorithm2 (Table I).

A chromosome is a row of indices of points where the path turns, from the start to the end; what
follows the end does not count. Fitness is the length of that path, eq. (7); a chromosome that
uses a line that is not free has the perimeter of the picture instead, and so has, where the ends
are genes too, one that does not begin at the start or never reaches the end.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.history.epochs import History
from gapath.kernels.jit import kernel
from gapath.kernels.m22.graph import END, START
from gapath.kernels.m22.operators import INDEX_BITS, choose_breeders, cross_and_mutate, select
from gapath.kernels.rng import Stream, fill, high, low

SETTINGS = np.dtype(
    [
        ("population", np.int64),
        ("ends_are_genes", np.bool_),
        ("max_epochs", np.int64),
        ("max_stagnation", np.int64),
        ("parents", np.int64),
        ("elites", np.int64),
        ("breeders", np.int64),
        ("crossover_threshold", np.uint64),
        ("mutation_threshold", np.uint64),
        ("roulette_skips_elites", np.bool_),
        ("distinct_parents", np.bool_),
        ("middle_includes_end", np.bool_),
        ("first_excludes_last", np.bool_),
        ("first_best_is_last_drawn", np.bool_),
        ("offspring_can_save", np.bool_),
        ("penalty", np.int64),
    ]
)
"""Settings of the genetic algorithm, as the kernel takes them: an array of one row. With
`breeders` 0 every parent breeds with the probability of crossover; with `first_excludes_last` no
individual of the first population has the last point as a gene; `penalty` is the fitness where a
restriction is broken, in units of 1 / SCALE."""

EPOCHS = np.dtype([("best", np.int64), ("sum", np.int64)])
"""What happened in an epoch: fitness of the best individual and of all together, 1 / SCALE."""


def run_evolution(
    lengths: NDArray[np.int64], genes: int, settings: NDArray[np.void], stream: Stream
) -> History:
    """Run the genetic algorithm and cut its history to the epochs that it took.

    Parameters
    ----------
    lengths, settings, stream
        As of `evolve`.
    genes : int
        Genes of a chromosome.

    Returns
    -------
    History
        Its last row is the answer.
    """
    most = int(settings["max_epochs"][0])
    history = np.empty(most, dtype=EPOCHS)
    chromosomes = np.empty((most, genes), dtype=np.int32)
    epochs = evolve(lengths, settings, stream, history, chromosomes)
    return History(history[:epochs], chromosomes[:epochs])


@kernel
def path_length(
    lengths: NDArray[np.int64], chromosome: NDArray[np.int32], ends_are_genes: bool
) -> int:
    """Measure the path of a chromosome, M22 eqs (6) to (8).

    Parameters
    ----------
    lengths : (n, n) int64
        Lengths of the free lines between points, negative where a line is not free.
    chromosome : (genes,) int32
        Indices of points.
    ends_are_genes : bool
        The first gene must be the start and one the end; else both stand outside the genes.

    Returns
    -------
    int
        The length in units of 1 / SCALE, or -1 if a restriction is broken.
    """
    if ends_are_genes and chromosome[0] != START:
        return -1
    at = START
    total = np.int64(0)
    for to in chromosome:
        length = lengths[at, to]
        if length < 0:
            return -1
        total += length
        if to == END:
            return total
        at = to
    length = lengths[at, END]
    if ends_are_genes or length < 0:
        return -1
    return total + length


@kernel
def evolve(
    lengths: NDArray[np.int64],
    settings: NDArray[np.void],
    stream: Stream,
    history: NDArray[np.void],
    chromosomes: NDArray[np.int32],
) -> int:
    """Run the genetic algorithm.

    Parameters
    ----------
    lengths : (n, n) int64
        Lengths of the free lines between points, as of `path_length`.
    settings : (1,) SETTINGS
        Settings.
    stream : (4,) uint64
        Random stream, advanced in place.
    history : (max_epochs,) EPOCHS
        Overwritten.
    chromosomes : (max_epochs, genes) int32
        Overwritten with each epoch's best individual.

    Returns
    -------
    int
        Epochs taken: populations that were ranked, the first included.
    """
    setting = settings[0]
    size, genes, points = setting["population"], chromosomes.shape[1], lengths.shape[0]
    parents = setting["parents"]

    population = np.empty((size, genes), dtype=np.int32)
    spare = np.empty((size, genes), dtype=np.int32)
    scores = np.empty(size, dtype=np.int64)
    spare_scores = np.empty(size, dtype=np.int64)
    keys = np.empty(size, dtype=np.int64)
    sums = np.empty(size, dtype=np.int64)
    breeding = np.empty(parents, dtype=np.int64)
    chosen = np.empty(parents, dtype=np.uint64)
    pairs = np.empty((size - parents) // 2, dtype=np.uint64)
    of_genes = np.empty(3 * genes, dtype=np.uint64)

    drawn = points - 1 if setting["first_excludes_last"] else points
    for i in range(size):
        fill(stream, of_genes[:genes])
        for gene in range(genes):
            population[i, gene] = high(of_genes[gene], drawn)
        scores[i] = fitness(lengths, population[i], setting)
    best = scores.min()
    if setting["first_best_is_last_drawn"]:
        best = scores[size - 1]

    stagnation = 0
    epoch = 0
    while True:
        for i in range(size):
            keys[i] = (scores[i] << INDEX_BITS) + i
        keys.sort()
        first = keys[0] & ((1 << INDEX_BITS) - 1)
        now = history[epoch]
        now["best"] = scores[first]
        now["sum"] = scores.sum()
        chromosomes[epoch] = population[first]
        epoch += 1

        if epoch == setting["max_epochs"]:
            break
        saved = setting["offspring_can_save"] and scores[first] < best
        if stagnation > setting["max_stagnation"] and not saved:
            break
        if scores[first] < best:
            best = scores[first]
            stagnation = 0
        else:
            stagnation += 1

        select(population, scores, keys, setting, stream, chosen, sums, spare, spare_scores)
        breeders = choose_breeders(setting, stream, chosen, breeding)
        fill(stream, pairs)
        for pair in range(pairs.shape[0]):
            a = high(pairs[pair], breeders)
            if setting["distinct_parents"]:
                b = low(pairs[pair], breeders - 1)
                b += b >= a
            else:
                b = low(pairs[pair], breeders)
            child = parents + 2 * pair
            fill(stream, of_genes)
            cross_and_mutate(spare, breeding[a], breeding[b], child, points, setting, of_genes)
            for i in range(child, child + 2):
                spare_scores[i] = fitness(lengths, spare[i], setting)
        population, spare = spare, population
        scores, spare_scores = spare_scores, scores

    return epoch


@kernel
def fitness(
    lengths: NDArray[np.int64], chromosome: NDArray[np.int32], setting: NDArray[np.void]
) -> int:
    """Give the length of a chromosome's path, or what a broken restriction counts."""
    length = path_length(lengths, chromosome, setting["ends_are_genes"])
    return length if length >= 0 else setting["penalty"]
