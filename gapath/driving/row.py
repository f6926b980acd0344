"""A drive summed up as a row of ``trials.parquet``."""

import math
from dataclasses import dataclass

import numpy as np

from gapath.driving.drive import Driven
from gapath.events import Mode, Outcome
from gapath.planning.path import path_weights, without_stands
from gapath.problem import Plan, PlanStatus
from gapath.task import Batch, Row, head


@dataclass(frozen=True)
class DriveRow(Row):
    """A row of ``trials.parquet``: a drive; those that failed are rows too.

    `ga_calls` counts the genetic algorithm's runs, `calls_a` to `calls_c` the calls of any
    planner by part; `replans` counts the steps in which the current path had met an obstacle,
    `returns` how often return mode began, `stands` the steps without a move. `cost`, KG18 eq. (5),
    and the metrics are those of the fields that the robot passed, in order; the metrics and
    `length_ratio` are NaN unless it reached its target.
    """

    navigator: str
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
    compute_time_s: float


def drive_row(batch: Batch, trial: int, driven: Driven, optimum: Plan) -> DriveRow:
    """Sum a drive up.

    Parameters
    ----------
    batch : Batch
        Problem, seed, and names for the row.
    trial : int
        Number of the drive.
    driven : Driven
        The drive.
    optimum : Plan
        A path of fewest steps on the true map.

    Returns
    -------
    DriveRow
        Its row.
    """
    frames = driven.frames
    reached = driven.outcome is Outcome.REACHED
    trail = without_stands(np.array([frame.place for frame in frames], dtype=np.int32))
    status = PlanStatus.FOUND if reached else PlanStatus.NOT_FOUND
    passed = Plan(status, trail, path_weights(batch.problem.map, trail))
    decisions = [frame.decision for frame in frames if frame.decision]
    calls = [call for decision in decisions for call in decision.calls]
    modes = [decision.mode for decision in decisions]
    parts = [call.part for call in calls]
    steps = len(frames) - 1
    shortest = len(optimum.path) - 1 if optimum.feasible else math.nan
    return DriveRow(
        **head(batch, trial, passed),
        navigator=batch.method,
        outcome=driven.outcome.name.lower(),
        reached=reached,
        steps=steps,
        shortest_steps=shortest,
        steps_ratio=steps / shortest if reached and shortest else math.nan,
        ga_calls=sum(call.plan.evaluations > 0 for call in calls),
        calls_a=parts.count("A"),
        calls_b=parts.count("B"),
        calls_c=parts.count("C"),
        replans=sum(any(c.part == "C" for c in decision.calls) for decision in decisions),
        returns=sum(
            now is Mode.RETURN and before is not Mode.RETURN
            for before, now in zip([Mode.EXPLORE, *modes], modes, strict=False)
        ),
        stands=steps - (len(trail) - 1),
        evaluations=sum(call.plan.evaluations for call in calls),
        seen_fields=len(np.unique(np.concatenate([frame.news for frame in frames]))),
        cost=passed.cost,
        compute_time_s=driven.compute_time_s,
    )
