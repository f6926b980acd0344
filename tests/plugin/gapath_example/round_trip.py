"""The task to plan there and back again, the way back from the target to the start."""

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, Self

from gapath.components import build
from gapath.events import Event, RunStarted, TrialFinished, TrialStarted
from gapath.grid import GridMap
from gapath.kernels.rng import stream
from gapath.planning.planner import Planner
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Plan, Problem
from gapath.task import Batch, Row, Rows, Trial, head

BACK = 1
"""Key of the random streams of ways back."""


@dataclass(frozen=True)
class RoundTripRow(Row):
    """A row: both ways; the metrics are those of the way there."""

    planner: str
    came_back: bool
    cost: float
    seconds: float


@dataclass(frozen=True)
class Task:
    """Plan from the start to the target, and back.

    Parameters
    ----------
    planner : Planner
        Any planner.
    """

    planner: Planner

    name: ClassVar[str] = "round_trip"
    groups: ClassVar[tuple[str, ...]] = ("planner",)
    shapes: ClassVar[Mapping[str, type[Any]]] = {}
    row: ClassVar[type[Any]] = RoundTripRow
    success: ClassVar[str] = "came_back"
    threaded: ClassVar[bool] = False
    events: ClassVar[tuple[type[Any], ...]] = (TrialStarted, TrialFinished)

    @classmethod
    def make(cls, settings: Mapping[str, Any]) -> Self:
        """Make it from nested settings; raises InputError."""
        return cls(build("planner", settings["planner"], "planner"))

    def read(self) -> Mapping[str, GridMap]:
        """Read nothing: it needs the map alone."""
        return {}

    @staticmethod
    def told_optimum(run: RunStarted) -> dict[str, str]:
        """Say what the trials are held against: label -> value."""
        return {"optimal cost, one way": f"{run.optimal_cost:g}"}

    def check(self, problem: Problem) -> None:
        """Accept every map."""

    def optimum(self, problem: Problem) -> Plan:
        """Find a path of least cost, one way."""
        return shortest_path(problem)

    def trials(self, batch: Batch, optimum: Plan) -> Iterator[Trial]:
        """Plan both ways with the random streams of trials 0 to trials - 1."""
        there = batch.problem
        back = Problem(there.map, there.target, there.start, there.corner_cutting)
        for trial in range(batch.first, batch.trials):
            begin = time.perf_counter()
            first = self.planner.plan(there, stream(batch.seed, trial))
            second = self.planner.plan(back, stream(batch.seed, trial, BACK))
            seconds = time.perf_counter() - begin
            found = first.feasible and second.feasible
            shared = head(batch, trial, first)
            row = RoundTripRow(**shared, planner=batch.method, came_back=found,
                               cost=first.cost + second.cost, seconds=seconds)  # fmt: skip
            yield Trial(row, found, 1, partial(told, batch.seed, trial, first))

    def summary(self, rows: Rows) -> dict[str, object]:
        """Sum rows up for the terminal: label -> value."""
        came_back = rows["came_back"]
        return {"round trips": len(came_back), "came back": came_back.sum()}

    def line(self, rows: Rows) -> str:
        """Sum rows up in one line."""
        came_back = rows["came_back"]
        return f"{came_back.sum()} of {len(came_back)} came back"


def told(seed: int, trial: int, there: Plan, step: int) -> Iterator[Event]:
    """Tell a round trip as events: its way there."""
    yield TrialStarted(step, trial, seed)
    yield TrialFinished(step, trial, there.answer)
