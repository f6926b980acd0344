"""A whole GA run: how many times faster than a textbook kernel, than A*, Dijkstra and the paper.

Times are those of `Planner.plan`, in microseconds. Both kernels run inside the same planner
with the same random streams, and give identical epochs, chromosomes, costs and paths, or
this stops. A ratio "... / GA" above 1 says that gapath's genetic algorithm is the faster one.
A run that finds nothing counts with its 500 epochs, except against the paper's times: Table 1,
executions that found a path, Python 3.6 on another machine, so an order of magnitude, no more.
"""

import statistics
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from gapath.pipelines.kg18 import found_seconds

from benchmarks import textbook
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
from gapath.kernels import evolution
from gapath.problem import Plan, Planner, Problem
from gapath.rng import Stream, stream

KERNELS: dict[str, Callable[..., Any]] = {"GA": evolution.evolve, "textbook": textbook.evolve}
"""Kernels with the signature of `gapath.kernels.evolution.evolve`; rivals enter here."""


def plan_with(
    kernel: Callable[..., Any], planner: Planner, problem: Problem, random: Stream
) -> Plan:
    """Plan, the evolution done by another kernel."""
    before = evolution.evolve
    evolution.evolve = kernel
    try:
        return planner.plan(problem, random)
    finally:
        evolution.evolve = before


def check_identical(ours: Plan, other: Plan, name: str) -> None:
    """Raise RuntimeError unless two plans have the same history, path and cost."""
    assert ours.evolution is not None and other.evolution is not None
    same = ours.cost == other.cost and np.array_equal(ours.path, other.path)
    for a, b in zip(ours.evolution, other.evolution, strict=True):
        same = same and np.array_equal(a, b)
    if not same:
        raise RuntimeError(f"the {name} kernel gives another result: {ours} and {other}")


def measure(quick: bool) -> list[Row]:
    return [
        _setting(problem, name, seeds=5 if quick else 200)
        for problem in map(make_problem, MAPS)
        for name in SETTINGS
    ]


def _setting(problem: Problem, name: str, seeds: int) -> Row:
    planner, random = make_planner(name), stream(0)
    exact: Calls = {
        "A*": partial(make_planner("astar").plan, problem, random),
        "Dijkstra": partial(make_planner("dijkstra").plan, problem, random),
    }
    times, plans = interleave(
        [
            {
                rival: partial(plan_with, kernel, planner, problem, stream(seed))
                for rival, kernel in KERNELS.items()
            }
            | exact
            for seed in (0, *range(seeds))
        ]
    )
    for found in plans:
        for rival in KERNELS:
            check_identical(found["GA"], found[rival], rival)
    row: Row = {
        "map": problem.map.name,
        "planner": name,
        "epochs": quartiles([found["GA"].epochs for found in plans]),
    }
    row |= {f"{rival} us": quartiles(sample) for rival, sample in times.items()}
    row |= {f"{rival} / GA": ratios(times[rival], times["GA"]) for rival in times if rival != "GA"}
    for rival, paper_name in (("GA", name), ("Dijkstra", "dijkstra")):
        paper = found_seconds(problem.map.name, paper_name)
        ours = [t for t, plan in zip(times[rival], plans, strict=True) if plan[rival].feasible]
        if paper and ours:
            row[f"paper's {rival} s"] = statistics.median(paper)
            row[f"paper / {rival}"] = 1e6 * statistics.median(paper) / statistics.median(ours)
    return row
