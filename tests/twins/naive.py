"""Obvious slow twins, written from the papers' equations; the oracles of the tests."""

import heapq
import itertools
from fractions import Fraction
from math import floor

import numpy as np

VLN = 100_000


class Words:
    """NumPy's own SFC64, keyed by its three seed words; one 64-bit word at a time."""

    def __init__(self, seed, trial=0, call=0):
        self.generator = np.random.SFC64()
        state = self.generator.state
        state["state"]["state"] = np.array([seed, trial, call, 1], dtype=np.uint64)
        self.generator.state = state
        self.generator.random_raw(12)

    def take(self):
        return int(self.generator.random_raw())


def high(word, n):
    return (word >> 32) * n >> 32


def low(word, n):
    return (word & 0xFFFFFFFF) * n >> 32


def happens(word, probability):
    return (word >> 32) < floor(probability * 2**32)


def half_up(value):
    return floor(value + Fraction(1, 2))


def half_up_ratio(a, b):
    """`half_up` of a / b, which is floor((2 a + b) / 2 b), without making a fraction of it."""
    return (2 * a + b) // (2 * b)


def curve_point(points, u):
    """De Boor's corner cutting on the clamped, equidistant knots of eq. (2)."""
    k = len(points)
    spans = k - 2
    knots = [0, 0] + [Fraction(j, spans) for j in range(spans + 1)] + [1, 1]
    span = max(i for i in range(2, k) if knots[i] <= u)
    d = [[Fraction(c) for c in points[span - 2 + j]] for j in range(3)]
    for r in (1, 2):
        for j in range(2, r - 1, -1):
            left, right = knots[span - 2 + j], knots[span + 1 + j - r]
            a = (u - left) / (right - left)
            d[j] = [(1 - a) * p + a * q for p, q in zip(d[j - 1], d[j], strict=True)]
    return d[2]


def way_points(chromosome, samples=5, per_span=False):
    points = [tuple(map(int, chromosome[i : i + 2])) for i in range(0, len(chromosome), 2)]
    pieces = (samples - 1) * (len(points) - 2 if per_span else 1)
    curve = (curve_point(points, Fraction(j, pieces)) for j in range(pieces + 1))
    return [(half_up(x), half_up(y)) for x, y in curve]


def polyline(points):
    fields = [points[0]]
    for (x0, y0), (x1, y1) in itertools.pairwise(points):
        n = max(abs(x1 - x0), abs(y1 - y0))
        for i in range(1, n + 1):
            x, y = x0 + half_up_ratio(i * (x1 - x0), n), y0 + half_up_ratio(i * (y1 - y0), n)
            fields.append((x, y))
    return fields


def is_obstacle(weights, x, y):
    rows, cols = weights.shape
    return not (0 <= x < cols and 0 <= y < rows) or bool(weights[y, x] == 1)


def forbidden(weights, a, b, rule):
    (x0, y0), (x1, y1) = a, b
    if rule == "allow" or x0 == x1 or y0 == y1:
        return False
    if rule == "no_diagonals":
        return True
    sides = is_obstacle(weights, x1, y0) + is_obstacle(weights, x0, y1)
    return sides == 2 or (rule == "forbid" and sides == 1)


def fitness(weights, fields, rule="allow"):
    """Obstacle fields and cost in units of 1 / 65536; eq. (5) is VLN times one plus the other."""
    obstacles, cost = 0, 0
    for i, (x, y) in enumerate(fields):
        if is_obstacle(weights, x, y):
            obstacles += 1
        else:
            cost += floor(weights[y, x] * 65536 + 0.5)
        if i and forbidden(weights, fields[i - 1], fields[i], rule):
            obstacles += 1
    return min(obstacles, 2**19 - 1), cost


def evolve(weights, start, target, planner, words, rule="allow"):
    """KG18 Sec. 3 as written; returns a list of epochs and the number of evaluations."""
    rows, cols = weights.shape
    p, k = planner.population, planner.control_points
    inner = range(2, 2 * k - 2)

    def clip(gene, side):
        return min(max(gene, 0), side - 1) if planner.clip_to_map else gene

    population = []
    for i in range(p):
        genes = [*start, *[0] * (2 * k - 4), *target]
        for g in inner:
            word, axis = words.take(), g % 2
            side = (cols, rows)[axis]
            if 3 * i // p == 0:
                genes[g] = half_up(
                    start[axis] + Fraction((g // 2) * (target[axis] - start[axis]), k - 1)
                )
                if happens(word, planner.line_jitter_probability):
                    genes[g] += low(word, 2 * planner.line_jitter + 1) - planner.line_jitter
            elif 3 * i // p == 1:
                reach = planner.neighbourhood
                genes[g] = start[axis] - reach + high(word, 2 * reach + 1)
            else:
                margin = min(planner.margin, (side - 1) // 2)
                genes[g] = margin + high(word, side - 2 * margin)
            genes[g] = clip(genes[g], side)
        population.append(genes)

    def evaluate(genes):
        points = way_points(genes, planner.way_points, planner.sampling == "span")
        return fitness(weights, polyline(points), rule)

    scores = [evaluate(genes) for genes in population]
    evaluations = p
    epochs = []
    while True:
        order = sorted(range(p), key=lambda i: (scores[i], i))
        epochs.append(
            {
                "best": scores[order[0]],
                "obstacles": sum(s[0] for s in scores),
                "cost": sum(s[1] for s in scores),
                "chromosome": population[order[0]],
            }
        )
        done = scores[order[0]][0] == 0 and len(epochs) >= planner.min_epochs
        if done or len(epochs) == planner.max_epochs:
            return epochs, evaluations
        selected = order[: p // 4]
        children = []
        while len(children) < p - len(selected):
            word = words.take()
            a = selected[high(word, len(selected))]
            b = selected[low(word, len(selected))]
            if scores[a] >= scores[b]:
                a, b = b, a
            share = Fraction(str(planner.mixing))
            child = [
                half_up(share * x + (1 - share) * y)
                for x, y in zip(population[a], population[b], strict=True)
            ]
            for g in inner:
                word = words.take()
                if happens(word, planner.mutation_probability):
                    half = min(rows, cols) // 2
                    child[g] += low(word, 2 * half + 1) - half
                child[g] = clip(child[g], (cols, rows)[g % 2])
            children.append(child)
        population = [population[i] for i in selected] + children
        scores = [scores[i] for i in selected] + [evaluate(child) for child in children]
        evaluations += len(children)


def fewest_fields(weights, start, target, rule="allow"):
    """Dijkstra by cost, then by number of fields; both of the best path, or None."""
    queue, done = [(floor(weights[start[1], start[0]] * 65536 + 0.5), 1, start)], set()
    while queue:
        cost, fields, (x, y) = heapq.heappop(queue)
        if (x, y) == target:
            return cost / 65536, fields
        if (x, y) in done:
            continue
        done.add((x, y))
        for dx, dy in itertools.product((-1, 0, 1), repeat=2):
            place = (x + dx, y + dy)
            if not (is_obstacle(weights, *place) or forbidden(weights, (x, y), place, rule)):
                entry = floor(weights[place[1], place[0]] * 65536 + 0.5)
                heapq.heappush(queue, (cost + entry, fields + 1, place))
    return None


def shortest_cost(weights, start, target, rule="allow"):
    """Bellman's equation, swept until nothing changes; infinite if there is no path."""
    _rows, _cols = weights.shape
    cost = {start: floor(weights[start[1], start[0]] * 65536 + 0.5)}
    frontier = [start]
    while frontier:
        following = []
        for x, y in frontier:
            for dx in (-1, 0, 1):
                for dy in (-1, 0, 1):
                    place = (x + dx, y + dy)
                    if is_obstacle(weights, *place) or forbidden(weights, (x, y), place, rule):
                        continue
                    through = cost[x, y] + floor(weights[place[1], place[0]] * 65536 + 0.5)
                    if through < cost.get(place, float("inf")):
                        cost[place] = through
                        following.append(place)
        frontier = following
    return cost.get(target, float("inf")) / 65536


def maze(words, rows, cols):
    """Open passages of a perfect maze, as pairs of cells (y, x), the upper or left one first."""
    seen, way, opened, drawn = {(0, 0)}, [(0, 0)], set(), iter(words)
    while way:
        y, x = way[-1]
        beside = [(y, x - 1), (y, x + 1), (y - 1, x), (y + 1, x)]
        closed = [
            (v, u) for v, u in beside if 0 <= v < rows and 0 <= u < cols and (v, u) not in seen
        ]
        if not closed:
            way.pop()
            continue
        there = closed[high(int(next(drawn)), len(closed))]
        opened.add((min((y, x), there), max((y, x), there)))
        seen.add(there)
        way.append(there)
    return opened
