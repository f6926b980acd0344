"""The task to plan between many pairs of start and target on one known map, one after another."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from gapath.components import build, typed
from gapath.errors import Checks, InputError, require
from gapath.events import (
    Event,
    Evolved,
    Posed,
    RunStarted,
    Surveyed,
    TrialFinished,
    TrialStarted,
)
from gapath.grid import Field, GridMap
from gapath.kernels.rng import stream
from gapath.planning.path import octile_length
from gapath.planning.planner import Optimal, Particular, Planner
from gapath.planning.shortest_path import shortest_path
from gapath.planning.simulation import TimedPlan, plan_timed
from gapath.planning.threads import in_order
from gapath.problem import CornerCutting, Plan, PlanStatus, Problem
from gapath.querying.row import PlanRow, least_of, median_time, plan_values
from gapath.querying.told import duration, trial_events
from gapath.scenario.drawn import draw_queries
from gapath.scenario.listed import Queries
from gapath.store.results import exact_sum
from gapath.task import Batch, Rows, Trial, metrics

_FIELDS_OF_A_BUCKET = 4
"""By so much MovingAI divides the optimal length, diagonals sqrt(2), for its buckets."""


@dataclass(frozen=True)
class ScenarioRow(PlanRow):
    """A row of ``trials.parquet``: a planning query, one of a scenario.

    `row` is its number there, from 0; `bucket` its class of difficulty, where the scenario gives
    none the octile length of the path of least cost over four, -1 without a path.
    """

    row: int
    bucket: int


@dataclass
class ScenarioSettings:
    """Which pairs of start and target are asked.

    Parameters
    ----------
    first : int
        The row to begin with, from 0.
    last : int or None
        The row to end with; None for the last one.
    every : int
        Takes every so many-th row.
    drawn : int
        Pairs to draw where the map comes without a scenario.
    """

    first: int
    last: int | None
    every: int
    drawn: int

    def __post_init__(self) -> None:
        check = Checks(self, "scenario")
        check.whole("first", 0, 10**6)
        good = self.last is None or self.first <= self.last <= 10**6
        check("last", good, f"an integer from first, {self.first}, to 10^6, or null")
        check.whole("every", 1, 10**6)
        check.whole("drawn", 1, 10**5)


class _Asked(NamedTuple):
    """What came of a query."""

    place: int
    """Among those that the run asks."""
    problem: Problem | None
    """None where start or target is blocked."""
    optimum: Plan
    least: float
    """Of what the planner minimises."""
    answers: list[TimedPlan]


@dataclass(frozen=True)
class Task:
    """Plan on a map that is known, from many starts to many targets.

    Parameters
    ----------
    planner : Planner
        Any planner.
    which : ScenarioSettings
        Which pairs of start and target.
    """

    planner: Planner
    which: ScenarioSettings

    name: ClassVar[str] = "scenario"
    groups: ClassVar[tuple[str, ...]] = ("planner", "scenario")
    shapes: ClassVar[Mapping[str, type[Any]]] = {"scenario": ScenarioSettings}
    row: ClassVar[type[Any]] = ScenarioRow
    success: ClassVar[str] = "feasible"
    threaded: ClassVar[bool] = True
    events: ClassVar[tuple[type[Any], ...]] = (
        TrialStarted,
        Posed,
        Surveyed,
        Evolved,
        TrialFinished,
    )

    @classmethod
    def make(cls, settings: Mapping[str, Any]) -> Self:
        """Make it from nested settings; raises InputError."""
        planner: Planner = build("planner", settings["planner"], "planner")
        known = ("weights", *metrics())
        good = planner.minimises in known
        require(good, "planner, minimises", planner.minimises, f"one of {', '.join(known)}")
        return cls(planner, typed(ScenarioSettings, settings["scenario"], "scenario"))

    def read(self) -> Mapping[str, GridMap]:
        """Read nothing: the map's reader reads the scenario."""
        return {}

    def pose(self, grid: GridMap, listed: Queries | None, rule: CornerCutting) -> Queries:
        """Choose among what the map's reader lists, or among drawn pairs; raises InputError."""
        which = self.which
        every = draw_queries(grid, which.drawn, int(rule)) if listed is None else listed
        there = f"a row of the scenario, 0 to {len(every) - 1}"
        require(which.first < len(every), "scenario.first", which.first, there)
        require((which.last or 0) < len(every), "scenario.last", which.last, f"null, or {there}")
        end = len(every) if which.last is None else which.last + 1
        return every.chosen(slice(which.first, end, which.every))

    @staticmethod
    def told_optimum(run: RunStarted) -> dict[str, str]:
        """Say what the trials are held against: label -> value."""
        return {"optimal cost": f"of each problem its own; of this one {run.optimal_cost:g}"}

    def check(self, problem: Problem) -> None:
        """Raise InputError if the planner does not take the first problem."""
        if isinstance(self.planner, Particular):
            self.planner.check(problem)

    def optimum(self, problem: Problem) -> Plan:
        """Find a path of least cost for the first problem that has one, if any has.

        Parameters
        ----------
        problem : Problem
            One of the problems; the others are in its queries.

        Returns
        -------
        Plan
            FOUND or INFEASIBLE. Each trial is held against its own (`Posed`).
        """
        return shortest_path(problem)

    def trials(self, batch: Batch, optimum: Plan) -> Iterator[Trial]:
        """Plan for each query with the random streams (seed, repetition, row).

        Parameters
        ----------
        batch : Batch
            Problem and its queries, keys of the streams, names for the rows.
        optimum : Plan
            As `optimum` gives it.

        Yields
        ------
        Trial
            The repetitions of the first query, then those of the next; from `Batch.first` on.
        """
        queries = batch.problem.queries or _only(batch.problem)
        if optimum.feasible:  # compiles the kernels before the clock runs
            self.planner.plan(batch.problem, stream(batch.seed, 0))
        times = batch.trials // len(queries)
        work = partial(self._ask, batch, queries, times)
        for asked in in_order(work, range(batch.first // times, len(queries)), batch.threads):
            for answer in asked.answers:
                if answer.number < batch.first:
                    continue
                row = self._row(batch, queries, asked, answer)
                first = answer is asked.answers[0]
                events = partial(_told, queries, asked, answer, batch.seed, first)
                yield Trial(row, row.feasible, duration(answer.plan), events)

    def _ask(self, batch: Batch, queries: Queries, times: int, index: int) -> _Asked:
        """Ask a query so many times; its optimum is found once, outside of the times.

        After them, so that no planner finds the map warmer than another. Of the query in which
        `Batch.first` lies the first answer is given, too: it may be the optimum.
        """
        problem, row = _problem(batch.problem, queries, index), int(queries.numbers[index])
        begin = index * times
        numbers = [begin, *range(max(begin + 1, batch.first), begin + times)]
        if problem is None or not _solvable(problem):
            none = Plan(PlanStatus.INFEASIBLE)
            answers = [TimedPlan(number, none, math.nan) for number in numbers]
            return _Asked(index, problem, none, math.nan, answers)
        if self._takes(problem):
            answers = [
                plan_timed(problem, self.planner, number, (batch.seed, number - begin, row))
                for number in numbers
            ]
        else:
            refused = Plan(PlanStatus.NOT_FOUND)
            answers = [TimedPlan(number, refused, math.nan) for number in numbers]
        first, quantity = answers[0].plan, self.planner.minimises
        best = isinstance(self.planner, Optimal) and self.planner.optimal and first.feasible
        optimum = first if best and quantity == "weights" else shortest_path(problem)
        least = least_of(problem, optimum, quantity)
        return _Asked(index, problem, optimum, least, answers)

    def _takes(self, problem: Problem) -> bool:
        """Tell whether the planner takes a problem: a robot may be too large for its start."""
        try:
            self.check(problem)
        except InputError:
            return False
        return True

    def _row(self, batch: Batch, queries: Queries, asked: _Asked, answer: TimedPlan) -> ScenarioRow:
        """Make a row; of a blocked start or target there is nothing to measure."""
        mine = batch if asked.problem is None else batch._replace(problem=asked.problem)
        start, target = _ends(queries, asked.place)
        values = plan_values(mine, answer, asked.optimum, self.planner.minimises, asked.least)
        values |= {"start": str(start), "target": str(target)}
        values |= {"published_length": float(queries.lengths[asked.place])}
        return ScenarioRow(
            **values,
            row=int(queries.numbers[asked.place]),
            bucket=_bucket(queries, asked),
        )

    def summary(self, rows: Rows) -> dict[str, object]:
        """Sum trials up for the terminal: label -> value."""
        found = rows["feasible"]
        count = len(found)
        lines: dict[str, object] = {
            "problems": _problems(rows),
            "trials": count,
            "found": f"{found.sum()} ({100 * found.sum() / count:.1f} %)",
        }
        if blocked := np.isinf(rows["optimal_cost"]).sum():
            lines["without a way"] = f"{blocked} of the trials"
        ratios = _known(rows["optimality_ratio"])
        if len(ratios):
            mean, most = exact_sum(ratios) / len(ratios), ratios.max()
            what = f"of the least {rows['minimises'][0]}, if found"
            lines["ratio"] = f"mean {mean:.5g}, most {most:.5g} {what}"
        spent = exact_sum(_known(rows["plan_time_s"]))
        return lines | {"time": f"{spent:.3g} s, median {median_time(rows)}"}

    def line(self, rows: Rows) -> str:
        """Sum trials up in one line."""
        found, problems = rows["feasible"], _problems(rows)
        told = f"{found.sum()} of {len(found)} found, {problems} problems"
        return f"{told}, median {median_time(rows)}"


def _problems(rows: Rows) -> int:
    return len(np.unique(rows["row"]))


def _known(column: NDArray[np.float64]) -> NDArray[np.float64]:
    return column[~np.isnan(column)]


def _ends(queries: Queries, index: int) -> tuple[Field, Field]:
    (x, y), (u, v) = queries.starts[index].tolist(), queries.targets[index].tolist()
    return (x, y), (u, v)


def _only(problem: Problem) -> Queries:
    """List the start and target of a problem that comes without queries."""
    start, target = (np.array([end], dtype=np.int32) for end in (problem.start, problem.target))
    number, length = np.zeros(1, dtype=np.int32), np.array([problem.published_length])
    return Queries(number, number - 1, start, target, length)


def _problem(shared: Problem, queries: Queries, index: int) -> Problem | None:
    """Pose a query on the run's map; None where its start or target is blocked."""
    start, target = _ends(queries, index)
    if any(shared.map.obstacles[y, x] for x, y in (start, target)):
        return None
    rule, length = shared.corner_cutting, float(queries.lengths[index])
    return Problem(shared.map, start, target, rule, shared.maps, length)


def _solvable(problem: Problem) -> bool:
    return problem.map.joined(problem.start, problem.target, int(problem.corner_cutting))


def _bucket(queries: Queries, asked: _Asked) -> int:
    given = int(queries.buckets[asked.place])
    if given >= 0 or not asked.optimum.feasible:
        return given
    return int(octile_length(asked.optimum.path) / _FIELDS_OF_A_BUCKET)


def _told(
    queries: Queries, asked: _Asked, answer: TimedPlan, seed: int, first: bool, step: int
) -> Iterator[Event]:
    """Tell a trial as events; what the planner made of the map in the first one of each query."""
    events = trial_events(answer, seed, step, surveyed=first)
    yield next(events)
    start, target = _ends(queries, asked.place)
    number, best = int(queries.numbers[asked.place]), asked.optimum
    yield Posed(step, answer.number, number, start, target, best.path, best.cost)
    yield from events
