"""What logging a trial costs, by its number of epochs.

Microseconds from a finished plan to its messages in `run.mcap`: the history's way points,
encoding, checksums, compression, flushes; not the file's end. Real trials of GA 1, in batches
of about as many epochs each, one batch of each kind in turn. The last two rows are the fit
a + b epochs (least squares of relative errors); the target is a <= 60 and b <= 1.
"""

import statistics
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.measure import Row, make_planner, make_problem, quartiles, timed
from gapath.kernels.rng import stream
from gapath.planning.shortest_path import shortest_path
from gapath.planning.simulation import TimedPlan
from gapath.querying.told import trial_events
from gapath.recorders import mcap
from gapath.running.config import Run
from gapath.running.experiment import run_started
from gapath.running.naming import Method
from gapath.tasks.plan import Task as PlanTask

KINDS = (
    ("kg18_test1", 1, 1),
    ("kg18_test3", 8, 12),
    ("kg18_test3", 60, 160),
    ("kg18_test4", 500, 500),
)
"""Trials with so many epochs: map, least, most."""

BATCH = 100
"""Trials timed together: the log is flushed every four hundred messages, some hundred trials."""


class TrialLog:
    """Trials of one kind and the log that they go to."""

    def __init__(self, map_name: str, least: int, most: int, folder: str) -> None:
        problem, planner = make_problem(map_name), make_planner("ga1")
        self.trials: list[TimedPlan] = []
        number = 0
        while len(self.trials) < BATCH:
            plan = planner.plan(problem, stream(0, number))
            if least <= plan.epochs <= most:
                self.trials.append(TimedPlan(number, plan, 0.0))
            number += 1
        run = Run(
            "logging", Method("ga1"), problem, PlanTask(planner), [], 0, BATCH, {}, folder, False
        )
        self.recorder = mcap.Recorder(step_s=0.1)
        self.recorder.open(folder)
        self.recorder.record(run_started(run, shortest_path(problem)))

    def time(self) -> float:
        """Log every trial; give the mean time of one, microseconds."""
        fresh = [replace(trial, plan=replace(trial.plan)) for trial in self.trials]  # no history
        return timed(lambda: self._record(fresh))[0] / BATCH

    def _record(self, trials: list[TimedPlan]) -> None:
        for trial in trials:
            for event in trial_events(trial, 0, 0):
                self.recorder.record(event)


def measure(quick: bool) -> list[Row]:
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as folder:
        logs = []
        for i, kind in enumerate(KINDS):
            place = Path(folder) / str(i)
            place.mkdir()
            logs.append(TrialLog(*kind, str(place)))
        times = [[log.time() for log in logs] for _ in range(4 if quick else 41)][1:]
        for log in logs:
            log.recorder.close()
    for kind, log, sample in zip(KINDS, logs, zip(*times, strict=True), strict=True):
        epochs = statistics.mean(trial.plan.epochs for trial in log.trials)
        rows.append({"map": kind[0], "epochs": epochs, "us a trial": quartiles(sample)})
    medians = np.array([row["us a trial"].median for row in rows])
    slope, constant = np.polyfit([row["epochs"] for row in rows], medians, 1, w=1 / medians)
    rows.append({"map": "fit: a trial (a)", "us a trial": float(constant)})
    rows.append({"map": "fit: an epoch (b)", "us a trial": float(slope)})
    return rows
