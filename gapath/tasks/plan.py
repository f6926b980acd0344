"""The task to plan: trials are planning queries on a known map."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Self

import numpy as np

from gapath.components import build
from gapath.errors import require
from gapath.events import Evolved, RunStarted, Surveyed, TrialFinished, TrialStarted
from gapath.grid import GridMap
from gapath.planning.device import device_of, on_device
from gapath.planning.planner import Particular, Planner
from gapath.planning.shortest_path import shortest_path
from gapath.planning.simulation import plan_trials
from gapath.problem import Plan, PlanStatus, Problem
from gapath.querying.row import PlanRow, least_of, median_time, plan_values
from gapath.querying.told import duration, trial_events
from gapath.task import Batch, Rows, Trial, metrics

_INFEASIBLE = PlanStatus.INFEASIBLE.name.lower()


@dataclass(frozen=True)
class Task:
    """Plan on a map that is known.

    Parameters
    ----------
    planner : Planner
        Any planner.
    """

    planner: Planner

    name: ClassVar[str] = "plan"
    groups: ClassVar[tuple[str, ...]] = ("planner",)
    shapes: ClassVar[Mapping[str, type[Any]]] = {}
    row: ClassVar[type[Any]] = PlanRow
    success: ClassVar[str] = "feasible"
    threaded: ClassVar[bool] = True
    events: ClassVar[tuple[type[Any], ...]] = (TrialStarted, Surveyed, Evolved, TrialFinished)

    @classmethod
    def make(cls, settings: Mapping[str, Any]) -> Self:
        """Make it from nested settings; raises InputError."""
        planner: Planner = build("planner", settings["planner"], "planner")
        known = ("weights", *metrics())
        good = planner.minimises in known
        require(good, "planner, minimises", planner.minimises, f"one of {', '.join(known)}")
        return cls(planner)

    @property
    def device(self) -> str:
        """What computes its planner."""
        return device_of(self.planner)

    def on(self, device: str) -> Self:
        """Give a copy whose planner a device computes; raises InputError."""
        return replace(self, planner=on_device(self.planner, device))

    def read(self) -> Mapping[str, GridMap]:
        """Read nothing: it needs the map alone."""
        return {}

    @staticmethod
    def told_optimum(run: RunStarted) -> dict[str, str]:
        """Say what the trials are held against: label -> value."""
        return {"optimal cost": f"{run.optimal_cost:g}"}

    def check(self, problem: Problem) -> None:
        """Raise InputError if the planner does not take such a map."""
        if isinstance(self.planner, Particular):
            self.planner.check(problem)

    def optimum(self, problem: Problem) -> Plan:
        """Find a path of least cost, KG18 eq. (5).

        Parameters
        ----------
        problem : Problem
            Start and target on a known map.

        Returns
        -------
        Plan
            FOUND or INFEASIBLE.
        """
        return shortest_path(problem)

    def trials(self, batch: Batch, optimum: Plan) -> Iterator[Trial]:
        """Plan with the random streams (seed, `Batch.first`) to (seed, trials - 1).

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
        quantity = self.planner.minimises
        least = least_of(batch.problem, optimum, quantity)
        answers = plan_trials(
            batch.problem,
            optimum,
            self.planner,
            batch.seed,
            batch.trials,
            batch.threads,
            batch.first,
        )
        for answer in answers:
            row = PlanRow(**plan_values(batch, answer, optimum, quantity, least))
            events = partial(trial_events, answer, batch.seed)
            yield Trial(row, row.feasible, duration(answer.plan), events)

    def summary(self, rows: Rows) -> dict[str, object]:
        """Sum trials up for the terminal: label -> value."""
        found = rows["feasible"]
        count = len(found)
        if count == 1:
            return {"seed": rows["seed"][0], "status": rows["status"][0], **_effort(rows)}
        share = f"{found.sum()} ({100 * found.sum() / count:.1f} %)"
        lines: dict[str, object] = {"trials": count, "found": share}
        if rows["status"][0] != _INFEASIBLE:
            lines["optimal cost"] = f"{rows['optimal_cost'][0]:g}"
            lines["median time"] = median_time(rows)
        if found.any():
            lines["median cost"] = f"{np.median(rows['cost'][found]):g}, if found"
        epochs = rows["epochs"]
        if epochs.any():
            some = f"; {np.median(epochs[found]):g}, if found" if found.any() else ""
            lines["median epochs"] = f"{np.median(epochs):g}{some}"
        return lines

    def line(self, rows: Rows) -> str:
        """Sum trials up in one line."""
        found = rows["feasible"]
        if rows["status"][0] == _INFEASIBLE:
            return _no_path(rows)
        return f"{found.sum()} of {len(found)} found, median {median_time(rows)}"


def _effort(rows: Rows) -> dict[str, object]:
    """Tell what applies: a genetic algorithm has epochs, a graph search has expansions."""
    first = {name: rows[name][0] for name in ("status", "feasible", "cost", "optimal_cost")}
    if first["status"] == _INFEASIBLE:
        return {"reason": _no_path(rows)}
    lines: dict[str, object] = {}
    cost = first["cost"]
    if not math.isinf(cost):  # a search that counts no obstacles has no cost without a path
        lines["cost" if first["feasible"] else "best cost"] = f"{cost:g}"
    lines["optimal cost"] = f"{first['optimal_cost']:g}"
    length = rows["line_length"][0] if "line_length" in rows else math.nan
    if not math.isnan(length):
        lines["length"] = f"{length:.1f} fields in straight lines"
    if epochs := rows["epochs"][0]:
        lines |= {"epochs": epochs, "evaluations": rows["evaluations"][0]}
    if expansions := rows["expansions"][0]:
        lines["expansions"] = expansions
    return lines | {"time": median_time(rows)}


def _no_path(rows: Rows) -> str:
    if math.isinf(rows["optimal_cost"][0]):
        return "no path exists: the target cannot be reached from the start"
    return (
        "no path for the planner's robot and keypoints, one for a robot that is a point: try a "
        "smaller planner.robot_radius, or planner.keypoints=corners"
    )
