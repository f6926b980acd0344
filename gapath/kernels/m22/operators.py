"""How M22's genetic algorithm makes a generation of the one before: that of geneticalgorithm2."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.rng import Stream, fill, happens, high, low
from gapath.kernels.units import SCALE

INDEX_BITS = 16
"""Bits of an individual's number below its fitness in a sort key."""


@kernel
def select(
    population: NDArray[np.int32],
    scores: NDArray[np.int64],
    keys: NDArray[np.int64],
    setting: NDArray[np.void],
    stream: Stream,
    words: NDArray[np.uint64],
    sums: NDArray[np.int64],
    chosen: NDArray[np.int32],
    chosen_scores: NDArray[np.int64],
) -> None:
    """Copy the parents: the elite, then by roulette, with replacement.

    A place on the wheel is as wide as the worst fitness, plus one pixel, less the own one.

    Parameters
    ----------
    population : (P, genes) int32
        Individuals.
    scores : (P,) int64
        Their fitness.
    keys : (P,) int64
        Sorted, each with an individual's number in its lower bits.
    setting : SETTINGS
        Settings.
    stream : (4,) uint64
        Random stream, advanced in place.
    words : (parents,) uint64
        Overwritten.
    sums : (P,) int64
        Overwritten.
    chosen : (P, genes) int32
        Overwritten from its first row on.
    chosen_scores : (P,) int64
        Overwritten from its first value on.
    """
    mask = (1 << INDEX_BITS) - 1
    size, parents, elites = scores.shape[0], setting["parents"], setting["elites"]
    first = elites if setting["roulette_skips_elites"] else 0
    worst = (keys[size - 1] >> INDEX_BITS) + SCALE
    total = np.int64(0)
    for i in range(first, size):
        total += worst - (keys[i] >> INDEX_BITS)
        sums[i] = total
    fill(stream, words)
    for i in range(parents):
        place = i
        if i >= elites:
            ball = np.int64(words[i] % np.uint64(total))
            below, above = first, size - 1
            while below < above:
                middle = (below + above) >> 1
                if sums[middle] > ball:
                    above = middle
                else:
                    below = middle + 1
            place = below
        chosen[i] = population[keys[place] & mask]
        chosen_scores[i] = scores[keys[place] & mask]


@kernel(inner=True)
def choose_breeders(
    setting: NDArray[np.void],
    stream: Stream,
    words: NDArray[np.uint64],
    breeding: NDArray[np.int64],
) -> int:
    """Choose which parents breed.

    Parameters
    ----------
    setting : SETTINGS
        Settings; `breeders` of the parents, each set as likely as any other, or with 0 each
        parent with the probability of crossover, drawn again where fewer than two would.
    stream : (4,) uint64
        Random stream, advanced in place.
    words : (parents,) uint64
        Overwritten.
    breeding : (parents,) int64
        Overwritten with the numbers of those that breed.

    Returns
    -------
    int
        How many breed.
    """
    parents, breeders = setting["parents"], setting["breeders"]
    if breeders > 0:
        for i in range(parents):
            breeding[i] = i
        if breeders < parents:
            fill(stream, words)
            for i in range(breeders):
                j = i + high(words[i], parents - i)
                breeding[i], breeding[j] = breeding[j], breeding[i]
        return breeders
    count = 0
    while count < 2:
        fill(stream, words)
        count = 0
        for i in range(parents):
            if happens(words[i], setting["crossover_threshold"]):
                breeding[count] = i
                count += 1
    return count


@kernel(inner=True)
def cross_and_mutate(
    population: NDArray[np.int32],
    a: int,
    b: int,
    child: int,
    points: int,
    setting: NDArray[np.void],
    words: NDArray[np.uint64],
) -> None:
    """Make two children by uniform crossover, and mutate both.

    A mutated gene of the first child is any point; one of the second lies between its parents'
    indices, the greater one left out unless `middle_includes_end`, and is any point where the
    parents agree.

    Parameters
    ----------
    population : (P, genes) int32
        Holds the parents; the children are written into rows `child` and `child` + 1.
    a, b : int
        Rows of the parents.
    child : int
        Row of the first child.
    points : int
        Number of points.
    setting : SETTINGS
        Settings.
    words : (3 genes,) uint64
        Words of the stream.
    """
    genes = population.shape[1]
    for gene in range(genes):
        one, other = population[a, gene], population[b, gene]
        swap = words[gene] & np.uint64(1)
        population[child, gene] = other if swap else one
        population[child + 1, gene] = one if swap else other
        anywhere = words[genes + gene]
        if happens(anywhere, setting["mutation_threshold"]):
            population[child, gene] = low(anywhere, points)
        between = words[2 * genes + gene]
        if happens(between, setting["mutation_threshold"]):
            least, span = np.int64(min(one, other)), np.int64(abs(one - other))
            if span == 0:
                least, span = np.int64(0), points
            elif setting["middle_includes_end"]:
                span += 1
            population[child + 1, gene] = least + low(between, span)
