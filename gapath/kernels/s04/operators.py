"""The operators of S04's genetic algorithm (Sec. IV), each for a whole population.

Each takes its random numbers as words drawn beforehand: what is drawn never depends on what
was drawn.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.rng import happens, high, low
from gapath.kernels.s04.genotype import SWITCHES, Chromosomes, Genotype

RUN = 8
"""Individuals that are sorted by insertion before runs are merged."""


class Parents(NamedTuple):
    """Of whom P children are made."""

    head: NDArray[np.int32]
    """(P,) the parent of their first part, of their flag and of their switches."""
    tail: NDArray[np.int32]
    """(P,) the parent of the rest."""
    cut: NDArray[np.int32]
    """(P,) the first gene of the rest; n for none."""


@kernel
def rank(values: NDArray[np.float64], order: NDArray[np.int64], spare: NDArray[np.int64]) -> None:
    """Sort individuals by falling fitness, the lower index first among equals.

    In a population that has converged most are as fit as the fittest: these come first without
    being compared. The others are sorted in runs, and runs are merged: stable, and the same on
    every machine.

    Parameters
    ----------
    values : (P,) float64
        Fitness.
    order : (P,) int64
        Overwritten with the indices, the fittest first.
    spare : (P,) int64
        Overwritten.
    """
    best = values.max()
    fittest = 0
    for i in range(values.shape[0]):
        if values[i] == best:
            order[fittest] = i
            fittest += 1
    at = fittest
    for i in range(values.shape[0]):
        if values[i] != best:
            order[at] = i
            at += 1
    rest = order[fittest:]
    size = rest.shape[0]
    for begin in range(0, size, RUN):
        for i in range(begin + 1, min(begin + RUN, size)):
            individual, at = rest[i], i
            while at > begin and values[rest[at - 1]] < values[individual]:
                rest[at] = rest[at - 1]
                at -= 1
            rest[at] = individual
    run = RUN
    while run < size:
        for begin in range(0, size - run, 2 * run):
            _merge(values, rest, begin, begin + run, min(begin + 2 * run, size), spare)
        run *= 2


@kernel(inner=True)
def _merge(
    values: NDArray[np.float64],
    order: NDArray[np.int64],
    begin: int,
    middle: int,
    end: int,
    spare: NDArray[np.int64],
) -> None:
    """Merge two sorted runs, from begin and from middle; what is in its place stays there."""
    while begin < middle and values[order[begin]] >= values[order[middle]]:
        begin += 1
    left = middle - begin
    for k in range(left):
        spare[k] = order[begin + k]
    a, b = 0, middle
    for at in range(begin, end):
        if a == left:  # what follows is in its place
            return
        if b == end or values[spare[a]] >= values[order[b]]:
            order[at] = spare[a]
            a += 1
        else:
            order[at] = order[b]
            b += 1


@kernel
def holder(ticket: int, order: NDArray[np.int64]) -> int:
    """Rank selection: of P individuals the fittest holds P tickets, the last one (S04 Sec. IV.A).

    Parameters
    ----------
    ticket : int
        Drawn from P (P + 1) / 2.
    order : (P,) int64
        Individuals, the fittest first.

    Returns
    -------
    int
        Who holds it.
    """
    # tickets r (r + 1) / 2 to r (r + 1) / 2 + r are those of the last but r; the root is exact
    # where the ticket is the first of them, and never too large elsewhere
    last_but = np.int64((math.sqrt(8.0 * ticket + 1.0) - 1.0) / 2.0)
    return order[order.shape[0] - 1 - last_but]


@kernel
def pair(
    order: NDArray[np.int64],
    n: int,
    threshold: np.uint64,
    words: NDArray[np.uint64],
    parents: Parents,
) -> None:
    """Choose parents and cuts (S04 Secs IV.A, IV.B): the elite, then two children a pair.

    Parameters
    ----------
    order : (P,) int64
        Individuals, the fittest first.
    n : int
        Genes.
    threshold : uint64
        Probability of a crossover as `gapath.kernels.rng.probability_threshold` gives it; who does
        not cross is copied.
    words : (2, pairs) uint64
        Random words, one of each row for a pair; pairs is P / 2 rounded down.
    parents : Parents
        Overwritten. Child 0 is the fittest itself: elitism of one. Children 2 k + 1 and 2 k + 2
        are the two of pair k; of the last pair one may be too many.
    """
    size = order.shape[0]
    tickets = size * (size + 1) // 2
    parents.head[0] = parents.tail[0] = order[0]
    parents.cut[0] = n
    for k in range(words.shape[1]):
        a, b = holder(high(words[0, k], tickets), order), holder(low(words[0, k], tickets), order)
        cut = 1 + low(words[1, k], n - 1) if happens(words[1, k], threshold) else n
        for child in range(2 * k + 1, min(2 * k + 3, size)):
            parents.head[child], parents.tail[child], parents.cut[child] = a, b, cut
            a, b = b, a


@kernel
def cross(population: Chromosomes, parents: Parents, children: Chromosomes) -> None:
    """Single-point crossover with two complementary children (S04 Sec. IV.B).

    Location and direction are cut; the flag goes with the first part, the switches, which are
    not cut, too.

    Parameters
    ----------
    population : Chromosomes
        The parents' generation.
    parents : Parents
        Of each child.
    children : Chromosomes
        Overwritten.
    """
    head, tail, cut = parents
    n, size = children.location.shape
    for i in range(n):
        genes = population.location[i]
        for child in range(size):
            origin = head[child] if i < cut[child] else tail[child]
            children.location[i, child] = genes[np.uint32(origin)]
    for i in range(n - 1):
        genes = population.direction[i]
        for child in range(size):
            origin = head[child] if i < cut[child] else tail[child]
            children.direction[i, child] = genes[np.uint32(origin)]
    for child in range(size):
        children.flag[child] = population.flag[head[child]]
        for s in range(SWITCHES):
            children.switch[s, child] = population.switch[s, head[child]]


@kernel
def mutate(
    chromosomes: Chromosomes,
    first: int,
    genotype: Genotype,
    threshold: np.uint64,
    words: NDArray[np.uint64],
) -> None:
    """Draw genes anew, each with a probability (S04 Sec. IV.C).

    A gene that mutates gets a new location and direction, and its chromosome a new flag.

    Parameters
    ----------
    chromosomes : Chromosomes
        Changed in place.
    first : int
        Individuals before this one stay as they are.
    genotype : Genotype
        What may change.
    threshold : uint64
        The probability as `gapath.kernels.rng.probability_threshold` gives it; 2**32 draws all
        anew.
    words : (n + 2, P) uint64
        Random words, one a gene and one a switch.
    """
    n, size = chromosomes.location.shape
    one = np.uint64(1)
    for i in range(n + genotype.switches):
        drawn = words[i]
        for p in range(first, size):
            # nearly none happens, so a branch costs less than to draw for all and choose
            if not happens(drawn[p], threshold):
                continue
            new = np.int32(low(drawn[p], n))
            if i >= n:
                chromosomes.switch[i - n, p] = new
                continue
            chromosomes.location[i, p] = new
            if i < n - 1:
                chromosomes.direction[i, p] = np.int32(drawn[p] & one)
            if genotype.column_wise:
                chromosomes.flag[p] = np.int32((drawn[p] >> one) & one)
