"""A few polygons that random fields bend, and that random steps of their bends make cheaper."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gapath.errors import require
from gapath.history.evolution import Evolution, Population
from gapath.kernels.lines import ONE_OBSTACLE, line_key
from gapath.kernels.raster import polyline
from gapath.kernels.rng import Stream, fill, high, low
from gapath.kernels.units import SCALE
from gapath.problem import Plan, PlanStatus, Query

NAMES = ("first bend", "other first bends", "moved vertex", "new vertex")


@dataclass(frozen=True)
class Planner:
    """Bends polygons, and keeps what is not dearer.

    Parameters
    ----------
    individuals : int
        Polygons, 1 to 100.
    epochs : int
        How often each is changed, and once more; 1 to 10 000.
    tries : int
        Fields to try for each first polygon, 1 to 10 000.
    """

    individuals: int
    epochs: int
    tries: int

    exact = False
    minimises = "weights"

    def __post_init__(self) -> None:
        for name, most in (("individuals", 100), ("epochs", 10**4), ("tries", 10**4)):
            value = getattr(self, name)
            require(1 <= value <= most, f"planner.{name}", value, f"an integer from 1 to {most}")

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Give the cheapest polygon's path."""
        words = np.empty((self.individuals, self.tries + 3 * self.epochs), dtype=np.uint64)
        fill(stream, words.ravel())
        tally = _Tally(problem)
        for i, row in enumerate(words[:, : self.tries]):
            bends = ([problem.start, _field(problem, word), problem.target] for word in row)
            tally.first(i, next((each for each in bends if tally.cost(each) is not None), None))
        tally.end_epoch()
        for epoch in range(2, self.epochs + 1 if tally.now else 0):
            for i in sorted(tally.now):
                place, choice, field = words[i, self.tries + 3 * (epoch - 2) :][:3]
                polygon = list(tally.now[i][1])
                new = low(choice, 2)
                k = 1 + high(place, len(polygon) - 2 + new)
                polygon[k : k + 1 - new] = [_field(problem, field)]
                tally.offer(epoch, i, 2 + new, polygon)
            tally.end_epoch()
        if not tally.now:
            return Plan(PlanStatus.NOT_FOUND, evaluations=self.individuals * self.tries)
        evolution = tally.evolution()
        best = min(tally.now.values())
        path = polyline(np.array(best[1], dtype=np.int32))
        return Plan(
            PlanStatus.FOUND, path, best[0] / SCALE, epochs=len(evolution.best),
            evaluations=self.individuals * (self.tries + self.epochs), trace=lambda: evolution,
            lines=lambda: np.array(best[1], dtype=np.int32),
        )  # fmt: skip


def _field(problem: Query, word: np.uint64) -> tuple[int, int]:
    return high(word, problem.map.cols), low(word, problem.map.rows)


class _Tally:
    """The population, and what became of it."""

    def __init__(self, problem: Query) -> None:
        self.problem = problem
        self.now: dict[int, tuple[int, list[tuple[int, int]]]] = {}
        self.changes: list[tuple[int, int, int, float, float]] = []
        self.polygons: list[list[tuple[int, int]]] = []
        self.shares = [0.0] * len(NAMES)
        self.epochs: list[tuple[float, float, list[tuple[int, int]]]] = []

    def cost(self, polygon: list[tuple[int, int]]) -> int | None:
        """Give what a polygon costs, in units; None if it is blocked."""
        table, rule = self.problem.map.table, int(self.problem.corner_cutting)
        (x, y) = polygon[0]
        key = int(table[y, x])
        key += sum(line_key(table, *a, *b, rule) for a, b in pairwise(polygon))
        return key if key < ONE_OBSTACLE else None

    def first(self, i: int, polygon: list[tuple[int, int]] | None) -> None:
        if polygon:
            self._take(1, i, min(len(self.now), 1), polygon, 0)

    def offer(self, epoch: int, i: int, operator: int, polygon: list[tuple[int, int]]) -> None:
        cost, before = self.cost(polygon), self.now[i][0]
        if cost is not None and cost <= before and polygon != self.now[i][1]:
            self._take(epoch, i, operator, polygon, before - cost)

    def _take(self, epoch: int, i: int, operator: int, polygon: list, gain: int) -> None:
        cost = self.cost(polygon)
        assert cost is not None
        least = min((each[0] for each in self.now.values()), default=2 * cost)
        self.shares[operator] += max(least - cost, 0) / SCALE
        self.now[i] = cost, polygon
        self.changes.append((epoch, i, operator, gain / SCALE, cost / SCALE))
        self.polygons.append(polygon)

    def end_epoch(self) -> None:
        if self.now:
            costs = [each[0] / SCALE for each in self.now.values()]
            self.epochs.append((min(costs), sum(costs) / len(costs), min(self.now.values())[1]))

    def evolution(self) -> Evolution:
        kinds = (np.int32, np.int32, np.int32, np.float64, np.float64)
        columns = zip(*self.changes, strict=True)
        changes = [np.array(c, dtype=k) for c, k in zip(columns, kinds, strict=True)]
        ends = np.cumsum(list(map(len, self.polygons)), dtype=np.int32)
        vertices = np.array([v for polygon in self.polygons for v in polygon], dtype=np.int32)
        population = Population(*changes, ends, vertices, NAMES, tuple(self.shares))
        best, mean, rows = zip(*self.epochs, strict=True)
        width = max(map(len, rows))
        way_points = np.array([r + r[-1:] * (width - len(r)) for r in rows], dtype=np.int32)
        values = np.array(best), np.array(mean)
        return Evolution(
            *values, way_points.reshape(len(rows), -1), way_points, "polygon", population
        )
