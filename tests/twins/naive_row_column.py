"""Obvious slow twin of S04's genetic algorithm, written from its Secs III and IV.

Rows, columns and genes count from 0, in the paper from 1.
"""

import itertools
from dataclasses import dataclass

import naive


@dataclass
class Chromosome:
    """On n x n fields n locations, n - 1 directions (1 horizontal first) and two switches."""

    flag: int
    location: list
    direction: list
    switch: list

    @classmethod
    def of(cls, row):
        row = [int(gene) for gene in row]
        n = len(row) // 2 - 1
        return cls(row[0], row[1 : n + 1], row[n + 1 : 2 * n], row[2 * n :])

    @property
    def row(self):
        return [self.flag, *self.location, *self.direction, *self.switch]


def mirrored(weights, place):
    """Mirrors a problem into the paper's, whose robot goes right and down; and back."""
    (x, y), (u, v) = place
    rows, cols = weights.shape
    left, up = u < x, v < y

    def mirror(point):
        return (
            cols - 1 - point[0] if left else point[0],
            rows - 1 - point[1] if up else point[1],
        )

    weights = weights[:, ::-1] if left else weights
    return (weights[::-1] if up else weights), mirror


def vertices(chromosome, start, target):
    """Sec. III.C.2: a vertex in every row, or in every column, from start to target."""
    n = len(chromosome.location)
    if n == 1:
        return [start]
    column_wise, places = chromosome.flag == 1, [start]
    for gene in range(1, n - 1):
        if gene - 1 in chromosome.switch:  # takes effect after its vertex; two equal ones, once
            column_wise = not column_wise
        location = chromosome.location[gene]
        places.append((gene, location) if column_wise else (location, gene))
    return [*places, target]


def corners(chromosome, start, target):
    """Sec. III.C.3: between two vertices to the side and then up or down, or the other way."""
    places = vertices(chromosome, start, target)
    points = [start]
    for (x, y), (u, v), direction in zip(
        places[:-1], places[1:], chromosome.direction, strict=True
    ):
        points += [(u, y) if direction == 1 else (x, v), (u, v)]
    return points


def walk(points):
    """One field after the other; each piece is horizontal or vertical."""
    x, y = points[0]
    fields = [(x, y)]
    for u, v in points[1:]:
        while (x, y) != (u, v):
            x += (u > x) - (u < x)
            y += (v > y) - (v < y)
            fields.append((x, y))
    return fields


def measure(weights, fields):
    """Collisions and cost, length, turns."""
    steps = [(u - x, v - y) for (x, y), (u, v) in itertools.pairwise(fields)]
    turns = sum(before != step for before, step in itertools.pairwise(steps))
    return naive.fitness(weights, fields), len(steps), turns


def shares(values):
    """1 for the least of the population, 0 for the most; 1 if they are all the same."""
    least, most = min(values), max(values)
    return [(most - value) / (most - least) if most > least else 1.0 for value in values]


def fitness(measures, length_weight, turns_weight):
    """Sec. IV.A."""
    collisions = [found[0][0] for found in measures]
    f_collisions = shares(collisions)
    f_length = shares([found[1] for found in measures])
    f_turns = shares([found[2] for found in measures])
    values = []
    for i, number in enumerate(collisions):
        both = length_weight * f_length[i] + turns_weight * f_turns[i]
        f_path = f_collisions[i] * both * 100 / (length_weight + turns_weight)  # eq. (1)
        if number:
            f_path = 0.1 * f_path / number**2  # eq. (2)
        values.append(f_path)
    return values


def ranked(values):
    return sorted(range(len(values)), key=lambda i: (-values[i], i))


def tickets(order):
    """Rank selection: the last one holds one ticket, the fittest as many as there are."""
    return [i for held, i in enumerate(reversed(order), start=1) for _ in range(held)]


def crossed(head, tail, cut):
    """Sec. IV.B: the switches are not cut."""
    return Chromosome(
        head.flag,
        head.location[:cut] + tail.location[cut:],
        head.direction[:cut] + tail.direction[cut:],
        list(head.switch),
    )


def mutate(population, spared, probability, planner, words):
    """Sec. IV.C; the words come gene by gene, one for each individual."""
    n = len(population[0].location)
    for gene in range(n + 2):
        for i, chromosome in enumerate(population):
            word = words.take()
            if i < spared or not naive.happens(word, probability):
                continue
            if gene < n:
                chromosome.location[gene] = naive.low(word, n)
                if gene < n - 1:
                    chromosome.direction[gene] = word & 1
                if planner.column_wise:
                    chromosome.flag = word >> 1 & 1
            elif gene - n < planner.switches:
                chromosome.switch[gene - n] = naive.low(word, n)


def evolve(weights, start, target, planner, words):
    """S04 Sec. IV; returns a list of epochs."""
    n, size = max(weights.shape), planner.population
    weights, mirror = mirrored(weights, (start, target))
    start, target = mirror(start), mirror(target)

    population = [Chromosome(0, [0] * n, [0] * (n - 1), [n - 1, n - 1]) for _ in range(size)]
    mutate(population, 0, 1, planner, words)
    epochs = []
    while True:
        paths = [corners(chromosome, start, target) for chromosome in population]
        measures = [measure(weights, walk(path)) for path in paths]
        values = fitness(measures, planner.length_weight, planner.turns_weight)
        order = ranked(values)
        best = order[0]
        epochs.append(
            {
                "best": measures[best][0],
                "obstacles": sum(found[0][0] for found in measures),
                "cost": sum(found[0][1] for found in measures),
                "chromosome": population[best].row,
                "points": [mirror(point) for point in paths[best]],
            }
        )
        done = planner.stop_when_feasible and measures[best][0][0] == 0
        if done or len(epochs) == planner.max_epochs:
            return epochs

        pairs = size // 2
        for_parents = [words.take() for _ in range(pairs)]
        for_cuts = [words.take() for _ in range(pairs)]
        hat = tickets(order)
        children = [crossed(population[best], population[best], n)]
        for which, where in zip(for_parents, for_cuts, strict=True):
            a = population[hat[naive.high(which, len(hat))]]
            b = population[hat[naive.low(which, len(hat))]]
            crosses = naive.happens(where, planner.crossover_probability)
            cut = 1 + naive.low(where, n - 1) if crosses else n
            children += [crossed(a, b, cut), crossed(b, a, cut)]
        population = children[:size]
        mutate(population, 1, planner.mutation_probability, planner, words)
