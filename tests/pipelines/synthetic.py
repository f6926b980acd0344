"""Maps, trials, drives and logs that are made up, for the run folders of `conftest`."""

from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml

from gapath.components import expanded
from gapath.discovery import yaml_values
from gapath.events import (
    Called,
    DriveFinished,
    Evolved,
    Mode,
    Outcome,
    RunFinished,
    RunStarted,
    Stepped,
    TrialFinished,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.history.evolution import Evolution
from gapath.problem import Answer, PlanStatus, Problem
from gapath.recorders.mcap import Recorder
from gapath.store.settings import flatten

MAPS = ("kg18_test1", "kg18_test2", "kg18_test3", "kg18_test4")
PLANNERS = ("ga1", "ga2", "ga3", "astar", "dijkstra")
SUCCESS = {"kg18_test3": {"ga1": 0.8, "ga2": 0.95}, "kg18_test4": dict.fromkeys(PLANNERS[:3], 0.0)}


def make_map(name: str, instance: int = 0) -> GridMap:
    weights = np.full((12, 24), 0.5)
    weights[2 : 5 + int(name[-1]), 6 + instance % 3] = 1.0
    weights[6:, 15] = 1.0
    weights[6, 1] = weights[6, 22] = 0.0
    return GridMap(name, weights, (1, 6), (22, 6), instance, "reconstructed")


def make_path(shift: int) -> np.ndarray:
    x = np.arange(1, 23)
    dip = np.minimum(np.minimum(x - 1, 22 - x), 4 + shift % 2)
    return np.stack([x, 6 - dip], axis=1).astype(np.int32)


NOTHING: Mapping[str, Any] = {}
METRICS = {
    "length": 25.0, "line_length": 24.5, "turns": 4, "clearance": 1.0, "curvature": 0.1,
    "angle_over_length": 0.1,
}  # fmt: skip


def make_trials(grid: GridMap, planner: str, experiment: str, seed: int, n: int) -> pd.DataFrame:
    random = np.random.default_rng([seed, grid.instance, len(planner), int(grid.name[-1])])
    is_ga = planner.startswith("ga")
    feasible = random.random(n) < SUCCESS.get(grid.name, {}).get(planner, 1.0)
    feasible = feasible if is_ga else np.ones(n, dtype=bool)
    epochs = np.where(feasible, random.geometric(0.3 / int(grid.name[-1]), n), 60) * is_ga
    cost = np.where(feasible, 11.5 + random.integers(0, 4, n), 200012.0)
    return pd.DataFrame({
        "experiment": experiment, "map": grid.name, "map_instance": grid.instance,
        "map_source": grid.source, "map_digest": grid.digest,
        "width": grid.cols, "height": grid.rows,
        "start": str(grid.start), "target": str(grid.target),
        "corner_cutting": "allow", "planner": planner, "seed": seed, "trial": np.arange(n),
        "status": np.where(feasible, "found", "not_found"), "feasible": feasible, "cost": cost,
        "optimal_cost": 11.0, "minimises": "weights",
        "optimality_ratio": np.where(feasible, cost / 11.0, np.nan),
        "published_length": np.nan, "length_ratio": np.nan,
        "obstacles": np.where(feasible, 0, 2), "epochs": epochs,
        "evaluations": epochs * 40, "expansions": 0 if is_ga else 200,
        "plan_time_s": 1e-5 + 4e-6 * epochs, "stage_times_s": "{}", **METRICS,
    })  # fmt: skip


def write_log(folder: Path, grid: GridMap, trials: pd.DataFrame) -> None:
    first = trials.iloc[0]
    problem = Problem(grid, grid.start, grid.target)
    recorder = Recorder(step_s=0.1)
    recorder.open(str(folder))
    recorder.record(
        RunStarted(
            first["experiment"],
            first["planner"],
            "plan",
            problem,
            int(first["seed"]),
            len(trials),
            plan_settings(first["planner"]),
            {"gapath": "0"},
            make_path(0),
            11.0,
        )
    )
    step = 0
    for row in trials.itertuples():
        recorder.record(TrialStarted(step, row.trial, row.seed))
        if row.epochs:
            best = np.linspace(1.2e6, row.cost, row.epochs)
            points = np.zeros((row.epochs, 5, 2), dtype=np.int32)
            evolution = Evolution(
                best, best + 1, np.zeros((row.epochs, 8), dtype=np.int32), points, "control_points"
            )
            recorder.record(Evolved(step, row.trial, 0, evolution))
        step += max(row.epochs, 1)
        path = make_path(row.trial) if row.feasible else np.empty((0, 2), dtype=np.int32)
        status = PlanStatus.FOUND if row.feasible else PlanStatus.NOT_FOUND
        weights = row.cost - 100000 * row.obstacles
        spent = row.epochs, row.evaluations, row.expansions
        answer = Answer(status, path, weights, row.obstacles, 100000, *spent)
        recorder.record(TrialFinished(step - 1, row.trial, answer))
    recorder.record(RunFinished(step, len(trials), int(trials["feasible"].sum())))
    recorder.close()


def make_drives(grid: GridMap, navigator: str, experiment: str, n: int) -> pd.DataFrame:
    random = np.random.default_rng([grid.instance, len(navigator), int(grid.name[-1])])
    is_ga = navigator.startswith("kg18")
    fails = is_ga and grid.name == "kg18_map4" and "astar" not in navigator
    reached = random.random(n) > 0.3 * fails * (grid.instance % 2 == 0)
    steps = 21 + random.integers(0, 5, n) * is_ga
    return pd.DataFrame({
        "experiment": experiment, "map": grid.name, "map_instance": grid.instance,
        "map_source": grid.source, "map_digest": grid.digest,
        "published_length": np.nan, "length_ratio": np.nan,
        "width": grid.cols, "height": grid.rows,
        "start": str(grid.start), "target": str(grid.target),
        "corner_cutting": "allow", "navigator": navigator, "seed": 0, "trial": np.arange(n),
        "outcome": np.where(reached, "reached", "returned"), "reached": reached,
        "steps": np.where(reached, steps, 60), "shortest_steps": 21.0,
        "steps_ratio": np.where(reached, steps / 21.0, np.nan), "ga_calls": 6,
        "calls_a": np.where(reached, 0, 9), "calls_b": 2 * is_ga, "calls_c": 4, "replans": 3,
        "returns": np.where(reached, 0, 1), "stands": 0, "evaluations": 4000 * is_ga,
        "seen_fields": 300, "cost": 11.5,
        "compute_time_s": (0.004 + 1e-5 * steps) * (10 if is_ga else 1), **METRICS,
    })  # fmt: skip


def plan_settings(preset: str, changes: Mapping[str, Any] = NOTHING) -> dict[str, Any]:
    values = flatten({"planner": expanded(yaml_values("planner", preset), "planner")})
    return {"task": "plan", **values, **changes}


def drive_settings(preset: str, changes: Mapping[str, Any] = NOTHING) -> dict[str, Any]:
    plain = yaml.safe_load((files("gapath.conf") / "config.yaml").read_text("utf-8"))
    own = {"task": "drive", "navigator": expanded(yaml_values("navigator", preset), "navigator")}
    return {**flatten(own | {"drive": plain["drive"]}), **changes}


def make_calls(i: int, step: int, row: Any) -> Iterator[Called]:
    """Call planners in a drive's first and fifth step; in the ninth of one that fails in vain."""

    def call(part: str, index: int, obstacles: int, evaluations: int, adopted: bool = False) -> Any:
        status = PlanStatus.NOT_FOUND if obstacles else PlanStatus.FOUND
        path = np.empty((0, 2), dtype=np.int32) if obstacles else make_path(0)
        answer = Answer(status, path, 11.5, obstacles, 100000, 10, evaluations)
        return Called(step, row.trial, part, index, adopted, answer)

    if i == 1:
        yield call("C", 0, 0, 1000, adopted=True)
    if i == 5:
        yield call("B", 0, 0, 400)
    if i == 9 and not row.reached:
        for index, obstacles in enumerate((1, 1, 2, 1)):
            yield call("C", index, obstacles, 2000)
        yield call("A", 0, 3, 600)


def write_drive_log(folder: Path, grid: GridMap, drives: pd.DataFrame) -> None:
    first = drives.iloc[0]
    problem = Problem(grid, grid.start, grid.target)
    recorder = Recorder(step_s=0.1)
    recorder.open(str(folder))
    recorder.record(
        RunStarted(
            first["experiment"], first["navigator"], "drive", problem, 0, len(drives),
            drive_settings(first["navigator"]), {"gapath": "0"}, make_path(0), 11.0,
        )
    )  # fmt: skip
    step = 0
    for row in drives.itertuples():
        recorder.record(TrialStarted(step, row.trial, row.seed))
        there = make_path(row.trial)
        path = there if row.reached else np.concatenate([there[:9], there[:8][::-1]])
        for i, (x, y) in enumerate(path.tolist()):
            for call in make_calls(i, step, row) if row.calls_b else ():
                recorder.record(call)
            recorder.record(
                Stepped(
                    step, row.trial, (x, y), 0, Mode.EXPLORE, np.array([[x, y]], dtype=np.int32),
                    np.array([5], dtype=np.int32), 1e-4,
                )
            )  # fmt: skip
            step += 1
        ended = Outcome(int(not row.reached))
        recorder.record(DriveFinished(step - 1, row.trial, ended, len(path) - 1, row.stands))
    recorder.record(RunFinished(step, len(drives), int(drives["reached"].sum())))
    recorder.close()
