"""The records that a run emits, and what every recorder must offer.

Log, recording, table row and figure are all made from these. Time is the step index: a
planning trial takes one step for each epoch, and one if its planner has no epochs; a drive
takes one for its first look and one for each step of the robot.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from gapath.grid import Field
from gapath.history.evolution import Evolution
from gapath.history.graph import Graph
from gapath.problem import Answer, Problem

Settings: TypeAlias = Mapping[str, str | int | float | bool | None]
"""A run's settings, flat: "planner.population", "drive.sensor.range" -> value."""


class Mode(IntEnum):
    """What the robot is doing (KG18 Fig. 11)."""

    EXPLORE = 0
    """Following its current path: part B."""
    REPLAN = 1
    """Its current path met an obstacle: part C."""
    RETURN = 2
    """Going back in its footsteps: part A."""


class Outcome(IntEnum):
    """How a drive ended."""

    REACHED = 0
    """The robot is at the target."""
    RETURNED = 1
    """It came back to its start in return mode: KG18's terminal failure."""
    OVERRAN = 2
    """It used up its steps."""


NEVER_LEFT = "never left: no planner found a path from the start"
"""What a drive is said to be whose robot came back without having gone anywhere."""


@dataclass(frozen=True, eq=False)
class RunStarted:
    """The first event: everything that the trials of a run share.

    Parameters
    ----------
    experiment : str
        Its name.
    method : str
        Name of the planner or navigator, for people.
    task : str
        Its name, of a module of `gapath.tasks`.
    problem : Problem
        Map, start, target and corner-cutting rule.
    seed, trials : int
        The run does trials 0 to trials - 1, with streams (seed, trial, call).
    settings : mapping of str to str, int, float, bool or None
        The resolved configuration, flat (`gapath.store.settings`).
    versions : dict of str to str
        Versions of gapath and of what it stands on.
    optimal_path : (n, 2) int32
        A path of least cost (KG18 eq. (5)), for a drive one of fewest steps on the true map,
        as (x, y); empty where none exists.
    optimal_cost : float
        Its cost; infinite where none exists.
    """

    experiment: str
    method: str
    task: str
    problem: Problem
    seed: int
    trials: int
    settings: Settings
    versions: dict[str, str]
    optimal_path: NDArray[np.int32] = field(repr=False)
    optimal_cost: float


@dataclass(frozen=True, eq=False)
class TrialStarted:
    """A trial begins at this step, with its random stream (seed, trial, call)."""

    step: int
    trial: int
    seed: int


@dataclass(frozen=True, eq=False)
class Posed:
    """A trial has a start and a target of its own, of several on one map.

    Parameters
    ----------
    step, trial, number : int
        When, in which trial, and the number of the query among all that are listed.
    start, target : (x, y)
        Fields, which may be blocked.
    optimal_path, optimal_cost
        What the trial is held against, as of `RunStarted`.
    """

    step: int
    trial: int
    number: int
    start: Field
    target: Field
    optimal_path: NDArray[np.int32] = field(repr=False)
    optimal_cost: float


@dataclass(frozen=True, eq=False)
class Evolved:
    """A genetic algorithm ran; its epochs are the steps from this one on."""

    step: int
    trial: int
    call: int
    evolution: Evolution = field(repr=False)


@dataclass(frozen=True, eq=False)
class Surveyed:
    """What the planner made of the map before it searched: in the first trial, for all of them."""

    step: int
    trial: int
    graph: Graph = field(repr=False)


@dataclass(frozen=True, eq=False)
class Finished:
    """The last event of a trial, of whatever kind."""

    step: int
    trial: int

    @property
    def ending(self) -> str:
        """How the trial ended, in a word or two for people."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class TrialFinished(Finished):
    """A trial ended at this step with this answer."""

    answer: Answer

    @property
    def ending(self) -> str:
        """The answer's status."""
        return self.answer.status.name.lower()


@dataclass(frozen=True)
class DriveStarted:
    """A trial is a drive: what its robot can do.

    Parameters
    ----------
    step, trial : int
        When, and in which trial.
    sensor_range : int
        Layers of the triangle that it sees (KG18 Sec. 5).
    unknown_weight : float
        What it takes an unknown field to cost.
    step_limit : int
        Steps after which it has overrun.
    """

    step: int
    trial: int
    sensor_range: int
    unknown_weight: float
    step_limit: int


@dataclass(frozen=True, eq=False)
class Stepped:
    """A robot looked around and moved, or stood (the first look of a drive: stood).

    Parameters
    ----------
    step, trial : int
        When, and in which trial.
    place : (x, y)
        The robot's field after the step.
    heading : int
        Where it looked: 0 (+x) to 7, clockwise with y down.
    mode : int
        What it was doing.
    fields : (n, 2) int32
        Fields as (x, y) that it saw for the first time or changed.
    entries : (n,) int32
        Their table entries (`gapath.grid`).
    seconds : float
        Wall time of the step; not in the log, so NaN in events that were read back.
    """

    step: int
    trial: int
    place: Field
    heading: int
    mode: Mode
    fields: NDArray[np.int32] = field(repr=False)
    entries: NDArray[np.int32] = field(repr=False)
    seconds: float


@dataclass(frozen=True, eq=False)
class Called:
    """A navigator called a planner in this step, before the robot moved.

    Parameters
    ----------
    step, trial : int
        When, and in which trial.
    part : str
        A, B or C (KG18 Figs 12-14).
    index : int
        Number of the planner in its part's list.
    adopted : bool
        Whether its path became the current one.
    answer : Answer
        What it answered.
    """

    step: int
    trial: int
    part: str
    index: int
    adopted: bool
    answer: Answer


@dataclass(frozen=True, eq=False)
class PathsChanged:
    """The path that the robot follows, or the way back, is another one from this step on.

    Parameters
    ----------
    step, trial : int
        When, and in which trial.
    path : (n, 2) int32
        The current path from the robot's field on; empty if it has none.
    past : (m, 2) int32
        The past path, the robot's own field last; what is only longer by the robot's moves
        since, or shorter by its way back, is no change.
    """

    step: int
    trial: int
    path: NDArray[np.int32] = field(repr=False)
    past: NDArray[np.int32] = field(repr=False)


@dataclass(frozen=True)
class DriveFinished(Finished):
    """A drive ended at this step.

    Parameters
    ----------
    step, trial : int
        When, and in which trial.
    outcome : Outcome
        How.
    steps : int
        After how many steps of the robot.
    stands : int
        In how many of them it stood.
    """

    outcome: Outcome
    steps: int
    stands: int

    @property
    def ending(self) -> str:
        """The outcome, and whether the robot ever left its start."""
        name = self.outcome.name.lower()
        return f"{name} ({NEVER_LEFT})" if self.never_left else name

    @property
    def never_left(self) -> bool:
        """Whether the robot came back without having gone anywhere."""
        return self.outcome is Outcome.RETURNED and self.stands == self.steps


@dataclass(frozen=True)
class RunFinished:
    """The last event of a run that was not interrupted; counts trials that found the target."""

    step: int
    trials: int
    found: int


Event: TypeAlias = (
    RunStarted
    | TrialStarted
    | Posed
    | Evolved
    | Surveyed
    | TrialFinished
    | DriveStarted
    | Stepped
    | Called
    | PathsChanged
    | DriveFinished
    | RunFinished
)


@runtime_checkable
class Recorder(Protocol):
    """What a module of `gapath.recorders` offers under the name ``Recorder``.

    A dataclass whose fields are the settings of its YAML file in ``conf/recorder``.
    Files are written under a name that ends in ``.part`` until `close` renames them.
    """

    @property
    def records(self) -> bool:
        """Whether it has any use for events; where nobody has, none are made."""

    def check(self, trials: int) -> None:
        """Raise InputError if a run of so many trials cannot be recorded as set."""

    def open(self, folder: str) -> None:
        """Prepare to write files into an existing folder."""

    def record(self, event: Event) -> None:
        """Take the next event, in the order in which the run emits them."""

    def close(self) -> list[str]:
        """Finish the files, make them durable, and give their names within the folder."""

    def abort(self) -> None:
        """Let go of the files after a failure; what was written stays as ``.part``."""
