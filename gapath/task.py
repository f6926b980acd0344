"""What a trial is: the two tasks, to plan and to drive, look the same to an experiment."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

from gapath.events import Event
from gapath.problem import Plan, Problem


class Batch(NamedTuple):
    """Trials 0 to trials - 1 of one setting, and the names that their rows carry."""

    experiment: str
    method: str
    problem: Problem
    seed: int
    trials: int
    threads: int = 1


@dataclass(frozen=True, eq=False)
class Trial:
    """A trial that was done.

    Parameters
    ----------
    row : dataclass
        Its row of ``trials.parquet``.
    found : bool
        Whether it found a path, or reached its target.
    steps : int
        How many steps of the log it takes.
    events : callable
        Tells it as events, the first at a given step; called only if somebody records.
    """

    row: Any
    found: bool
    steps: int
    events: Callable[[int], Iterator[Event]] = field(repr=False)


class Task(Protocol):
    """A kind of trial."""

    @property
    def name(self) -> str:
        """Its name in the configuration."""

    @property
    def row(self) -> type[Any]:
        """The dataclass of its rows."""

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
