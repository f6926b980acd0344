"""What a task is: a kind of trial, found by its name like a planner.

A module of `gapath.tasks`, or of an installed package, offers it as the class ``Task``. Whatever
asks for a task's name asks here.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple, Protocol, Self, TypeAlias, get_args, runtime_checkable

from numpy.typing import NDArray

from gapath.discovery import kinds, load
from gapath.errors import InputError, one_of, require, require_all
from gapath.events import Event, Finished, RunStarted, TrialStarted
from gapath.grid import GridMap
from gapath.planning.path import octile_length
from gapath.problem import CornerCutting, Plan, Problem
from gapath.scenario.listed import Queries
from gapath.store.results import Results

Measure = Callable[[Problem, Plan], float]
"""Measures a path, whoever found it."""

Rows: TypeAlias = Mapping[str, NDArray[Any]]
"""A run's rows by column, a value a trial: bool, int64, float64, uint64 (the seed), or str objects.
A column is read when it is asked for, so rows of a million trials take the room of one."""


class Batch(NamedTuple):
    """Trials `first` to trials - 1 of one setting, and the names that their rows carry."""

    experiment: str
    method: str
    problem: Problem
    seed: int
    trials: int
    threads: int = 1
    first: int = 0


@dataclass(frozen=True)
class Row:
    """What every row of ``trials.parquet`` has; failures are rows too.

    `map_digest` is the SHA-256 of what a planner sees of the map; `published_length` is the octile
    length that the map's author gives, `length_ratio` that of a path that was found over it, both
    NaN where there is none; `metrics` holds the columns of `gapath.metrics` by name, all of them
    NaN where the trial has no solution.
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
    published_length: float
    length_ratio: float
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
        "published_length": problem.published_length,
        "length_ratio": _length_ratio(plan, problem.published_length),
        "metrics": measured(problem, plan),
    }


def _length_ratio(plan: Plan, published: float) -> float:
    known = plan.feasible and published > 0  # not NaN
    return octile_length(plan.path) / published if known else math.nan


@lru_cache
def metrics() -> dict[str, Measure]:
    """Find all metrics: name -> how to measure."""
    found: dict[str, Measure] = {}
    for name in kinds("metric"):
        module = load("metric", name)
        require_all(module, module.__name__, {"TITLE": str, "measure": Callable})
        kind = getattr(module.measure, "__annotations__", {}).get("return", "no annotation")
        good = kind in (float, int, "float", "int")
        require(good, f"{module.__name__}.measure, result", kind, "float or int")
        found[name] = module.measure
    return found


def measured(problem: Problem, plan: Plan) -> dict[str, float]:
    """Measure a plan's path by all metrics, if it is a solution.

    Parameters
    ----------
    problem : Problem
        The problem that it solves.
    plan : Plan
        The plan; its status says whether it is one.

    Returns
    -------
    dict of str to float
        Metric -> value, all of them NaN unless the plan is FOUND.
    """
    if not plan.feasible:
        return dict.fromkeys(metrics(), math.nan)
    return {name: float(measure(problem, plan)) for name, measure in metrics().items()}


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
    return own | dict.fromkeys(metrics(), float)


_NO_RESULTS = ("map_instance", "seed", "trial")
"""Numbers in the rows that name something."""


def results(task: type["Task"], rows: Rows) -> Results:
    """Sum up trials.

    Parameters
    ----------
    task : type
        Their task.
    rows : mapping of str to (n,) array
        The columns of their rows; one that is missing has no sum.

    Returns
    -------
    Results
        Its sums are those of all columns that hold numbers or booleans.
    """
    numeric = [name for name, kind in columns(task.row).items() if kind is not str]
    kept = [name for name in numeric if name in rows and name not in _NO_RESULTS]
    return Results.of(rows[task.success], ((name, rows[name]) for name in kept))


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
    shapes: ClassVar[Mapping[str, type[Any]]]
    """A dataclass of the settings for each group that holds no component."""
    row: ClassVar[type[Any]]
    """The dataclass of its rows, derived from `Row`."""
    success: ClassVar[str]
    """The column of its rows that says whether a trial succeeded."""
    threaded: ClassVar[bool]
    """Whether threads speed it up."""
    events: ClassVar[tuple[type[Any], ...]]
    """The events that its trials emit, of `gapath.events`: first `TrialStarted`, last one of
    `Finished`. Recorders go by these, not by the task."""

    @classmethod
    def make(cls, settings: Mapping[str, Any]) -> Self:
        """Make it from nested settings, of which it reads its groups; raises InputError."""

    def read(self) -> Mapping[str, GridMap]:
        """Read the files that its settings name: setting -> map.

        Once, when a run is made; from there on they are in `Problem.maps`, and so in the log:
        to do the run again takes no file. Raises InputError.
        """

    @staticmethod
    def told_optimum(run: RunStarted) -> dict[str, str]:
        """Say what the trials are held against: label -> value."""

    def check(self, problem: Problem) -> None:
        """Raise InputError if the task cannot be done on this map."""

    def optimum(self, problem: Problem) -> Plan:
        """Find what the trials are held against."""

    def trials(self, batch: Batch, optimum: Plan) -> Iterator[Trial]:
        """Do the trials from `Batch.first` on; no event is made before the clock has stopped."""

    def summary(self, rows: Rows) -> dict[str, object]:
        """Sum rows up for the terminal: label -> value; take no more columns than it needs."""

    def line(self, rows: Rows) -> str:
        """Sum rows up in one line."""


@runtime_checkable
class Posing(Protocol):
    """A task whose trials are of several pairs of start and target on one map says of which."""

    def pose(self, grid: GridMap, listed: Queries | None, rule: CornerCutting) -> Queries:
        """Say what is asked, and in which order.

        Parameters
        ----------
        grid : GridMap
            The map.
        listed : Queries or None
            What the map's reader lists.
        rule : CornerCutting
            The rule for diagonal steps.

        Returns
        -------
        Queries
            At least one; a run does its number of trials of each.
        """


@runtime_checkable
class Replanning(Protocol):
    """A task whose trials plan more than once says how often."""

    def most_plans(self, fields: int) -> int:
        """Give how often a trial may call each of its planners, on a map of so many fields."""


@runtime_checkable
class Listing(Protocol):
    """A reader of maps whose format may come with pairs of start and target."""

    def queries(self, grid: GridMap) -> Queries | None:
        """Give them, of the map that it has read; None if there are none."""


def check_events(task: type[Task]) -> None:
    """Raise InputError if a task has events that the log does not know, or that end no trial."""
    where = f"task {task.name}, events"
    for kind in task.events:
        known = kind in get_args(Event)
        require(known, where, kind.__name__, "classes of gapath.events, which the log can hold")
    ends = any(issubclass(kind, Finished) for kind in task.events)
    names = [kind.__name__ for kind in task.events]
    require(TrialStarted in task.events and ends, where, names, "TrialStarted and one of Finished")


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
        If there is none of that name, or it is not what a `Task` must be.
    """
    if name not in kinds("task"):
        raise InputError(where, name, one_of(name, kinds("task")))
    task: type[Task] = load("task", str(name))
    row, place = task.row, f"{task.__module__}.Task"
    good = isinstance(row, type) and issubclass(row, Row)
    require(good, f"{place}.row", row, "a dataclass derived from gapath.task.Row")
    names = [each.name for each in fields(row)]
    require(task.success in names, f"{place}.success", task.success, f"one of {', '.join(names)}")
    return task
