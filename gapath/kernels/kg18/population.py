"""The operators of KG18's genetic algorithm (Secs 3.3, 3.5-3.7).

Each takes its random numbers as words drawn beforehand, one word for each gene, and one
for each pair of parents: what is drawn never depends on what was drawn.

Matrices have a chromosome a row, as `gapath.kernels.kg18.lanes.chromosome_matrix` makes them: what
follows the last gene is there for whole vectors and means nothing.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.kg18.lanes import GENES, Way, vary_genes
from gapath.kernels.lines import Ends
from gapath.kernels.raster import COORDINATE_LIMIT
from gapath.kernels.rng import happens, low


class InitialPopulation(NamedTuple):
    """Ranges of the initial population (KG18 Sec. 3.3)."""

    line_jitter: int
    neighbourhood: int
    margin: int


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
        2 k; what follows is left alone.
    rows, cols : int
        Size of the map.
    clip_to_map : bool
        Keep genes on the map, not only within what the raster can count.
    """
    for g in range(genes):
        side = rows if g % 2 else cols
        limits[0, g] = 0 if clip_to_map else -COORDINATE_LIMIT
        limits[1, g] = side - 1 if clip_to_map else COORDINATE_LIMIT
    for bound in range(2):
        limits[bound, 0], limits[bound, 1] = ends.start_x, ends.start_y
        limits[bound, genes - 2], limits[bound, genes - 1] = ends.target_x, ends.target_y


class Mixing(NamedTuple):
    """Arithmetical crossover (KG18 eq. (6)): D of the fitter parent, the rest of the other.

    A multiple of 1 / d, d being D's denominator, is lifted by 1 / (4 d) before its floor is
    taken, as the way points are (`gapath.kernels.kg18.bspline`): exact, rounded half up.
    """

    share: float
    rest: float
    rounding: float


@kernel(inner=True)
def changed(
    gene: int,
    g: int,
    word: np.uint64,
    shift: int,
    threshold: np.uint64,
    changes: NDArray[np.int32],
    limits: NDArray[np.int32],
) -> int:
    """Change a gene at random, and keep it within its limits (KG18 Sec. 3.7).

    Parameters
    ----------
    gene : int
        The gene, crossed.
    g : int
        Its number.
    word : uint64
        Its random word.
    shift, threshold, changes, limits
        As of `vary`.

    Returns
    -------
    int
        The gene of the child.
    """
    if happens(word, threshold):
        values = np.int64(changes[0, g])
        gene += low(word >> np.uint64(shift), values) - changes[1, g]
    return min(max(gene, np.int64(limits[0, g])), np.int64(limits[1, g]))


@kernel
def vary(
    way: Way,
    parents: NDArray[np.int32],
    fitter: int,
    other: int,
    mixing: Mixing,
    words: NDArray[np.uint64],
    first: int,
    shift: int,
    threshold: np.uint64,
    changes: NDArray[np.int32],
    limits: NDArray[np.int32],
    children: NDArray[np.int32],
    child: int,
    genes: int,
) -> None:
    """Make the inner genes of a child: cross two parents, and change genes at random.

    Parameters
    ----------
    way : None or True
        `SIDE_BY_SIDE` or `ONE_BY_ONE`; the child is the same.
    parents : (n, m) int32
        A chromosome a row.
    fitter, other : int
        Rows of the parents.
    mixing : Mixing
        How they are crossed.
    words : (p,) uint64
        Random words; p >= first + 2 k - 4 + GENES.
    first : int
        The word of the first inner gene.
    shift : int
        0 to draw the change from a word's lower half, 32 for its upper one.
    threshold : uint64
        The probability of a change, as `gapath.kernels.rng.probability_threshold` gives it; it is
        decided by the upper half.
    changes : (2, m) int32
        For each gene: how many values the change has, and how far below 0 the least one is.
    limits : (2, m) int32
        `gene_limits`: a gene beyond moves to them.
    children : (q, m) int32
        Row `child` is overwritten, but for start and target.
    child : int
        The row.
    genes : int
        2 k.
    """
    if way is None:
        for g in range(2, genes - 2, GENES):
            vary_genes(
                parents,
                fitter,
                other,
                mixing.share,
                mixing.rest,
                mixing.rounding,
                words,
                first + g - 2,
                shift,
                threshold,
                changes,
                limits,
                children,
                child,
                g,
            )
    else:
        for g in range(2, genes - 2):
            mixed = mixing.share * parents[fitter, g] + mixing.rest * parents[other, g]
            gene = np.int64(np.floor(mixed + mixing.rounding))
            word = words[first + g - 2]
            children[child, g] = changed(gene, g, word, shift, threshold, changes, limits)


@kernel
def initial_changes(
    middle: NDArray[np.int32],
    changes: NDArray[np.int32],
    ends: Ends,
    genes: int,
    rows: int,
    cols: int,
    settings: InitialPopulation,
) -> None:
    """Say how each third of the initial population is drawn (KG18 Sec. 3.3).

    Individual i of P belongs to part 3 i // P: (0) the straight line from start to target
    in k - 1 equal segments, each inner coordinate changed with a fixed probability;
    (1) inner points around the start; (2) inner points all over the map.

    Parameters
    ----------
    middle : (3, n) int32
        Overwritten, part by part, with what each gene is a change of; n >= 2 k.
    changes : (3, 2, n) int32
        Overwritten with how many values the change has, and how far below 0 the least one is.
    ends : Ends
        First and last control point of every individual.
    genes : int
        2 k; start, target and what follows are overwritten with 0.
    rows, cols : int
        Size of the map.
    settings : InitialPopulation
        Ranges.
    """
    segments = genes // 2 - 1
    middle[:], changes[:] = 0, 0
    for g in range(2, genes - 2):
        start, target, side = (
            (ends.start_y, ends.target_y, rows) if g % 2 else (ends.start_x, ends.target_x, cols)
        )
        d = target - start
        middle[0, g] = start + (2 * (g // 2) * d + segments) // (2 * segments)
        changes[0, 0, g] = 2 * settings.line_jitter + 1
        changes[0, 1, g] = settings.line_jitter
        middle[1, g] = start
        changes[1, 0, g] = 2 * settings.neighbourhood + 1
        changes[1, 1, g] = settings.neighbourhood
        margin = min(settings.margin, (side - 1) // 2)
        middle[2, g] = margin
        changes[2, 0, g] = side - 2 * margin


@kernel
def initialise(
    way: Way,
    population: NDArray[np.int32],
    size: int,
    limits: NDArray[np.int32],
    middle: NDArray[np.int32],
    changes: NDArray[np.int32],
    line_jitter_threshold: np.uint64,
    words: NDArray[np.uint64],
) -> None:
    """Fill the initial population, one third each in three ways (KG18 Sec. 3.3).

    Parameters
    ----------
    way : None or True
        As of `vary`.
    population : (n, m) int32
        The first P rows are overwritten, but for start and target.
    size : int
        P.
    limits : (2, m) int32
        `gene_limits`.
    middle, changes : (3, m) and (3, 2, m) int32
        `initial_changes`.
    line_jitter_threshold : uint64
        The probability of a change of the straight line, as of `vary`.
    words : (P * (2 k - 4) + GENES,) uint64
        Random words, one for each inner gene.
    """
    inner = (words.shape[0] - GENES) // size
    i = np.int64(0)
    for part in range(3):
        while i < size and 3 * i // size == part:
            vary(
                way,
                middle,
                part,
                part,
                Mixing(1.0, 0.0, 0.5),
                words,
                i * inner,
                32 if part > 0 else 0,
                np.uint64(1 << 32) if part > 0 else line_jitter_threshold,
                changes[part],
                limits,
                population,
                i,
                inner + 4,
            )
            i += 1


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
