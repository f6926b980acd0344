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
def initialise(
    population: NDArray[np.int32],
    ends: Ends,
    rows: int,
    cols: int,
    clip_to_map: bool,
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
    clip_to_map : bool
        Move genes outside the map to its border.
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
    w = 0
    for i in range(size):
        part = 3 * i // size
        for axis in range(2):
            population[i, axis] = start[axis]
            population[i, genes - 2 + axis] = target[axis]
        for g in range(2, genes - 2):
            axis = g % 2
            side = sides[axis]
            word = words[w]
            w += 1
            if part == 0:
                d = target[axis] - start[axis]
                gene = start[axis] + (2 * (g // 2) * d + segments) // (2 * segments)
                if happens(word, settings.line_jitter_threshold):
                    gene += low(word, 2 * settings.line_jitter + 1) - settings.line_jitter
            elif part == 1:
                reach = settings.neighbourhood
                gene = start[axis] + high(word, 2 * reach + 1) - reach
            else:
                margin = min(settings.margin, (side - 1) // 2)
                gene = margin + high(word, side - 2 * margin)
            population[i, g] = clip(gene, side, clip_to_map)


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

    Parameters
    ----------
    fitter, other : (2 k,) int32
        The parents.
    child : (2 k,) int32
        Overwritten.
    mixing : (int, int)
        The coefficient D as numerator and denominator.
    """
    numerator, denominator = mixing
    for g in range(child.shape[0]):
        total = numerator * np.int64(fitter[g]) + (denominator - numerator) * np.int64(other[g])
        child[g] = (2 * total + denominator) // (2 * denominator)


@kernel
def mutate(
    child: NDArray[np.int32],
    rows: int,
    cols: int,
    clip_to_map: bool,
    threshold: np.uint64,
    words: NDArray[np.uint64],
) -> None:
    """Add to each inner gene, with a probability, an integer in [-h/2, h/2] (KG18 Sec. 3.7).

    Parameters
    ----------
    child : (2 k,) int32
        Changed in place; the first two and last two genes stay.
    rows, cols : int
        Size of the map; h is the smaller side.
    clip_to_map : bool
        Move genes outside the map to its border.
    threshold : uint64
        The probability as `gapath.rng.probability_threshold` gives it.
    words : (2 k - 4,) uint64
        Random words, one for each inner gene.
    """
    half = min(rows, cols) // 2
    sides = (cols, rows)
    for g in range(2, child.shape[0] - 2):
        word = words[g - 2]
        gene = np.int64(child[g])
        if happens(word, threshold):
            gene += low(word, 2 * half + 1) - half
        child[g] = clip(gene, sides[g % 2], clip_to_map)
