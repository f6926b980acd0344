"""Obvious slow twins of M22's planner, written from its Sec. II and the description of its library.

The library is geneticalgorithm2, whose generations differ by version: v64 (up to 6.6.0), v67
(6.7), v69 (6.8 on).
"""

import itertools
from fractions import Fraction
from math import ceil, floor, isqrt

import naive
import numpy as np

SCALE = 65536


def radius(robot_radius, tolerance="0.1", resolution="1"):
    """Eq. (1) with decimal numbers, in pixels."""
    metres = Fraction(robot_radius)
    return ceil((metres + metres * Fraction(tolerance)) / Fraction(resolution))


def dilated(picture, growth):
    """Every pixel asks all pixels of the square around it."""
    rows, cols = picture.shape
    grown = np.zeros_like(picture)
    for y, x in itertools.product(range(rows), range(cols)):
        grown[y, x] = any(
            picture[v, u]
            for v in range(max(y - growth, 0), min(y + growth + 1, rows))
            for u in range(max(x - growth, 0), min(x + growth + 1, cols))
        )
    return grown


def nearest_free(picture, place):
    """The nearest by its distance, then from top and from left."""
    rows, cols = picture.shape
    free = [(x, y) for y in range(rows) for x in range(cols) if not picture[y, x]]
    x, y = place
    return min(free, key=lambda p: ((p[0] - x) ** 2 + (p[1] - y) ** 2, p[1], p[0]), default=None)


def line_is_free(picture, a, b, rule="allow"):
    """Eq. (4): draw the line in black into a copy and compare all pixels; then the corners."""
    fields = naive.polyline([a, b])
    copy = picture.copy()
    for x, y in fields:
        copy[y, x] = False
    if (picture ^ copy).any():
        return False
    steps = itertools.pairwise(fields)
    return not any(naive.forbidden(picture, *step, rule) for step in steps)


def line_length(a, b):
    """The Euclidean length in units of 1 / SCALE pixels, rounded up."""
    square = ((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) * SCALE**2
    return isqrt(square) + (isqrt(square) ** 2 < square)


def graph_lengths(picture, points, rule="allow"):
    """Lengths between all points; None where the line is not free."""
    return [
        [line_length(a, b) if line_is_free(picture, a, b, rule) else None for b in points]
        for a in points
    ]


def shortest(lengths):
    """Length of the shortest way from the first point to the second; None if there is none."""
    n = len(lengths)
    far = float("inf")
    way = [[far if length is None else length for length in row] for row in lengths]
    way[0][0] = 0
    for k, i, j in itertools.product(range(n), repeat=3):
        way[i][j] = min(way[i][j], way[i][k] + way[k][j])
    return None if way[0][1] == far else way[0][1]


def path_length(lengths, chromosome, ends_are_genes):
    """Eqs (6) to (8): None where a restriction is broken."""
    start, end = 0, 1
    if not ends_are_genes:
        chromosome = [start, *chromosome, end]
    if chromosome[0] != start or end not in chromosome:
        return None
    m = chromosome.index(end)  # eq. (6)
    pieces = [lengths[a][b] for a, b in itertools.pairwise(chromosome[: m + 1])]
    if ends_are_genes and lengths[start][start] is None:
        return None
    return None if None in pieces else sum(pieces)  # eq. (7)


def sizes(planner):
    """Elite, and parents that stay: as many more as make the children come in pairs."""
    elite = ceil(planner.population * planner.elite_portion)
    if planner.ga2_profile == "v64" and elite > 1:
        elite = floor(planner.population * planner.elite_portion)
    parents = floor(planner.population * planner.parents_portion)
    if (planner.population - parents) % 2:
        parents += 1
    return elite, parents


def spin(wheel, word):
    """Where the ball stops on a wheel with places of these widths."""
    ball = word % sum(wheel)
    for place, width in enumerate(wheel):
        if ball < width:
            return place
        ball -= width
    raise AssertionError


def roulette(ranked, elite, parents, version, words):
    """The elite, then by fitness, with replacement; later versions leave the elite out."""
    drawn = [words.take() for _ in range(parents)]
    candidates = ranked if version == "v64" else ranked[elite:]
    worst = ranked[-1][0]
    wheel = [worst + SCALE - score for score, _ in candidates]  # a pixel more than the worst
    return ranked[:elite] + [candidates[spin(wheel, word)] for word in drawn[elite:]]


def breeders(parents, version, probability, words):
    """Those that breed: by chance, exactly so many, or all."""
    if version == "v69":
        return parents
    if version == "v64":
        while True:
            drawn = [words.take() for _ in parents]
            some = [p for p, word in zip(parents, drawn, strict=True) if happens(word, probability)]
            if len(some) >= 2:
                return some
    count = max(2, floor(len(parents) * probability))
    if count == len(parents):
        return parents
    drawn = [words.take() for _ in parents]
    rest, some = list(parents), []
    for word in drawn[:count]:  # the first of the rest takes the place of the one drawn
        i = naive.high(word, len(rest))
        rest[0], rest[i] = rest[i], rest[0]
        some.append(rest.pop(0))
    return some


happens = naive.happens


def children(one, other, points, version, probability, words):
    """Uniform crossover; the first child mutates to anything, the second to between its parents."""
    genes = len(one)
    swap, anywhere, between = ([words.take() for _ in range(genes)] for _ in range(3))
    first, second = [], []
    for i in range(genes):
        a, b = (other[i], one[i]) if swap[i] % 2 else (one[i], other[i])
        if happens(anywhere[i], probability):
            a = naive.low(anywhere[i], points)
        if happens(between[i], probability):
            values = range(min(one[i], other[i]), max(one[i], other[i]) + (version != "v64"))
            if one[i] == other[i]:
                values = range(points)
            b = values[naive.low(between[i], len(values))]
        first.append(a)
        second.append(b)
    return first, second


def evolve(lengths, planner, genes, penalty, words):
    """Table I; returns a list of epochs and the number of evaluations."""
    points, version = len(lengths), planner.ga2_profile
    elite, kept = sizes(planner)
    ends_are_genes = planner.genes == "obstacles_and_ends"

    def scored(chromosome):
        length = path_length(lengths, chromosome, ends_are_genes)
        return (penalty if length is None else length), chromosome

    drawn = points - 1 if version == "v64" else points  # up to 6.6.0 never the last point at first
    population = [
        scored([naive.high(words.take(), drawn) for _ in range(genes)])
        for _ in range(planner.population)
    ]
    evaluations = planner.population
    scores = [score for score, _ in population]
    best = scores[-1] if version == "v64" else min(scores)
    stale, epochs = 0, []
    while True:
        population.sort(key=lambda individual: individual[0])
        score, chromosome = population[0]
        total = sum(score for score, _ in population)
        epochs.append({"best": score, "sum": total, "chromosome": chromosome})
        patience = planner.max_stagnation is None or stale <= planner.max_stagnation
        better = score < best
        if len(epochs) == planner.max_epochs:
            return epochs, evaluations
        if not patience and not (better and version == "v64"):  # up to 6.6.0 children can save it
            return epochs, evaluations
        stale = 0 if better else stale + 1
        best = min(best, score)

        parents = roulette(population, elite, kept, version, words)
        breeding = breeders(parents, version, planner.crossover_probability, words)
        pairs = [words.take() for _ in range((planner.population - kept) // 2)]
        population = parents
        for word in pairs:
            a = naive.high(word, len(breeding))
            if version == "v64":
                b = naive.low(word, len(breeding))
            else:
                b = [i for i in range(len(breeding)) if i != a][naive.low(word, len(breeding) - 1)]
            both = children(
                breeding[a][1],
                breeding[b][1],
                points,
                version,
                planner.mutation_probability,
                words,
            )
            population = population + [scored(child) for child in both]
            evaluations += 2
