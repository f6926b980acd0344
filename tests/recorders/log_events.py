"""A small run's events, their log, and a comparison bit by bit."""

import dataclasses
import math
import struct
from pathlib import Path

import numpy as np

from gapath.events import Evolved, RunFinished, RunStarted, TrialFinished, TrialStarted
from gapath.grid import GridMap
from gapath.problem import Evolution, PlanStatus, Problem
from gapath.recorders import mcap


def plain(value):
    """Turn an event into something that == compares bit by bit."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, float):
        return "nan" if math.isnan(value) else struct.pack("<d", value)
    if dataclasses.is_dataclass(value):
        fields = dataclasses.fields(value)
        return type(value), [plain(getattr(value, field.name)) for field in fields]
    if isinstance(value, tuple):
        return type(value), [plain(item) for item in value]
    return type(value), value


def example(trials=6, epochs=8):
    """Give the events of a small run that makes sense."""
    rng = np.random.default_rng(5)
    weights = rng.random((7, 9)).round(2)
    weights[3, 2:7] = 1.0
    weights[0, 0] = weights[6, 8] = 0.0
    grid = GridMap("Übung 3", weights, (0, 0), (8, 6), origin=(1.0, -2.0, 0.5), resolution=0.05)
    path = np.array([[0, 0], [1, 1], [1, 2]], dtype=np.int32)
    run = RunStarted(
        "table1", "ga3", Problem(grid, (0, 0), (8, 6)), 7, trials, "planner:\n  kind: ga\n",
        {"gapath": "0.1.0", "numpy": "2.4.6"}, path, 2.5,
    )  # fmt: skip
    events, step = [run], 0
    for trial in range(trials):
        found = trial % 3 > 0
        evolution = Evolution(
            rng.random(epochs),
            rng.random(epochs),
            rng.integers(0, 9, (epochs, 8), dtype=np.int32),
            rng.integers(0, 9, (epochs, 5, 2), dtype=np.int32),
            "control_points",
        )
        status = PlanStatus.FOUND if found else PlanStatus.NOT_FOUND
        events.append(TrialStarted(step, trial, 7))
        events.append(Evolved(step, trial, 0, evolution))
        step += epochs
        walked = path if found else path[:0]
        events.append(TrialFinished(step, trial, status, 1.5, epochs, 40 * epochs, 0, walked))
    events.append(RunFinished(step, trials, sum(trial % 3 > 0 for trial in range(trials))))
    return events


def write(events, folder, flush_every=100):
    recorder = mcap.Recorder(flush_every=flush_every)
    recorder.open(str(folder))
    for event in events:
        recorder.record(event)
    assert recorder.close() == ["run.mcap"]
    return Path(folder) / "run.mcap"
