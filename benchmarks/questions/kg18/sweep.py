"""Table 1 as a sweep, every epoch logged: how long on two threads, and what takes the time on one.

1000 seeds x 12 settings through `gapath.running.experiment.execute`, in wall seconds past start-up,
run folder with `run.mcap` included. "total" is with ``threads=2``, and its target is 12 s for all.
On one thread every setting runs a second time without a recorder: "logging" is the difference,
"rest" is what else is not planning (checks, metrics, tables, files).
"""

import tempfile
import time
from dataclasses import replace

from benchmarks.measure import MAPS, SETTINGS, Row, make_planner, make_problem
from gapath.discovery import yaml_values
from gapath.events import Recorder
from gapath.problem import Problem
from gapath.recorders import mcap
from gapath.running.config import Run
from gapath.running.experiment import execute
from gapath.running.naming import Method
from gapath.store.settings import flatten
from gapath.tasks.plan import Task as PlanTask


def _execute(run: Run, recorders: list[Recorder]) -> tuple[float, float]:
    """Execute a run in a temporary folder; give its wall time and its planning time, s."""
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        execution = execute(replace(run, recorders=recorders, output=folder), "", progress=False)
        seconds = time.perf_counter() - begin
        planning = execution.rows["plan_time_s"].sum()
    return seconds, float(planning)


def _run(problem: Problem, name: str, trials: int, threads: int) -> Run:
    values = yaml_values("planner", name)
    settings = flatten({"task": PlanTask.name, "planner": values, "trials": trials})
    task = PlanTask(make_planner(name))
    return Run("sweep", Method(name), problem, task, [], 0, trials, settings, "", False, threads)


def measure(quick: bool) -> list[Row]:
    trials = 20 if quick else 1000
    rows: list[Row] = []
    recorder = mcap.Recorder(step_s=0.1)
    _execute(_run(make_problem(MAPS[0]), SETTINGS[0], 2, 1), [recorder])  # start-up
    for problem in map(make_problem, MAPS):
        for name in SETTINGS:
            two, _ = _execute(_run(problem, name, trials, 2), [recorder])
            run = _run(problem, name, trials, 1)
            one, planning = _execute(run, [recorder])
            bare, bare_planning = _execute(run, [])
            rest = bare - bare_planning
            rows.append(
                {
                    "map": problem.map.name,
                    "planner": name,
                    "trials": trials,
                    "total s": two,
                    "one thread s": one,
                    "planning s": planning,
                    "logging s": one - planning - rest,
                    "rest s": rest,
                }
            )
    sums = {key: sum(row[key] for row in rows) for key in list(rows[0])[2:]}
    return [*rows, {"map": "all", "planner": "all", **sums}]
