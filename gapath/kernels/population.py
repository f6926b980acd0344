"""The operators of KG18's genetic algorithm (Secs 3.3, 3.5-3.7), one function each.

Each takes its random numbers as words drawn beforehand, one word for each gene, and one
for each pair of parents: what is drawn never depends on what was drawn.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath._jit import kernel
from gapath.kernels.raster import COORDINATE_LIMIT
from gapath.rng import happens, high, low


class Ends(NamedTuple):
    """Start and target fields."""

    start_x: int
    start_y: int
    target_x: int
    target_y: int


class InitialPopulation(NamedTuple):
    """Settings of the initial population (KG18 Sec. 3.3)."""

    line_jitter: int
    line_jitter_threshold: np.uint64
    neighbourhood: int
    margin: int


@kernel
def clip(gene: int, side: int, clip_to_map: bool) -> int:
    """Keep a gene on the map, or at least within what the raster can count."""
    if clip_to_map:
        return min(max(gene, 0), side - 1)
    return min(max(gene, -COORDINATE_LIMIT), COORDINATE_LIMIT)


@kernel
def gene_limits(
    limits: NDArray[np.int32], ends: Ends, genes: int, rows: int, cols: int, clip_to_map: bool
) -> None:
    """Give the range of every gene; start and target have no choice.

    Parameters
    ----------
    limits : (2, n) int32
        Overwritten with the least and the greatest value of each gene; n >= 2 k.
    ends : Ends
        First and last control point.
    genes : int
        2 k; what follows stays 0.
    rows, cols : int
        Size of the map.
    clip_to_map : bool
        Keep genes on the map.
    """
    limits[:] = 0
    for g in range(0, genes, 2):
        for bound in range(2):
            far = (2 * bound - 1) * COORDINATE_LIMIT
            limits[bound, g] = clip(far, cols, clip_to_map)
            limits[bound, g + 1] = clip(far, rows, clip_to_map)
    for bound in range(2):
        limits[bound, 0], limits[bound, 1] = ends.start_x, ends.start_y
        limits[bound, genes - 2], limits[bound, genes - 1] = ends.target_x, ends.target_y


@kernel
def initialise(
    population: NDArray[np.int32],
    ends: Ends,
    rows: int,
    cols: int,
    limits: NDArray[np.int32],
    settings: InitialPopulation,
    words: NDArray[np.uint64],
) -> None:
    """Fill the initial population, one third each in three ways (KG18 Sec. 3.3).

    Individual i of P belongs to part 3 i // P: (0) the straight line from start to target
    in k - 1 equal segments, each inner coordinate changed with a fixed probability;
    (1) inner points around the start; (2) inner points all over the map.

    Parameters
    ----------
    population : (P, 2 k) int32
        Overwritten.
    ends : Ends
        First and last control point of every individual.
    rows, cols : int
        Size of the map.
    limits : (2, n) int32
        `gene_limits`.
    settings : InitialPopulation
        Ranges and probability.
    words : (P * (2 k - 4),) uint64
        Random words, one for each inner gene.
    """
    size, genes = population.shape
    segments = genes // 2 - 1
    start = (ends.start_x, ends.start_y)
    target = (ends.target_x, ends.target_y)
    sides = (cols, rows)
    line = np.empty(genes, dtype=np.int64)
    for g in range(genes):
        axis = g % 2
        d = target[axis] - start[axis]
        line[g] = start[axis] + (2 * (g // 2) * d + segments) // (2 * segments)
    reach, jitter = settings.neighbourhood, settings.line_jitter
    w = 0
    for i in range(size):
        part = 3 * i // size
        population[i] = line
        for g in range(2, genes - 2):
            axis = g % 2
            word = words[w]
            w += 1
            if part == 0:
                gene = line[g]
                if happens(word, settings.line_jitter_threshold):
                    gene += low(word, 2 * jitter + 1) - jitter
            elif part == 1:
                gene = start[axis] + high(word, 2 * reach + 1) - reach
            else:
                margin = min(settings.margin, (sides[axis] - 1) // 2)
                gene = margin + high(word, sides[axis] - 2 * margin)
            population[i, g] = min(max(gene, np.int64(limits[0, g])), np.int64(limits[1, g]))


@kernel
def rank_best(keys: NDArray[np.int64], best: NDArray[np.int64]) -> None:
    """Rank selection: find the fittest, in order (KG18 Sec. 3.5).

    Parameters
    ----------
    keys : (P,) int64
        Fitness of every individual; smaller is fitter, ties go to the lower index.
    best : (Q,) int64
        Overwritten with the indices of the Q fittest.
    """
    count = 0
    for i in range(keys.shape[0]):
        key = keys[i]
        if count < best.shape[0]:
            count += 1
        elif key >= keys[best[count - 1]]:
            continue
        at = count - 1
        while at > 0 and keys[best[at - 1]] > key:
            best[at] = best[at - 1]
            at -= 1
        best[at] = i


@kernel
def cross(
    fitter: NDArray[np.int32],
    other: NDArray[np.int32],
    child: NDArray[np.int32],
    mixing: tuple[int, int],
) -> None:
    """Arithmetical crossover (KG18 eq. (6)), rounded half up.

    A multiple of 1 / (2 d) is lifted by 1 / (4 d) before its floor is taken, as the way points
    are (`gapath.kernels.bspline`): exact, and faster than a division of integers.

    Parameters
    ----------
    fitter, other : (n,) int32
        The parents.
    child : (n,) int32
        Overwritten.
    mixing : (int, int)
        The coefficient D as numerator and denominator d.
    """
    numerator, denominator = mixing
    share, rest = numerator / denominator, (denominator - numerator) / denominator
    rounding = 0.5 + 0.25 / denominator
    for g in range(child.shape[0]):
        child[g] = np.int32(np.floor(share * fitter[g] + rest * other[g] + rounding))


@kernel
def mutate(
    child: NDArray[np.int32],
    limits: NDArray[np.int32],
    half: int,
    threshold: np.uint64,
    words: NDArray[np.uint64],
) -> None:
    """Add to each gene, with a probability, an integer in [-h/2, h/2] (KG18 Sec. 3.7).

    Parameters
    ----------
    child : (n,) int32
        Changed in place.
    limits : (2, n) int32
        `gene_limits`: genes of start and target, and those outside the map, move back.
    half : int
        h / 2, rounded down; h is the smaller side of the map.
    threshold : uint64
        The probability as `gapath.rng.probability_threshold` gives it.
    words : (n,) uint64
        Random words, one for each gene.
    """
    least, greatest = limits[0], limits[1]
    for g in range(child.shape[0]):
        change = low(words[g], 2 * half + 1) - half if happens(words[g], threshold) else 0
        gene = np.int64(child[g]) + change
        child[g] = min(max(gene, np.int64(least[g])), np.int64(greatest[g]))
