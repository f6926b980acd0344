"""The task "drive": trials are drives through an unknown map."""

import math
import statistics
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gapath.driving import Drive, Frame, Outcome, Sensor, drive
from gapath.errors import require
from gapath.events import Called, DriveFinished, Event, PathsChanged, Stepped, TrialStarted
from gapath.graph import shortest_path
from gapath.grid import GridMap
from gapath.metrics import clearances, path_metrics
from gapath.navigation import Mode, Navigator
from gapath.problem import Plan, Problem
from gapath.task import Batch, Trial
from gapath.world import Changes

WARM_UP = 20
"""Steps of a drive that is thrown away: it compiles the kernels before the clock runs."""


@dataclass(frozen=True)
class DriveRow:
    """A row of ``trials.parquet``: a drive; those that failed are rows too.

    `ga_calls` counts the genetic algorithm's runs, `calls_a` to `calls_c` the calls of any
    planner by part; `replans` counts the steps in which the current path had met an obstacle,
    `returns` how often return mode began, `stands` the steps without a move. The metrics are
    those of the fields that the robot passed, in order.
    """

    experiment: str
    map: str
    map_instance: int
    map_source: str
    width: int
    height: int
    start: str
    target: str
    corner_cutting: str
    navigator: str
    seed: int
    trial: int
    outcome: str
    reached: bool
    steps: int
    shortest_steps: float
    steps_ratio: float
    ga_calls: int
    calls_a: int
    calls_b: int
    calls_c: int
    replans: int
    returns: int
    stands: int
    evaluations: int
    seen_fields: int
    cost: float
    length: float
    turns: int
    clearance: float
    curvature: float
    compute_time_s: float


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
                "ratio": f"{row.steps_ratio:.3g}",
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


def drive_row(
    batch: Batch, trial: int, driven: Drive, optimum: Plan, distances: NDArray[np.float64]
) -> DriveRow:
    """Sum a drive up.

    Parameters
    ----------
    batch : Batch
        Problem, seed, and names for the row.
    trial : int
        Number of the drive.
    driven : Drive
        The drive.
    optimum : Plan
        A path of fewest steps on the true map.
    distances : (rows, cols) float64
        `gapath.metrics.clearances` of the true map.

    Returns
    -------
    DriveRow
        Its row.
    """
    grid, frames = batch.problem.map, driven.frames
    trail = _without_stands(frames)
    metrics = path_metrics(grid, trail, distances)
    calls = [call for frame in frames if frame.decision for call in frame.decision.calls]
    modes = [frame.decision.mode for frame in frames if frame.decision]
    steps = len(frames) - 1
    shortest = len(optimum.path) - 1 if optimum.feasible else math.nan
    parts = [call.part for call in calls]
    return DriveRow(
        experiment=batch.experiment,
        map=grid.name,
        map_instance=grid.instance,
        map_source=grid.source,
        width=grid.cols,
        height=grid.rows,
        start=str(batch.problem.start),
        target=str(batch.problem.target),
        corner_cutting=batch.problem.corner_cutting.name.lower(),
        navigator=batch.method,
        seed=batch.seed,
        trial=trial,
        outcome=driven.outcome.name.lower(),
        reached=driven.outcome is Outcome.REACHED,
        steps=steps,
        shortest_steps=shortest,
        steps_ratio=steps / shortest
        if driven.outcome is Outcome.REACHED and shortest
        else math.nan,
        ga_calls=sum(call.plan.evaluations > 0 for call in calls),
        calls_a=parts.count("A"),
        calls_b=parts.count("B"),
        calls_c=parts.count("C"),
        replans=sum(any(c.part == "C" for c in f.decision.calls) for f in frames if f.decision),
        returns=sum(
            now is Mode.RETURN and before is not Mode.RETURN
            for before, now in zip([Mode.EXPLORE, *modes], modes, strict=False)
        ),
        stands=steps - (len(trail) - 1),
        evaluations=sum(call.plan.evaluations for call in calls),
        seen_fields=len(np.unique(np.concatenate([frame.news for frame in frames]))),
        cost=metrics.cost,
        length=metrics.length,
        turns=metrics.turns,
        clearance=metrics.clearance,
        curvature=metrics.curvature,
        compute_time_s=driven.compute_time_s,
    )


def _without_stands(frames: list[Frame]) -> NDArray[np.int32]:
    trail = [frames[0].place]
    for frame in frames[1:]:
        if frame.place != trail[-1]:
            trail.append(frame.place)
    return np.array(trail, dtype=np.int32)


def drive_events(driven: Drive, cols: int, seed: int, trial: int, step: int) -> Iterator[Event]:
    """Tell a drive as events.

    Parameters
    ----------
    driven : Drive
        The drive.
    cols : int
        Width of the map.
    seed, trial : int
        Keys of the drive's random streams.
    step : int
        The step at which the trial begins: that of its first look.

    Yields
    ------
    Event
        Its start; for each step the planners called, the paths if they changed, the step
        itself; its end.
    """
    yield TrialStarted(step, trial, seed)
    path = past = np.empty((0, 2), dtype=np.int32)
    for i, frame in enumerate(driven.frames):
        now, decision = step + i, frame.decision
        mode = Mode.EXPLORE
        if decision is not None:
            mode = decision.mode
            for call in decision.calls:
                plan = call.plan
                yield Called(
                    now,
                    trial,
                    call.part,
                    call.index,
                    call.adopted,
                    plan.status,
                    plan.cost,
                    plan.epochs,
                    plan.evaluations,
                    plan.expansions,
                    plan.path,
                )
            new_path = path[:0] if decision.path is None else decision.path
            new_past = np.array(decision.past, dtype=np.int32).reshape(-1, 2)
            if not _continues(path, new_path) or not _extends(past, new_past):
                yield PathsChanged(now, trial, new_path, new_past)
            path, past = new_path, new_past
        fields = np.stack([frame.news % cols, frame.news // cols], axis=1).astype(np.int32)
        entries = frame.entries.astype(np.int32)
        yield Stepped(
            now, trial, frame.place, frame.heading, int(mode), fields, entries, frame.seconds
        )
    steps = len(driven.frames) - 1
    yield DriveFinished(step + steps, trial, int(driven.outcome), steps)


def _continues(before: NDArray[np.int32], now: NDArray[np.int32]) -> bool:
    """Tell whether a path is what is left of another."""
    return len(before) - len(now) in (0, 1) and np.array_equal(
        before[len(before) - len(now) :], now
    )


def _extends(before: NDArray[np.int32], now: NDArray[np.int32]) -> bool:
    """Tell whether a past path is another, longer or shorter by at most one field."""
    shared = min(len(before), len(now))
    return abs(len(before) - len(now)) <= 1 and np.array_equal(before[:shared], now[:shared])
