"""The task to drive: trials are drives through an unknown map."""

import statistics
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, Self

import numpy as np

from gapath.components import build, typed
from gapath.discovery import reader_of, yaml_values
from gapath.driving.drive import Drive, Sensor, drive
from gapath.driving.navigation import Navigator
from gapath.driving.row import DriveRow, drive_row
from gapath.driving.told import drive_events
from gapath.driving.world import Changes
from gapath.errors import Checks, require
from gapath.events import (
    Called,
    DriveFinished,
    Outcome,
    PathsChanged,
    RunStarted,
    Stepped,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.planning.path import path_weights
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Plan, Problem
from gapath.task import Batch, Trial

WARM_UP = 100
"""Steps of a drive that is thrown away: it meets an obstacle, so that the kernels are compiled
before the clock runs."""


@dataclass
class DriveSettings:
    """What a drive needs besides a map and a navigator.

    Parameters
    ----------
    sensor : dict
        `gapath.driving.drive.Sensor`.
    changes : dict
        `gapath.driving.world.Changes`.
    step_limit : int
        Steps after which a drive has overrun.
    unknown_weight : float
        What an unknown field counts.
    known_map : str or None
        A map file: what the robot knows before it starts.
    """

    sensor: dict[str, Any]
    changes: dict[str, Any]
    step_limit: int
    unknown_weight: float
    known_map: str | None

    def __post_init__(self) -> None:
        check = Checks(self, "drive")
        check("step_limit", 1 <= self.step_limit <= 10**6, "an integer from 1 to 1000000")
        check("unknown_weight", 0 <= self.unknown_weight < 1, "a number in [0, 1)")


@dataclass(frozen=True)
class Task:
    """Drive through a map that the robot does not know.

    Parameters
    ----------
    navigator : Navigator
        Decides.
    sensor : Sensor
        Sees.
    changes : Changes
        What happens to the map meanwhile.
    step_limit : int
        Steps after which a drive has overrun.
    unknown_weight : float
        What an unknown field counts.
    before : GridMap or None
        What the robot knows before it starts.
    """

    navigator: Navigator
    sensor: Sensor
    changes: Changes
    step_limit: int
    unknown_weight: float
    before: GridMap | None

    name: ClassVar[str] = "drive"
    groups: ClassVar[tuple[str, ...]] = ("navigator", "drive")
    row: ClassVar[type[Any]] = DriveRow
    success: ClassVar[str] = "reached"
    threaded: ClassVar[bool] = (
        False  # a drive's steps are Python: drives on threads would wait for one another
    )
    events: ClassVar[tuple[type[Any], ...]] = (
        TrialStarted,
        Called,
        PathsChanged,
        Stepped,
        DriveFinished,
    )

    @classmethod
    def make(cls, settings: Mapping[str, Any]) -> Self:
        """Make it from nested settings; raises InputError."""
        drive: DriveSettings = typed(DriveSettings, settings["drive"], "drive")
        return cls(
            build("navigator", settings["navigator"], "navigator"),
            typed(Sensor, drive.sensor, "drive.sensor"),
            typed(Changes, drive.changes, "drive.changes"),
            drive.step_limit,
            drive.unknown_weight,
            None if drive.known_map is None else read_known_map(drive.known_map),
        )

    @staticmethod
    def told_optimum(run: RunStarted) -> dict[str, str]:
        """Say what the trials are held against: label -> value."""
        steps = len(run.optimal_path) - 1
        return {"shortest": f"{steps} steps possible" if steps >= 0 else "no way to the target"}

    def check(self, problem: Problem) -> None:
        """Raise InputError if what the robot knows before it starts is of another size."""
        if self.before is not None:
            true, known = problem.map, self.before
            require(
                (known.rows, known.cols) == (true.rows, true.cols),
                "drive.known_map",
                f"{known.cols} x {known.rows} fields",
                f"{true.cols} x {true.rows} as the map itself",
            )

    def optimum(self, problem: Problem) -> Plan:
        """Find a path of fewest steps on the true map.

        Parameters
        ----------
        problem : Problem
            The true map, start and target.

        Returns
        -------
        Plan
            Its cost is KG18 eq. (5) on the true map.
        """
        grid = problem.map
        even = GridMap(grid.name, np.where(grid.obstacles, 1.0, 0.5))
        plan = shortest_path(Problem(even, problem.start, problem.target, problem.corner_cutting))
        if not plan.feasible:
            return plan
        return Plan(plan.status, plan.path, path_weights(grid, plan.path))

    def trials(self, batch: Batch, optimum: Plan) -> Iterator[Trial]:
        """Drive with the random streams of trials 0 to trials - 1.

        Parameters
        ----------
        batch : Batch
            Problem, keys of the streams, names for the rows.
        optimum : Plan
            As `optimum` gives it.

        Yields
        ------
        Trial
            In order.
        """
        problem, seed = batch.problem, batch.seed
        self._drive(problem, seed, 0, min(WARM_UP, self.step_limit))
        for trial in range(batch.trials):
            driven = self._drive(problem, seed, trial, self.step_limit)
            row = drive_row(batch, trial, driven, optimum)
            events = partial(drive_events, driven, problem.map.cols, seed, trial)
            yield Trial(row, row.reached, len(driven.frames), events)

    def summary(self, rows: list[DriveRow]) -> dict[str, object]:
        """Sum drives up for the terminal: label -> value."""
        if len(rows) == 1:
            row = rows[0]
            return {
                "seed": row.seed,
                "outcome": row.outcome,
                "steps": row.steps,
                "shortest": f"{row.shortest_steps:g} steps possible",
                "ratio": f"{row.steps_ratio:.3g}" if row.reached else "-",
                "GA calls": f"{row.ga_calls} (A {row.calls_a}, B {row.calls_b}, C {row.calls_c})",
                "replans": row.replans,
                "returns": row.returns,
                "time": _median_time(rows),
            }
        lines: dict[str, object] = {"drives": len(rows)}
        for outcome in Outcome:
            count = sum(row.outcome == outcome.name.lower() for row in rows)
            lines[outcome.name.lower()] = f"{count} ({100 * count / len(rows):.1f} %)"
        ratios = [row.steps_ratio for row in rows if row.reached]
        if ratios:
            lines["median ratio"] = f"{statistics.median(ratios):.3g} of the shortest possible"
        lines["median calls"] = f"{statistics.median(row.ga_calls for row in rows):g}"
        lines["median time"] = _median_time(rows)
        return lines

    def line(self, rows: list[DriveRow]) -> str:
        """Sum drives up in one line."""
        reached = sum(row.reached for row in rows)
        return f"{reached} of {len(rows)} reached the target, median {_median_time(rows)}"

    def _drive(self, problem: Problem, seed: int, trial: int, step_limit: int) -> Drive:
        return drive(
            problem,
            self.navigator,
            self.sensor,
            self.changes,
            seed,
            trial,
            step_limit,
            self.unknown_weight,
            self.before,
        )


def _median_time(rows: list[DriveRow]) -> str:
    return f"{1000 * statistics.median(row.compute_time_s for row in rows):.3g} ms"


def read_known_map(path: str) -> GridMap:
    """Read what a robot knows before it starts: what that map calls unknown stays unknown.

    Parameters
    ----------
    path : str
        A map file.

    Returns
    -------
    GridMap
        Its obstacles are known, everything else is not.

    Raises
    ------
    InputError
        If the file cannot be used.
    """
    kind = reader_of(path, "drive.known_map")
    values = yaml_values("map", kind) | {"path": path}
    if "unknown" in values:
        values["unknown"] = "free"
    grid: GridMap = build("map", values, "drive.known_map").read()
    return grid
