"""What is measured of the trials of a task: told by what its rows are derived from."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gapath.driving.row import DriveRow
from gapath.pipelines.numbers.drive_summary import RETURNED
from gapath.querying.row import PlanRow
from gapath.task import Row, Task

TRIALS = "trials"
"""What trials are called that have no name of their own."""

Values = NDArray[np.float64]
Read = Callable[[pd.DataFrame], Values]


class Effort(NamedTuple):
    """What a trial spends, whether it succeeds or not."""

    name: str
    """In columns."""
    title: str
    """Of axes and columns, with the unit that is shown."""
    scale: float
    """Shown units for one of the values."""
    read: Read
    """Takes it from trials."""


class Middle(NamedTuple):
    """What trials have of which the median is shown."""

    name: str
    title: str
    shown: Callable[[float], float]
    """Gives the number that is shown of a median."""
    read: Read


class Share(NamedTuple):
    """How trials can end, apart from succeeding."""

    name: str
    title: str
    read: Read


class Measures(NamedTuple):
    """What is measured of a task's trials."""

    success: str
    """The column that says whether a trial succeeded."""
    succeeded: str
    """What that is called."""
    unit: str
    """What trials are called."""
    efforts: tuple[Effort, ...] = ()
    """Those of chance, none of which an exact method spends, first."""
    middles: tuple[Middle, ...] = ()
    shares: tuple[Share, ...] = ()


def measures_of(task: type[Task]) -> Measures:
    """Say what is measured of a task's trials.

    Parameters
    ----------
    task : type
        The task.

    Returns
    -------
    Measures
        Of rows derived from those of plans or drives what these have; else success alone.
    """
    rich = (_MEASURES[kind] for kind in task.row.__mro__ if kind in _MEASURES)
    return next(rich, Measures(task.success, task.success.capitalize().replace("_", " "), TRIALS))


def chance(trials: pd.DataFrame) -> NDArray[np.bool_]:
    """Tell of each trial whether its method was seen to draw random numbers; else it is NaN."""
    if "evaluations" not in trials:
        return np.ones(len(trials), dtype=bool)
    return np.asarray(trials["evaluations"] > 0)


def _column(name: str) -> Read:
    return lambda trials: np.asarray(trials[name], dtype=np.float64)


def _counted(name: str) -> Read:
    """Read what a graph search has none of, rather than zero."""

    def read(trials: pd.DataFrame) -> Values:
        values = trials[name].to_numpy(dtype=np.float64)
        found: Values = np.where(chance(trials), values, np.nan)
        return found

    return read


def _where_found(read: Read) -> Read:
    def values(trials: pd.DataFrame) -> Values:
        found: Values = np.where(trials["feasible"], read(trials), np.nan)
        return found

    return values


def _steps(drives: pd.DataFrame) -> Values:
    """Give steps over the fewest there could be, also of a drive that failed."""
    fewest = drives["shortest_steps"].to_numpy(dtype=np.float64)
    steps = drives["steps"].to_numpy(dtype=np.float64)
    ratio: Values = np.divide(steps, fewest, out=np.full(len(steps), np.nan), where=fewest > 0)
    return ratio


def _ended(outcome: str) -> Read:
    return lambda drives: np.asarray(drives["outcome"] == outcome, dtype=np.float64)


def _never_left(drives: pd.DataFrame) -> Values:
    stood = np.asarray(drives["stands"] == drives["steps"], dtype=np.float64)
    return _ended(RETURNED)(drives) * stood


def _above(ratio: float) -> float:
    return round(100 * (ratio - 1), 2) + 0  # what authors print is rounded


def _same(value: float) -> float:
    return value


_MEASURES: dict[type[Row], Measures] = {
    PlanRow: Measures(
        "feasible",
        "Found",
        TRIALS,
        (
            Effort("evaluations", "evaluations", 1.0, _counted("evaluations")),
            Effort("seconds", "time, ms", 1000.0, _column("plan_time_s")),
        ),
        (
            Middle("epochs", "Epochs", _same, _counted("epochs")),
            Middle("found_epochs", "Epochs, if found", _same, _where_found(_counted("epochs"))),
            Middle("optimality_ratio", "Above optimal, %", _above, _column("optimality_ratio")),
            Middle("length_ratio", "Length above published, %", _above, _column("length_ratio")),
        ),
    ),
    DriveRow: Measures(
        "reached",
        "Reached",
        "drives",
        (
            Effort("steps_ratio", "steps / shortest", 1.0, _steps),
            Effort("seconds", "time, ms", 1000.0, _column("compute_time_s")),
        ),
        (),
        (
            Share("returned", "Returned, %", _ended(RETURNED)),
            Share("overran", "Overran, %", _ended("overran")),
            Share("never_left", "Never left, %", _never_left),
        ),
    ),
}
"""Rows of which more can be said than whether a trial succeeded."""
