"""What the rows of planning queries hold."""

import json
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gapath.planning.path import octile_length
from gapath.planning.shortest_path import shortest_path
from gapath.planning.simulation import TimedPlan
from gapath.problem import Plan, Problem
from gapath.task import Batch, Row, Rows, head


@dataclass(frozen=True)
class PlanRow(Row):
    """A row of ``trials.parquet``: a planning query; failures are rows too.

    `optimality_ratio` is how much the path has of what the planner minimises over the least there
    is: of the weights, or of the octile length; NaN where the least is not known. `cost` of a
    failure is the planner's best fitness, obstacles counted as VLN, `obstacles` how many there are
    on its best path; `stage_times_s` gives the wall time of each stage of a planner that has
    stages, as JSON.
    """

    planner: str
    status: str
    feasible: bool
    cost: float
    obstacles: int
    optimal_cost: float
    minimises: str
    optimality_ratio: float
    epochs: int
    evaluations: int
    expansions: int
    plan_time_s: float
    stage_times_s: str


def least_of(problem: Problem, optimum: Plan, quantity: str) -> float:
    """Give the least of what a planner minimises.

    Parameters
    ----------
    problem : Problem
        What is asked.
    optimum : Plan
        A path of least cost, or none.
    quantity : str
        `gapath.planning.planner.Planner.minimises`.

    Returns
    -------
    float
        NaN if there is no path or nobody knows.
    """
    if optimum.feasible and quantity == "length":
        optimum = shortest_path(problem, by_length=True)
    return _amount(optimum, quantity)


def _amount(plan: Plan, quantity: str) -> float:
    if not plan.feasible:
        return math.nan
    return {"weights": plan.cost, "length": octile_length(plan.path)}.get(quantity, math.nan)


def plan_values(
    batch: Batch, answer: TimedPlan, optimum: Plan, quantity: str, least: float
) -> dict[str, Any]:
    """Give the fields of `PlanRow` for a trial.

    Parameters
    ----------
    batch : Batch
        What its trials share.
    answer : TimedPlan
        The planner's answer.
    optimum : Plan
        A path of least cost, or none.
    quantity : str
        What the planner minimises.
    least : float
        As `least_of` gives it.

    Returns
    -------
    dict
        Field -> value.
    """
    plan = answer.plan
    return head(batch, answer.number, plan) | {
        "planner": batch.method,
        "status": plan.status.name.lower(),
        "feasible": plan.feasible,
        "cost": plan.cost,
        "obstacles": plan.obstacles,
        "optimal_cost": optimum.cost,
        "minimises": quantity,
        "optimality_ratio": _amount(plan, quantity) / least if least else math.nan,
        "epochs": plan.epochs,
        "evaluations": plan.evaluations,
        "expansions": plan.expansions,
        "plan_time_s": answer.plan_time_s,
        "stage_times_s": json.dumps(dict(plan.stages)) if plan.stages else "{}",
    }


def median_time(rows: Rows) -> str:
    """Write the median time of planners' calls for people, of those that were made."""
    times = rows["plan_time_s"]
    known = times[~np.isnan(times)]
    return f"{1000 * np.median(known):.3g} ms" if len(known) else "none, nothing was planned"
