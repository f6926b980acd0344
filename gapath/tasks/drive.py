"""The task "drive": trials are drives through an unknown map."""

import statistics
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from gapath.driving.drive import Drive, Sensor, drive
from gapath.driving.navigation import Navigator
from gapath.driving.row import DriveRow, drive_row
from gapath.driving.told import drive_events
from gapath.driving.world import Changes
from gapath.errors import require
from gapath.events import Outcome
from gapath.grid import GridMap
from gapath.planning.metrics import clearances, path_metrics
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Plan, Problem
from gapath.task import Batch, Trial

WARM_UP = 100
"""Steps of a drive that is thrown away: it meets an obstacle, so that the kernels are compiled
before the clock runs."""


@dataclass(frozen=True)
class DriveTask:
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

    name = "drive"
    row = DriveRow

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
        cost = path_metrics(grid, plan.path, np.zeros(grid.weights.shape)).cost
        return Plan(plan.status, plan.path, cost)

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
        distances = clearances(problem.map)
        self._drive(problem, seed, 0, min(WARM_UP, self.step_limit))
        for trial in range(batch.trials):
            driven = self._drive(problem, seed, trial, self.step_limit)
            row = drive_row(batch, trial, driven, optimum, distances)
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
