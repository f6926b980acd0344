"""What a task is: a kind of trial, found by its name like a planner.

A module of `gapath.tasks`, or of an installed package, offers it as the class ``Task``. Whatever
asks for a task's name asks here.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple, Protocol, Self, get_type_hints, runtime_checkable

from gapath.discovery import kinds, load
from gapath.errors import InputError, one_of, require
from gapath.events import Event, RunStarted
from gapath.problem import Plan, Problem

Measure = Callable[[Problem, Plan], float]
"""Measures a path, whoever found it."""


class Batch(NamedTuple):
    """Trials 0 to trials - 1 of one setting, and the names that their rows carry."""

    experiment: str
    method: str
    problem: Problem
    seed: int
    trials: int
    threads: int = 1


@dataclass(frozen=True)
class Row:
    """What every row of ``trials.parquet`` has; failures are rows too.

    `map_digest` is the SHA-256 of what a planner sees of the map; `metrics` holds the columns
    of `gapath.metrics` by name: NaN (0 for a count) where there is no path.
    """

    experiment: str
    map: str
    map_instance: int
    map_source: str
    map_digest: str
    width: int
    height: int
    start: str
    target: str
    corner_cutting: str
    seed: int
    trial: int
    metrics: Mapping[str, float] = field(repr=False)

    def values(self) -> dict[str, Any]:
        """Give all columns by name."""
        own = dict(self.__dict__)
        del own["metrics"]
        return own | dict(self.metrics)


def head(batch: Batch, trial: int, plan: Plan) -> dict[str, Any]:
    """Give the fields of `Row` for a trial.

    Parameters
    ----------
    batch : Batch
        What its trials share.
    trial : int
        Number of the trial.
    plan : Plan
        Its path, for the metrics.

    Returns
    -------
    dict
        Field -> value.
    """
    problem, grid = batch.problem, batch.problem.map
    return {
        "experiment": batch.experiment,
        "map": grid.name,
        "map_instance": grid.instance,
        "map_source": grid.source,
        "map_digest": grid.digest,
        "width": grid.cols,
        "height": grid.rows,
        "start": str(problem.start),
        "target": str(problem.target),
        "corner_cutting": problem.corner_cutting.name.lower(),
        "seed": batch.seed,
        "trial": trial,
        "metrics": measured(problem, plan),
    }


@lru_cache
def metrics() -> dict[str, tuple[Measure, type]]:
    """Find all metrics: name -> how to measure, and whether it is a float or an int."""
    found: dict[str, tuple[Measure, type]] = {}
    for name in kinds("metric"):
        measure: Any = getattr(load("metric", name), "measure", None)
        require(callable(measure), f"metric {name}", "a module without it", "a function measure")
        kind: Any = get_type_hints(measure).get("return")
        require(kind in (float, int), f"metric {name}, result", kind, "float or int")
        found[name] = measure, kind
    return found


def measured(problem: Problem, plan: Plan) -> dict[str, float]:
    """Measure a plan's path by all metrics.

    Parameters
    ----------
    problem : Problem
        The problem that it solves.
    plan : Plan
        The plan; it may have no path.

    Returns
    -------
    dict of str to float
        Metric -> value; NaN, of a count 0, without a path.
    """
    if not len(plan.path):
        return {name: 0 if kind is int else math.nan for name, (_, kind) in metrics().items()}
    return {name: measure(problem, plan) for name, (measure, _) in metrics().items()}


def columns(row: type[Row]) -> dict[str, type]:
    """Give the columns of a kind of rows.

    Parameters
    ----------
    row : type
        A dataclass derived from `Row`.

    Returns
    -------
    dict of str to type
        Column -> str, int, float or bool; the metrics last.
    """
    own: dict[str, Any] = {each.name: each.type for each in fields(row)}
    del own["metrics"]
    for name in metrics():
        require(name not in own, f"metric {name}", "a column of the rows", "another name")
    return own | {name: kind for name, (_, kind) in metrics().items()}


@dataclass(frozen=True, eq=False)
class Trial:
    """A trial that was done.

    Parameters
    ----------
    row : Row
        Its row of ``trials.parquet``.
    found : bool
        Whether it succeeded: found a path, or reached its target.
    steps : int
        How many steps of the log it takes.
    events : callable
        Tells it as events, the first at a given step; called only if somebody records.
    """

    row: Any
    found: bool
    steps: int
    events: Callable[[int], Iterator[Event]] = field(repr=False)


@runtime_checkable
class Task(Protocol):
    """A kind of trial, made from its settings."""

    name: ClassVar[str]
    """That of its module."""
    groups: ClassVar[tuple[str, ...]]
    """Groups of the configuration that it uses; its method is chosen in the first, whose name
    is also that of the rows' column with the method's name."""
    row: ClassVar[type[Any]]
    """The dataclass of its rows, derived from `Row`."""
    success: ClassVar[str]
    """The column of its rows that says whether a trial succeeded."""
    threaded: ClassVar[bool]
    """Whether threads speed it up."""
    events: ClassVar[tuple[type[Any], ...]]
    """The events that its trials emit, of `gapath.events`."""

    @classmethod
    def make(cls, settings: Mapping[str, Any]) -> Self:
        """Make it from nested settings, of which it reads its groups; raises InputError."""

    @staticmethod
    def told_optimum(run: RunStarted) -> dict[str, str]:
        """Say what the trials are held against: label -> value."""

    def using(self, kernels: str) -> Self:
        """Give the same task, computed by other kernels; raises InputError if there are none."""

    def check(self, problem: Problem) -> None:
        """Raise InputError if the task cannot be done on this map."""

    def optimum(self, problem: Problem) -> Plan:
        """Find what the trials are held against."""

    def trials(self, batch: Batch, optimum: Plan) -> Iterator[Trial]:
        """Do the trials, one after another; no event is made before the clock has stopped."""

    def summary(self, rows: list[Any]) -> dict[str, object]:
        """Sum rows up for the terminal: label -> value."""

    def line(self, rows: list[Any]) -> str:
        """Sum rows up in one line."""


def find_task(name: object, where: str = "task") -> type[Task]:
    """Find a task.

    Parameters
    ----------
    name : str
        Its name: that of its module.
    where : str
        Where the name stands, for messages.

    Returns
    -------
    type
        Its class.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    if name not in kinds("task"):
        raise InputError(where, name, one_of(name, kinds("task")))
    task: type[Task] = load("task", str(name))
    return task
