"""A small run's events, their log, and a comparison bit by bit."""

import dataclasses
import math
import struct
from pathlib import Path
from unittest.mock import patch

import numpy as np
from gapath_example import bender

from gapath.driving.drive import Driven, Leg, Sensor
from gapath.driving.known_map import Looks
from gapath.driving.navigation import Call, Decision
from gapath.driving.told import drive_events
from gapath.events import (
    Evolved,
    Mode,
    Outcome,
    RunFinished,
    RunStarted,
    Surveyed,
    TrialFinished,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.history.evolution import Evolution
from gapath.history.graph import Graph
from gapath.planning.shortest_path import shortest_path
from gapath.planning.simulation import plan_trials
from gapath.problem import Answer, Plan, PlanStatus, Problem
from gapath.recorders import mcap
from gapath.recorders.mcap import log
from gapath.tasks.plan import duration, trial_events


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
        "table1", "ga3", "plan", Problem(grid, (0, 0), (8, 6)), 7, trials, {"planner.kind": "ga"},
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
        if trial == 0:
            graph = Graph(
                rng.random((4, 5)) < 0.3,
                2,
                rng.integers(0, 7, (6, 2), dtype=np.int32),
                np.array([[0, 1], [1, 5]], dtype=np.int32),
            )
            events.append(Surveyed(step, trial, graph))
        events.append(Evolved(step, trial, 0, evolution))
        step += epochs
        walked = path if found else path[:0]
        obstacles = 0 if found else 2
        answer = Answer(status, walked, 1.5, obstacles, 100.0, epochs, 40 * epochs)
        events.append(TrialFinished(step, trial, answer))
    events.append(RunFinished(step, trials, sum(trial % 3 > 0 for trial in range(trials))))
    return events


def example_drives(trials=2):
    """Give the events of drives that find no way, go back, and then reach the target.

    The map is 9 x 7 and its row 3 blocked but for both ends; the robot goes from (0, 0)
    to (8, 6) with a sensor of range 1.
    """
    run = dataclasses.replace(
        example(trials)[0], experiment="drives", method="kg18", task="drive", settings=SETTINGS
    )
    events, step = [run], 0
    for trial in range(trials):
        driven = _drive(run.problem.map, trial)
        events += drive_events(driven, run.problem.map.cols, 7, trial, step)
        step += len(driven.frames)
    events.append(RunFinished(step, trials, 1))
    return events


def example_memetic(trials=3):
    """Give the events of a run whose genetic algorithm tells what its population took in.

    The map is that of `example`, its row 3 blocked but for both ends.
    """
    planner = bender.Planner(individuals=3, epochs=12, tries=40)
    run = dataclasses.replace(example(trials)[0], experiment="plan", method="bender")
    problem, events, step = run.problem, [run], 0
    for answer in plan_trials(problem, shortest_path(problem), planner, 7, trials):
        events += trial_events(answer, 7, step)
        step += duration(answer.plan)
    return [*events, RunFinished(step, trials, trials)]


SETTINGS = {"task": "drive", "navigator.kind": "kg18"}  # readers take what they need from events


def _drive(grid, trial):
    """Drive by hand: three steps towards (3, 2), back to (1, 1), then to (8, 6)."""
    first = np.array([[0, 0], [1, 1], [2, 2], [3, 3], [4, 4]], dtype=np.int32)
    second = np.array([[1, 1], [1, 2], [0, 3], [1, 4], [2, 5], [3, 6], [4, 6]], dtype=np.int32)
    found = Plan(PlanStatus.FOUND, first, 2.0, epochs=3, evaluations=40)
    failed = Plan(PlanStatus.NOT_FOUND, first[:0], 0.0, 3, 1e5, epochs=9, evaluations=90)
    better = Plan(PlanStatus.FOUND, second, 3.5, epochs=2, evaluations=30)
    explore, replan, back = Mode.EXPLORE, Mode.REPLAN, Mode.RETURN
    trail = [tuple(place) for place in first[:3].tolist()]
    way = second.tolist()
    decisions = [
        ((1, 1), replan, [Call("C", 0, found, True)], first, trail[:1]),
        ((2, 2), explore, [Call("B", 0, failed, False)], first[1:], trail[:2]),
        ((2, 2), explore, [], first[2:], trail),
        ((1, 1), back, [Call("C", i, failed, False) for i in (0, 1)], None, trail),
        ((1, 2), explore, [Call("A", 0, better, True)], second, trail[:2]),
        *((tuple(way[i + 1]), explore, [], second[i:], [*trail[:2], *map(tuple, way[1 : i + 1])])
          for i in range(1, 3 + 3 * (trial == 0))),
    ]  # fmt: skip
    place, seen, legs = (0, 0), set(), []
    for heading, decision in enumerate([None, *decisions]):
        if decision is not None:
            target, mode, calls, path, past = decision
            decision = Decision(target, mode, None, None, tuple(calls), path, tuple(past))
            place = target
        x, y = place
        near = {v * 9 + u for u in range(x - 1, x + 2) for v in range(y - 1, y + 2)
                if 0 <= u < 9 and 0 <= v < 7}  # fmt: skip
        news = np.array(sorted(near - seen), dtype=np.int64)
        seen |= near
        entries = grid.table.ravel()[news]
        looks = Looks([heading % 8], [len(news)], np.stack([news, entries]))
        legs.append(Leg(decision, looks, (place,), 1e-5 * (heading + 1)))
    outcome = Outcome.REACHED if trial == 0 else Outcome.OVERRAN
    return Driven(Sensor(1, False), 100, 0.5, outcome, legs, 1e-3)


def logged(event):
    """Give an event as the log has it: without its wall time."""
    return dataclasses.replace(event, seconds=math.nan) if hasattr(event, "seconds") else event


def write(events, folder, chunk_messages=100):
    with patch.object(log, "CHUNK_MESSAGES", chunk_messages):
        return _write(events, folder)


def _write(events, folder):
    recorder = mcap.Recorder(step_s=0.1)
    recorder.open(str(folder))
    for event in events:
        recorder.record(event)
    assert recorder.close() == ["run.mcap", "metadata.yaml"]
    return Path(folder) / "run.mcap"


def write_as(form, events, path):
    """Write a log of another form, such as an earlier one."""
    with path.open("wb") as file:
        writer = log.LogWriter(file, form)
        for event in events:
            for _ in writer.write(event):
                pass
        writer.finish()
    return path
