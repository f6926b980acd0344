"""The records that a run emits, and what every recorder must offer.

Log, recording, table row and figure are all made from these. Time is the step index: a
trial takes one step for each epoch, and one if its planner has no epochs.
"""

from dataclasses import dataclass, field
from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from gapath.problem import Evolution, PlanStatus, Problem


@dataclass(frozen=True, eq=False)
class RunStarted:
    """The first event: everything that the trials of a run share.

    Parameters
    ----------
    experiment, planner : str
        Names as in the configuration.
    problem : Problem
        Map, start, target and corner-cutting rule.
    seed, trials : int
        The run does trials 0 to trials - 1, with streams (seed, trial, call).
    settings : str
        The resolved configuration as YAML.
    versions : dict of str to str
        Versions of gapath and of what it stands on.
    optimal_path : (n, 2) int32
        A path of least cost (KG18 eq. (5)) as (x, y); empty where none exists.
    optimal_cost : float
        Its cost; infinite where none exists.
    """

    experiment: str
    planner: str
    problem: Problem
    seed: int
    trials: int
    settings: str
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
class Evolved:
    """A genetic algorithm ran; its epochs are the steps from this one on."""

    step: int
    trial: int
    call: int
    evolution: Evolution = field(repr=False)


@dataclass(frozen=True, eq=False)
class TrialFinished:
    """A trial ended at this step with this plan."""

    step: int
    trial: int
    status: PlanStatus
    cost: float
    epochs: int
    evaluations: int
    expansions: int
    path: NDArray[np.int32] = field(repr=False)


@dataclass(frozen=True)
class RunFinished:
    """The last event of a run that was not interrupted."""

    step: int
    trials: int
    found: int


Event: TypeAlias = RunStarted | TrialStarted | Evolved | TrialFinished | RunFinished


@runtime_checkable
class Recorder(Protocol):
    """What a module of `gapath.recorders` offers under the name ``Recorder``.

    A dataclass whose fields are the settings of its YAML file in ``conf/recorder``.
    Files are written under a name that ends in ``.part`` until `close` renames them.
    """

    def open(self, folder: str) -> None:
        """Prepare to write files into an existing folder."""

    def record(self, event: Event) -> None:
        """Take the next event, in the order in which the run emits them."""

    def close(self) -> list[str]:
        """Finish the files, make them durable, and give their names within the folder."""

    def abort(self) -> None:
        """Let go of the files after a failure; what was written stays as ``.part``."""
