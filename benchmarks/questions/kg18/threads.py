"""1200 runs on two threads: how many times faster than on one, whatever their order.

100 seeds of Table 1's twelve settings, wall seconds of the planning alone. In the first three rows
a job is a batch of ten runs, taken by whichever thread is free: the fast maps first, the slow ones
first, mixed. In the next the settings come one after the other and each plans its trials as a run
with ``threads=2`` does. Costs are the same on any number of threads, or this stops. The last row is
what the machine gives: two batches of map 4, one for each thread, with hardly any Python.
"""

import os
import random
from collections.abc import Callable
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from benchmarks.measure import (
    MAPS,
    SETTINGS,
    Calls,
    Row,
    interleave,
    make_bspline_ga,
    make_problem,
    quartiles,
    ratios,
)
from gapath.kernels.rng import stream
from gapath.planners.bspline_ga import Planner
from gapath.planning.shortest_path import shortest_path
from gapath.planning.simulation import plan_trials
from gapath.planning.threads import in_order
from gapath.problem import Problem

Setting: TypeAlias = tuple[Problem, Planner]
Job: TypeAlias = tuple[Problem, Planner, range]

RUNS = 10
"""Runs of a job."""

MACHINE = "two batches, hardly any Python"


def plan(job: Job) -> list[float]:
    """Do the runs of a job; give their costs."""
    problem, planner, seeds = job
    plans = planner.plan_many(problem, np.array([stream(seed) for seed in seeds]))
    return [plan.cost for plan in plans]


def as_jobs(jobs: list[Job], threads: int) -> list[list[float]]:
    return list(in_order(plan, jobs, threads))


def as_runs(settings: list[Setting], seeds: int, threads: int) -> list[float]:
    return [
        answer.plan.cost
        for problem, planner in settings
        for answer in plan_trials(problem, shortest_path(problem), planner, 0, seeds, threads)
    ]


def measure(quick: bool) -> list[Row]:
    if (os.cpu_count() or 1) < 2:
        return [{"order": "any", "one / two": "skipped: one processor"}]
    seeds, rounds = (RUNS, 1) if quick else (100, 7)
    settings = [(make_problem(name), make_bspline_ga(ga)) for name in MAPS for ga in SETTINGS]
    batches = [range(first, first + RUNS) for first in range(0, seeds, RUNS)]
    fast_first = [(*setting, batch) for setting in settings for batch in batches]
    mixed = random.Random(0).sample(fast_first, len(fast_first))
    heavy = [(*settings[-1], range(seeds))] * 2
    orders: dict[str, Callable[[int], Any]] = {
        "fast ones first": partial(as_jobs, fast_first),
        "slow ones first": partial(as_jobs, fast_first[::-1]),
        "mixed": partial(as_jobs, mixed),
        "setting by setting, as runs": partial(as_runs, settings, seeds),
        MACHINE: partial(as_jobs, heavy),
    }
    calls: Calls = {}
    for order, work in orders.items():
        calls |= {f"{order}, {threads}": partial(work, threads) for threads in (1, 2)}
    times, results = interleave([calls] * (1 + rounds))
    rows: list[Row] = []
    for order in orders:
        one, two = f"{order}, 1", f"{order}, 2"
        if any(found[one] != found[two] for found in results):
            raise RuntimeError(f"{order}: two threads plan otherwise than one")
        runs = 2 * seeds if order == MACHINE else seeds * len(settings)
        row: Row = {"order": order, "runs": runs}
        row["one thread s"] = quartiles([t / 1e6 for t in times[one]])
        row["two threads s"] = quartiles([t / 1e6 for t in times[two]])
        name = "what the machine gives" if order == MACHINE else "one / two"
        rows.append(row | {name: ratios(times[one], times[two])})
    return rows
