"""1200 runs on two threads: how many times faster than on one, whatever their order.

100 seeds of Table 1's twelve settings, wall seconds of the planning alone. In the first three rows
each run is a job of its own, taken by whichever thread is free: the fast maps first, the slow
ones first, mixed. In the last one the settings come one after the other and each plans its trials
in batches, as a run with ``threads=2`` does. Plans are the same on any number of threads, or this
stops. The target is 1.9.
"""

import os
import random
from collections.abc import Callable
from functools import partial
from typing import Any

from benchmarks.measure import (
    MAPS,
    SETTINGS,
    Calls,
    Row,
    interleave,
    make_planner,
    make_problem,
    quartiles,
    ratios,
)
from gapath.graph import shortest_path
from gapath.problem import Planner, Problem
from gapath.rng import stream
from gapath.simulation import plan_trials
from gapath.threads import in_order

Setting = tuple[Problem, Planner]
Job = tuple[Problem, Planner, int]


def plan(job: Job) -> float:
    """Do one run; give its cost."""
    problem, planner, seed = job
    return planner.plan(problem, stream(seed)).cost


def as_jobs(jobs: list[Job], threads: int) -> list[float]:
    return list(in_order(plan, jobs, threads))


def as_batches(settings: list[Setting], seeds: int, threads: int) -> list[float]:
    return [
        answer.plan.cost
        for problem, planner in settings
        for answer in plan_trials(problem, shortest_path(problem), planner, 0, seeds, threads)
    ]


def measure(quick: bool) -> list[Row]:
    if (os.cpu_count() or 1) < 2:
        return [{"order": "any", "one / two": "skipped: one processor"}]
    seeds, rounds = (4, 1) if quick else (100, 5)
    settings = [(make_problem(name), make_planner(ga)) for name in MAPS for ga in SETTINGS]
    fast_first = [(*setting, seed) for setting in settings for seed in range(seeds)]
    mixed = random.Random(0).sample(fast_first, len(fast_first))
    orders: dict[str, Callable[..., Any]] = {
        "fast ones first": partial(as_jobs, fast_first),
        "slow ones first": partial(as_jobs, fast_first[::-1]),
        "mixed": partial(as_jobs, mixed),
        "setting by setting, in batches": partial(as_batches, settings, seeds),
    }
    rows = []
    for order, work in orders.items():
        calls: Calls = {"one": partial(work, 1), "two": partial(work, 2)}
        times, results = interleave([calls] * (1 + rounds))
        if any(found["one"] != found["two"] for found in results):
            raise RuntimeError(f"{order}: two threads plan otherwise than one")
        rows.append(
            {
                "order": order,
                "runs": len(fast_first),
                "one thread s": quartiles([t / 1e6 for t in times["one"]]),
                "two threads s": quartiles([t / 1e6 for t in times["two"]]),
                "one / two": ratios(times["one"], times["two"]),
            }
        )
    return rows
