"""Drives through KG18's four unknown maps: how long, what takes the time, what recording costs.

- A drive: `compute_time_s` of each navigator, on the same drives in turn: looking and deciding, but
  not what is made of a drive for its log.
  The targets on map 1 are 2 ms for kg18 and 1 ms for kg18_fast. "paper / drive" is 1.4 s, where
  the paper's axis for map 1 begins, by ours. "outside planners" is the share of kg18's time that
  its planners' `plan` did not take.
- Logs: 100 drives a map with kg18 through `gapath.running.experiment.execute`, wall seconds in one
  process, run folder with `run.mcap` included; "rest" is what is not driving: the log, metrics,
  tables, files. The target for all four is 20 s on two cores.
- A recording: `trial-0.rrd` of 500 steps from their events, Rerun imported (targets 0.3 s, 1 MB).
"""

import itertools
import tempfile
import time
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import yaml

from benchmarks.measure import Calls, Row, interleave, make_problem, quartiles, timed
from gapath.components import build, expanded
from gapath.discovery import yaml_values
from gapath.driving.drive import Driven, Sensor, drive
from gapath.driving.navigation import Situation
from gapath.driving.told import drive_events
from gapath.events import Outcome
from gapath.kernels.rng import Stream
from gapath.planning.planner import Planner
from gapath.problem import Plan, Problem
from gapath.recorders import mcap, rerun
from gapath.running.config import Run, conf_folder
from gapath.running.experiment import execute, run_started
from gapath.running.naming import Method
from gapath.store.settings import flatten
from gapath.tasks.drive import Task as DriveTask
from gapath.tasks.drive import usual_limit

MAPS = ("kg18_map1", "kg18_map2", "kg18_map3", "kg18_map4")
NAVIGATORS = ("kg18", "kg18_fast", "kg18_astar", "replan_astar", "dstar_lite", "straight_astar")
PAPER_S = 1.4
RECORDED_STEPS = 500


@dataclass
class Clock:
    """A planner, and the seconds that its calls took."""

    planner: Planner
    seconds: float = 0.0

    exact = False
    minimises = "weights"

    def plan(self, query: Situation, stream: Stream) -> Plan:
        """Plan as the planner does."""
        begin = time.perf_counter()
        plan = self.planner.plan(query, stream)
        self.seconds += time.perf_counter() - begin
        return plan


def make_drive_run(map_name: str, navigator: str, trials: int) -> Run:
    """Make a run without recorders, the drive's settings as in ``conf/config.yaml``."""
    plain = yaml.safe_load(Path(conf_folder(), "config.yaml").read_text("utf-8"))
    values = yaml_values("navigator", navigator)
    given = {group: plain.get(group, values) for group in DriveTask.groups}
    settings = flatten({"task": DriveTask.name, **expanded(given, "")})
    method, task = Method(navigator), DriveTask.make(given)
    return Run("drives", method, make_problem(map_name), task, [], 0, trials, settings, "", False)


def task_of(run: Run) -> DriveTask:
    """Give the task of a run that drives."""
    assert isinstance(run.task, DriveTask)
    return run.task


def drive_once(task: DriveTask, problem: Problem, trial: int) -> Driven:
    """Drive as a trial of seed 0 does."""
    limit = task.step_limit or usual_limit(problem.map.rows * problem.map.cols)
    limits = (limit, task.unknown_weight)
    return drive(problem, task.navigator, task.sensor, task.changes, 0, trial, *limits)


def drive_clocked(task: DriveTask, problem: Problem, trial: int) -> tuple[Driven, float]:
    """Drive with kg18 and give the share of the time that its planners did not take."""
    nav: Any = task.navigator
    retreat, explore, *replan = clocks = [*map(Clock, (nav.retreat, nav.explore, *nav.replan))]
    nav = replace(nav, retreat=retreat, explore=explore, replan=tuple(replan))
    driven = drive_once(replace(task, navigator=nav), problem, trial)
    return driven, 1 - sum(clock.seconds for clock in clocks) / driven.compute_time_s


def time_drives(map_name: str, trials: int) -> list[Row]:
    """Time every navigator on the same drives, one after the other."""
    problem = make_problem(map_name)
    tasks = {name: task_of(make_drive_run(map_name, name, 1)) for name in NAVIGATORS}

    def rivals(trial: int) -> Calls:
        plain = {name: partial(drive_once, task, problem, trial) for name, task in tasks.items()}
        return {**plain, "clocked": partial(drive_clocked, tasks["kg18"], problem, trial)}

    _, results = interleave([rivals(trial) for trial in (0, *range(trials))])
    for found in results:
        plain, clocked = found["kg18"].frames, found["clocked"][0].frames
        if [frame.place for frame in plain] != [frame.place for frame in clocked]:
            raise RuntimeError(f"{map_name}: clocks around the planners changed a drive")
    rows: list[Row] = []
    for name in NAVIGATORS:
        driven = [found[name] for found in results]
        reached = sum(d.outcome is Outcome.REACHED for d in driven)
        row: Row = {"map": map_name, "navigator": name, "drives": trials, "reached": reached}
        row["steps"] = quartiles([len(d.frames) - 1 for d in driven])
        row["drive ms"] = quartiles([1e3 * d.compute_time_s for d in driven])
        if map_name == MAPS[0]:
            row["paper / drive"] = quartiles([PAPER_S / d.compute_time_s for d in driven])
        if name == "kg18":
            row["outside planners"] = quartiles([found["clocked"][1] for found in results])
        rows.append(row)
    return rows


def time_logs(map_name: str, trials: int) -> Row:
    """Time drives with kg18 and their log."""
    log = build("recorder", yaml_values("recorder", "mcap"), "recorder")
    with tempfile.TemporaryDirectory() as folder:
        run = replace(make_drive_run(map_name, "kg18", trials), recorders=[log], output=folder)
        microseconds, execution = timed(lambda: execute(run, "", progress=False))
        size = (execution.folder / mcap.FILE).stat().st_size / 1e6
        driving = float(execution.rows["compute_time_s"].sum())
    total = microseconds / 1e6
    row: Row = {"map": map_name, "navigator": "kg18", "drives": trials}
    return row | {"total s": total, "driving s": driving, "rest s": total - driving, "log MB": size}


def time_recording(times: int) -> Row:
    """Time the recording of the first drive of range 1 on map 4 that is long enough."""
    run = make_drive_run(MAPS[-1], "kg18", trials=1)
    task = replace(task_of(run), sensor=Sensor(1, False), step_limit=RECORDED_STEPS)
    drives = map(partial(drive_once, task, run.problem), itertools.count())
    driven = next(d for d in drives if len(d.frames) == RECORDED_STEPS + 1)
    begin = run_started(run, task.optimum(run.problem))
    events = [begin, *drive_events(driven, run.problem.map.cols, 0, 0, 0)]

    def record(folder: str) -> float:
        recorder = rerun.Recorder(trials=[0])
        recorder.open(folder)
        for event in events:
            recorder.record(event)
        return (Path(folder) / recorder.close()[0]).stat().st_size / 1e6

    with tempfile.TemporaryDirectory() as folder:
        made = [timed(lambda: record(folder)) for _ in range(times + 1)][1:]  # the first imports
    row: Row = {"map": MAPS[-1], "navigator": "kg18", "drives": 1, "steps": RECORDED_STEPS}
    row["recording s"] = quartiles([microseconds / 1e6 for microseconds, _ in made])
    return row | {"recording MB": made[-1][1]}


def measure(quick: bool) -> list[Row]:
    trials = 3 if quick else 100
    rows = [row for name in MAPS for row in time_drives(name, trials)]
    time_logs(MAPS[0], 2)  # start-up
    logs = [time_logs(name, trials) for name in MAPS]
    total: Row = {"map": "all", "navigator": "kg18"}
    total |= {key: sum(row[key] for row in logs) for key in list(logs[0])[2:]}
    return [*rows, *logs, total, time_recording(2 if quick else 20)]
