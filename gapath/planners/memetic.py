"""The memetic planner: walls lead to a first path, a genetic algorithm crosses and mutates it.

It plans on every map, weighted or not, by every corner-cutting rule; finds a path wherever there
is one, and proves it where there is none. docs/memetic.md tells the algorithm.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks
from gapath.grid import Table
from gapath.history.evolution import Evolution, Population
from gapath.kernels.memetic import account
from gapath.kernels.memetic.account import (
    ASK,
    BEST,
    CHANGES,
    CROWDED,
    EFFORT,
    EPOCHS,
    EVALUATIONS,
    INDIVIDUAL,
    LOWER,
    NUMBERS,
    SEARCH,
    SHARES,
    START,
    STATUS,
    UNEVEN,
    UNIT,
    WALLS,
)
from gapath.kernels.memetic.evolution import evolve
from gapath.kernels.memetic.polygon import fields_of
from gapath.kernels.memetic.population import END, EPOCH, GAIN, OPERATOR, ROW, TOTAL
from gapath.kernels.memetic.steps import X_BITS, X_MASK
from gapath.kernels.rng import Stream, probability_threshold
from gapath.kernels.units import SCALE
from gapath.planning.coarse_search import LARGE, coarse_path
from gapath.planning.path import corners
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Plan, PlanStatus, Query

_HANDS = {"left": 1, "right": 2, "both": 3}

NAMES = ("wall following", "loops cut", "looks aside", "pulling", "search", "newcomer",
         "crossover", "reroute", "shortcut", "move", "cut", "insert")  # fmt: skip
"""What finds a path and makes it cheaper (`gapath.kernels.memetic.account`)."""

SMALL = 64 * 64
"""Fields of a map that is searched at once: there A* is through in the time of a first path."""

_UNKNOWN = np.empty(0, dtype=np.uint32)


@dataclass(frozen=True)
class Planner:
    """The memetic planner; ``conf/planner/memetic.yaml`` says what its values are for.

    Parameters
    ----------
    population : int
        Individuals, 1 to 8; a map that has no ways round its obstacles leaves fewer.
    hands : str
        "both", "left" or "right": hands that follow walls.
    effort : float
        What newcomers, crossovers and mutations may read, times the fields of the first path.
    tolerance : float
        Stop at a path that costs by this share, or by a field of the least weight, more than the
        least that any path can; 0: not before it is proved to cost the least.
    crossover_probability : float
        Of an evaluation; the others mutate.
    reroute_probability : float
        Of a mutation, where the path pays more than the least weight somewhere; the others change
        vertices. Elsewhere vertices cannot gain, and each mutation reroutes.
    """

    population: int
    hands: str
    effort: float
    tolerance: float
    crossover_probability: float
    reroute_probability: float

    exact = True
    minimises = "weights"

    def __post_init__(self) -> None:
        check = Checks(self, "planner")
        check.whole("population", 1, 8)
        check("hands", self.hands in _HANDS, f"one of {', '.join(_HANDS)}")
        check("effort", 0 <= self.effort <= 10**6, "a number from 0 to 1000000")
        check("tolerance", 0 <= self.tolerance <= 1, "a number in [0, 1]")
        for name in ("crossover_probability", "reroute_probability"):
            check(name, 0 <= getattr(self, name) <= 1, "a number in [0, 1]")

    @cached_property
    def kernel_settings(self) -> NDArray[np.int64]:
        """The settings as the kernel takes them, (7,) `gapath.kernels.memetic.account`."""
        settings = np.ones(7, dtype=np.int64)
        settings[account.POPULATION] = self.population
        settings[account.HANDS] = _HANDS[self.hands]
        settings[EFFORT] = round(self.effort * UNIT)
        settings[account.TOLERANCE] = round(self.tolerance * UNIT)
        for place, probability in (
            (account.CROSSOVER_THRESHOLD, self.crossover_probability),
            (account.REROUTE_THRESHOLD, self.reroute_probability),
        ):
            settings[place] = probability_threshold(probability)
        return settings

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Run the memetic algorithm once.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        stream : (4,) uint64
            A random stream, advanced in place.

        Returns
        -------
        Plan
            OPTIMAL if its path costs the least that any path can, else FOUND; INFEASIBLE, proved,
            where there is none.
        """
        table, rule = problem.map.table, problem.corner_cutting
        if table.size <= SMALL:
            return _searched(shortest_path(problem))
        (x, y), (u, v) = problem.start, problem.target
        least = problem.map.least_weight(problem.start, problem.target)
        ends, settings = (x, y, u, v), self.kernel_settings
        known, expansions = _UNKNOWN, 0
        told, path = evolve(table, *ends, int(rule), least, settings, known, stream)
        if told[STATUS] in (UNEVEN, CROWDED):
            if told[STATUS] != UNEVEN or table.size <= LARGE:
                return _searched(shortest_path(problem))
            searched = coarse_path(problem)
            expansions = searched.expansions
            if searched.cost * SCALE < told[SHARES] + table[y, x]:  # or none, or dearer than walls'
                found = searched.path.astype(np.uint32)
                known = np.bitwise_or(found[:, 1] << X_BITS, found[:, 0])
            settings = settings.copy()
            settings[ASK] = 0
            told, path = evolve(table, *ends, int(rule), least, settings, known, stream)
        numbers: list[int] = told[:CHANGES].tolist()
        if numbers[STATUS] < 0:
            return Plan(PlanStatus.INFEASIBLE)
        best = numbers[BEST]
        # a robot's table changes; only where no diagonal step is allowed it is asked again
        began = SEARCH if len(known) else WALLS
        result = _Result(told, table.copy() if rule is _STRAIGHT else None, began)
        return Plan(
            PlanStatus.OPTIMAL if best <= numbers[LOWER] else PlanStatus.FOUND,
            path,
            (best + numbers[START]) / SCALE,
            epochs=numbers[EPOCHS],
            evaluations=numbers[EVALUATIONS],
            expansions=expansions,
            trace=result.evolution,
            lines=result.lines,
        )


_STRAIGHT = CornerCutting.NO_DIAGONALS


class _Result(NamedTuple):
    """What the kernel told."""

    told: NDArray[np.int64]
    table: Table | None
    """The map, where rays go by way of fields between two vertices."""
    began: int
    """What found the first path: WALLS or SEARCH."""

    @property
    def changes(self) -> NDArray[np.int64]:
        """Rows of the diary, (n, 6)."""
        end = NUMBERS + 6 * int(self.told[CHANGES])
        return self.told[NUMBERS:end].reshape(-1, 6)

    def polygon(self, change: int) -> NDArray[np.int32]:
        """Give the vertices (n, 2) that straight lines join after a change."""
        ends = self.changes[:, END]
        packed = self.told[NUMBERS + self.changes.size :]
        packed = packed[ends[change - 1] if change else 0 : ends[change]]
        polygon = np.stack([packed & X_MASK, packed >> X_BITS], axis=1).astype(np.int32)
        if self.table is None:
            return polygon
        count, path = fields_of(
            self.table, polygon, len(polygon), False, int(_STRAIGHT), np.empty(0, dtype=np.uint32)
        )
        path = path[:count]
        return corners(np.stack([path & X_MASK, path >> X_BITS], axis=1).astype(np.int32))

    def lines(self) -> NDArray[np.int32]:
        """Give the best polygon."""
        return self.polygon(self._last)

    @property
    def _last(self) -> int:
        """Number of the change that made the best individual what it is."""
        return int(np.flatnonzero(self.changes[:, ROW] == self.told[INDIVIDUAL])[-1])

    def evolution(self) -> Evolution:
        """Tell the history."""
        changes, told = self.changes, self.told
        polygons = [self.polygon(i) for i in range(len(changes))]
        costs = (changes[:, TOTAL] + told[START]) / SCALE
        shares = told[SHARES:NUMBERS].copy()
        shares[WALLS] += told[START]
        population = Population(
            epochs=changes[:, EPOCH].astype(np.int32),
            individuals=changes[:, ROW].astype(np.int32),
            operators=changes[:, OPERATOR].astype(np.int32),
            gains=changes[:, GAIN] / SCALE,
            costs=costs,
            ends=np.cumsum([len(polygon) for polygon in polygons]).astype(np.int32),
            vertices=np.concatenate(polygons),
            names=names_from(self.began),
            shares=tuple((shares / SCALE).tolist()),
        )
        standing = population.standing(int(told[EPOCHS]))
        now = np.where(standing < 0, np.inf, costs[standing])
        best = standing[np.arange(len(standing)), now.argmin(axis=1)].tolist()
        best[-1] = self._last  # of equals the one whose path it is
        way_points = padded([polygons[i] for i in best])
        return Evolution(
            best=now.min(axis=1),
            mean=np.nanmean(np.where(standing < 0, np.nan, now), axis=1),
            chromosomes=way_points.reshape(len(best), -1),
            way_points=way_points,
            genotype="polygon",
            population=population,
        )


def _searched(plan: Plan) -> Plan:
    """Give A*'s plan as this planner's: an individual that nothing can make cheaper."""
    if plan.feasible:
        told = _Searched(plan.path, plan.cost)
        for name, value in (
            ("epochs", 1),
            ("evaluations", 1),
            ("trace", told.evolution),
            ("lines", told.lines),
        ):
            object.__setattr__(plan, name, value)  # nobody else has it; a copy costs as much as A*
    return plan


class _Searched(NamedTuple):
    """What there is to tell of a path that was searched."""

    path: NDArray[np.int32]
    cost: float

    def lines(self) -> NDArray[np.int32]:
        """Give the polygon."""
        return corners(self.path)

    def evolution(self) -> Evolution:
        """Tell the history."""
        cost, polygon, names = np.array([self.cost]), self.lines(), names_from(SEARCH)
        one = np.ones(1, dtype=np.int32)
        population = Population(
            epochs=one,
            individuals=one - 1,
            operators=one - 1,
            gains=np.zeros(1),
            costs=cost,
            ends=one * len(polygon),
            vertices=polygon,
            names=names,
            shares=(self.cost, *(0.0 for _ in names[1:])),
        )
        return Evolution(
            best=cost,
            mean=cost,
            chromosomes=polygon.reshape(1, -1),
            way_points=polygon[np.newaxis],
            genotype="polygon",
            population=population,
        )


def names_from(began: int) -> tuple[str, ...]:
    """Give `NAMES` such that what found the first path, WALLS or SEARCH, comes first."""
    names = list(NAMES)
    names[WALLS], names[began] = names[began], names[WALLS]
    return tuple(names)


def padded(polygons: list[NDArray[np.int32]]) -> NDArray[np.int32]:
    """Give polygons as one array (n, most vertices, 2), their last vertices repeated."""
    most = max(map(len, polygons))
    rows = np.empty((len(polygons), most, 2), dtype=np.int32)
    for row, polygon in zip(rows, polygons, strict=True):
        row[: len(polygon)], row[len(polygon) :] = polygon, polygon[-1]
    return rows
