"""What a call costs beyond its kernel, and the memory that it takes.

Microseconds of the thread on KG18's fourth known map, 100 x 50 fields, in turn: the kernel alone,
where it can be called by itself; `Planner.plan`, which makes a plan of it; and `gapath.plan`, as a
user calls it by the planner's name.

Memory: the peak of a process while it plans for the first time on a generated map of noise of 2000
x 1000 fields, diagonally as `field_large` does, above what it held with the map read, over the
fields (Linux only; kernels are compiled and have run on a small map). The path's own fields count.
"""

import os
import subprocess
import sys
from functools import partial
from pathlib import Path

import gapath
from benchmarks.field import KERNELS, contenders, least_times
from benchmarks.measure import Calls, Row, make_problem, quartiles
from benchmarks.questions.field.field_large import diagonal
from gapath.kernels.rng import stream
from gapath.planning.planner import Planner
from gapath.problem import Problem

MAP = "kg18_test4"
PLANNERS = ("memetic", "memetic_quality", "jps", "astar")
NOISE = "field_noise"

_ALONE = """
import sys
from pathlib import Path
import gapath

planner, *ends = sys.argv[1], *map(int, sys.argv[2:])
start, target = ends[:2], ends[2:]

def held(name):
    text = Path("/proc/self/status").read_text()
    return 1024 * int(text.partition(name + ":")[2].split()[0])

gapath.plan(gapath.load_map("field_noise", width=100, height=50), planner=planner)
grid = gapath.load_map("field_noise")
grid.joined(start, target, 0)
gapath.plan(grid, start, start, planner="astar")  # what a map makes once is there
Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
before = held("VmRSS")
plan = gapath.plan(grid, start, target, planner=planner)
print((held("VmHWM") - before) / grid.weights.size, int(plan.feasible))
"""


def time_calls(problem: Problem, name: str, planner: Planner, rounds: int) -> Row:
    """Time the three ways to call a planner."""
    prepare = KERNELS.get(type(planner))

    def calls(seed: int) -> Calls:
        kernel: Calls = {"kernel us": prepare(planner, problem, stream(seed))} if prepare else {}
        return kernel | {
            "planner.plan us": partial(planner.plan, problem, stream(seed)),
            "gapath.plan us": partial(gapath.plan, problem.map, planner=name, seed=seed),
        }

    times = [least_times(partial(calls, seed), takes=1)[0] for seed in (0, *range(rounds))][1:]
    row: Row = {way: quartiles([taken[way] for taken in times]) for way in calls(0)}
    inner = "kernel us" if prepare else "planner.plan us"
    more = quartiles([taken["gapath.plan us"] - taken[inner] for taken in times])
    return row | {f"gapath.plan - {inner}": more}


def memory(name: str) -> Row:
    """Measure what a planner holds, in a process of its own."""
    problem = diagonal(gapath.load_map(NOISE))
    if not Path("/proc/self/clear_refs").exists():
        return {"bytes a field": "skipped: this system has no /proc/self/clear_refs"}
    # what is freed goes back to the system, so nothing is hidden in what was held before
    environment = {**os.environ, "MALLOC_MMAP_THRESHOLD_": "65536", "MALLOC_TRIM_THRESHOLD_": "0"}
    ends = map(str, (*problem.start, *problem.target))
    done = subprocess.run([sys.executable, "-c", _ALONE, name, *ends], check=True,
                          capture_output=True, text=True, env=environment)  # fmt: skip
    held, found = done.stdout.split()
    return {"found": int(found), "bytes a field": float(held)}


def measure(quick: bool) -> list[Row]:
    problem, rounds = make_problem(MAP), 3 if quick else 300
    rows: list[Row] = []
    for name, planner in contenders(PLANNERS).items():
        row: Row = {"work": "a call", "map": MAP, "planner": name}
        if isinstance(planner, str):
            rows.append(row | {"planner.plan us": planner})
            continue
        rows.append(row | time_calls(problem, name, planner, rounds))
        rows.append({"work": "memory", "map": NOISE, "planner": name} | memory(name))
    return rows
