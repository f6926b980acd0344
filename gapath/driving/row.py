"""A drive summed up as a row of ``trials.parquet``."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gapath.driving.drive import Drive, Frame
from gapath.events import Mode, Outcome
from gapath.planning.metrics import path_metrics
from gapath.problem import Plan
from gapath.task import Batch


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
        `gapath.planning.metrics.clearances` of the true map.

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
