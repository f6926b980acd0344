"""The task to drive: trials are drives through an unknown map."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, Self

import numpy as np

from gapath.components import build, typed
from gapath.driving.drive import Driven, Sensor, drive
from gapath.driving.known_map import KNOWN, read_known_map
from gapath.driving.navigation import Navigator
from gapath.driving.row import DriveRow, drive_row
from gapath.driving.told import drive_events
from gapath.driving.world import Changes
from gapath.errors import Checks, few, require
from gapath.events import (
    NEVER_LEFT,
    Called,
    DriveFinished,
    DriveStarted,
    Outcome,
    PathsChanged,
    RunStarted,
    Stepped,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.planning.path import path_weights
from gapath.planning.planner import Particular
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Plan, Problem
from gapath.task import Batch, Rows, Trial

LEAST_STEPS, MOST_STEPS = 2000, 10**6
"""The smallest step limit that a map's size gives, and the largest of all."""

STEPS_RULE = f"two steps for every five fields, no fewer than {LEAST_STEPS}"
"""`usual_limit` in words."""

WARM_UP = 100
"""Steps of a drive that is thrown away: it meets an obstacle, so that the kernels are compiled
before the clock runs."""


@dataclass
class DriveSettings:
    """What a drive needs besides a map and a navigator.

    Parameters
    ----------
    sensor : Sensor
        Sees.
    changes : Changes
        What happens to the map meanwhile.
    step_limit : int or None
        Steps after which a drive has overrun; None for what the map's size asks (`usual_limit`).
    unknown_weight : float
        What an unknown field counts.
    known_map : str or None
        A map file: what the robot knows before it starts.
    """

    sensor: Sensor
    changes: Changes
    step_limit: int | None
    unknown_weight: float
    known_map: str | None

    def __post_init__(self) -> None:
        check = Checks(self, "drive")
        limited = self.step_limit is None or 1 <= self.step_limit <= MOST_STEPS
        check("step_limit", limited, f"an integer from 1 to {MOST_STEPS}, or null")
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
    step_limit : int or None
        Steps after which a drive has overrun; None for what the map's size asks (`usual_limit`).
    unknown_weight : float
        What an unknown field counts.
    known_map : str or None
        A map file: what the robot knows before it starts.
    """

    navigator: Navigator
    sensor: Sensor
    changes: Changes
    step_limit: int | None
    unknown_weight: float
    known_map: str | None

    name: ClassVar[str] = "drive"
    groups: ClassVar[tuple[str, ...]] = ("navigator", "drive")
    shapes: ClassVar[Mapping[str, type[Any]]] = {"drive": DriveSettings}
    row: ClassVar[type[Any]] = DriveRow
    success: ClassVar[str] = "reached"
    threaded: ClassVar[bool] = (
        False  # a drive's steps are Python: drives on threads would wait for one another
    )
    events: ClassVar[tuple[type[Any], ...]] = (
        TrialStarted,
        DriveStarted,
        Called,
        PathsChanged,
        Stepped,
        DriveFinished,
    )

    @classmethod
    def make(cls, settings: Mapping[str, Any]) -> Self:
        """Make it from nested settings; raises InputError."""
        return cls.of(build("navigator", settings["navigator"], "navigator"), settings["drive"])

    @classmethod
    def of(cls, navigator: Navigator, settings: Mapping[str, Any]) -> Self:
        """Make it from a navigator and the settings of ``drive``; raises InputError."""
        drive: DriveSettings = typed(DriveSettings, settings, "drive")
        return cls(
            navigator,
            drive.sensor,
            drive.changes,
            drive.step_limit,
            drive.unknown_weight,
            drive.known_map,
        )

    def read(self) -> Mapping[str, GridMap]:
        """Read what the robot knows before it starts; raises InputError."""
        return {KNOWN: read_known_map(self.known_map)} if self.known_map is not None else {}

    @staticmethod
    def told_optimum(run: RunStarted) -> dict[str, str]:
        """Say what the trials are held against: label -> value."""
        steps = len(run.optimal_path) - 1
        return {"shortest": f"{steps} steps possible" if steps >= 0 else "no way to the target"}

    def check(self, problem: Problem) -> None:
        """Raise InputError if what the robot knows before it starts is of another size.

        Or if the navigator does not take such a map.
        """
        if isinstance(self.navigator, Particular):
            self.navigator.check(problem)
        if KNOWN in problem.maps:
            true, known = problem.map, problem.maps[KNOWN]
            require(
                (known.rows, known.cols) == (true.rows, true.cols),
                KNOWN,
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
        """Drive with the random streams of trials `Batch.first` to trials - 1.

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
        self.once(problem, seed, 0, WARM_UP)
        for trial in range(batch.first, batch.trials):
            driven = self.once(problem, seed, trial)
            row = drive_row(batch, trial, driven, optimum)
            events = partial(drive_events, driven, problem.map.cols, seed, trial)
            yield Trial(row, row.reached, len(driven.frames), events)

    def once(
        self, problem: Problem, seed: int, trial: int = 0, most_steps: int = MOST_STEPS
    ) -> Driven:
        """Drive with the random streams of one trial.

        Parameters
        ----------
        problem : Problem
            The true map, start and target; among its maps what the robot knows, if anything.
        seed, trial : int
            Keys of the streams.
        most_steps : int
            Steps after which to stop before the limit.

        Returns
        -------
        Driven
            How it ended, and every step.
        """
        return drive(
            problem,
            self.navigator,
            self.sensor,
            self.changes,
            seed,
            trial,
            min(most_steps, self.most_plans(problem.map.weights.size)),
            self.unknown_weight,
            problem.maps.get(KNOWN),
        )

    def most_plans(self, fields: int) -> int:
        """Give the most steps of a drive (`gapath.task.Replanning`)."""
        return self.step_limit or usual_limit(fields)

    def summary(self, rows: Rows) -> dict[str, object]:
        """Sum drives up for the terminal: label -> value."""
        outcomes = rows["outcome"]
        if len(outcomes) == 1:
            numbers = ("steps", "shortest_steps", "steps_ratio", "calls_a", "calls_b", "calls_c")
            first = {name: rows[name][0] for name in numbers}
            shortest = "no way to the target"
            if not math.isnan(first["shortest_steps"]):
                shortest = f"{first['shortest_steps']:g} steps possible"
            known = not math.isnan(first["steps_ratio"])
            ratio = {"ratio": f"{first['steps_ratio']:.3g}"} if known else {}
            a, b, c = (first[f"calls_{part}"] for part in "abc")
            return {
                "seed": rows["seed"][0],
                "outcome": outcomes[0] + self._remark(rows, outcomes[0]),
                "steps": first["steps"],
                "step limit": self._told_limit(rows),
                "shortest": shortest,
                **ratio,
                "calls": f"{a + b + c} (A {a}, B {b}, C {c})",
                "replans": rows["replans"][0],
                "returns": rows["returns"][0],
                "time": _median_time(rows),
            }
        lines: dict[str, object] = {"drives": len(outcomes)}
        for name, count in _by_outcome(rows).items():
            share = f"{count} ({100 * count / len(outcomes):.1f} %)"
            rare = 0 < count < len(outcomes) and name != Outcome.REACHED.name.lower()
            which = f": trial {few(rows['trial'][outcomes == name])}" if rare else ""
            lines[name] = f"{share}{self._remark(rows, name)}{which}"
        ratios = rows["steps_ratio"]
        if len(ratios := ratios[~np.isnan(ratios)]):
            lines["median ratio"] = f"{np.median(ratios):.3g} of the shortest possible"
        lines["step limit"] = self._told_limit(rows)
        calls = rows["calls_a"] + rows["calls_b"] + rows["calls_c"]
        lines["median calls"] = f"{np.median(calls):g}"
        lines["median time"] = _median_time(rows)
        return lines

    def line(self, rows: Rows) -> str:
        """Sum drives up in one line."""
        outcomes = rows["outcome"]
        if len(outcomes) == 1:
            ended = f"{outcomes[0]}{self._remark(rows, outcomes[0])}"
            return f"{ended}, {rows['steps'][0]} steps, {_median_time(rows)}"
        ends = [
            f"{count} {name}{self._remark(rows, name)}"
            for name, count in _by_outcome(rows).items()
            if count
        ]
        return f"{len(outcomes)} drives: {', '.join(ends)}; median {_median_time(rows)}"

    def _told_limit(self, rows: Rows) -> str:
        if self.step_limit:
            return str(self.step_limit)
        return f"{usual_limit(rows['width'][0] * rows['height'][0])}, from the map's size"

    def _remark(self, rows: Rows, name: str) -> str:
        """Say what an outcome alone does not, of the drives that ended so."""
        these = rows["outcome"] == name
        if name == Outcome.OVERRAN.name.lower() and these.any():
            rule = "" if self.step_limit else f", {STEPS_RULE}"
            return f" (drive.step_limit: {rows['steps'][these][0]}{rule})"
        if name != Outcome.RETURNED.name.lower():
            return ""
        stayed = (rows["stands"] == rows["steps"])[these].sum()
        return f" ({f'{stayed} ' if these.sum() > 1 else ''}{NEVER_LEFT})" if stayed else ""


def usual_limit(fields: int) -> int:
    """Give the step limit of a map on which none is set.

    Parameters
    ----------
    fields : int
        Fields of the map.

    Returns
    -------
    int
        Two steps for every five fields, which are KG18's 2000 on its maps (Sec. 6.4), as on
        smaller ones; at most `MOST_STEPS`.
    """
    return min(max(LEAST_STEPS, 2 * fields // 5), MOST_STEPS)


def _by_outcome(rows: Rows) -> dict[str, int]:
    ended, names = rows["outcome"], [outcome.name.lower() for outcome in Outcome]
    return {name: int((ended == name).sum()) for name in names}


def _median_time(rows: Rows) -> str:
    return f"{1000 * np.median(rows['compute_time_s']):.3g} ms"
