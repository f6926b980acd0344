"""A whole GA run: how many times faster than a textbook kernel, than A*, Dijkstra and the paper.

Microseconds. "a run" is one of a batch: one call of a kernel does `RUNS` of them, without Python
in between, once with gapath's kernel and once with the textbook one, in turn. Both take the same
random streams and give identical epochs, chromosomes and costs, or this stops. "GA" and what
follows are single calls of `Planner.plan`, the path included; "gapath.plan" is what a user calls
for the same plan, by the planner's name; "textbook / GA" is the ratio of such calls, half of which
is Python on map 1. A ratio "... / GA" above 1 says that
gapath's genetic algorithm is the faster one. A run that finds nothing counts with its 500 epochs,
except against the paper's times: Table 1, executions that found a path, Python 3.6 on another
machine, so an order of magnitude, no more.
"""

import statistics
from functools import partial

import numpy as np

import gapath
from benchmarks.measure import (
    MAPS,
    SETTINGS,
    Calls,
    Row,
    interleave,
    make_bspline_ga,
    make_planner,
    make_problem,
    quartiles,
    ratios,
)
from benchmarks.rivals import textbook
from gapath.kernels.history.epochs import EPOCHS, History
from gapath.kernels.kg18 import evolution
from gapath.kernels.kg18.evolution import Evolve, run_evolutions, usable_kernels
from gapath.kernels.rng import Stream, stream
from gapath.pipelines.papers.kg18 import found_seconds
from gapath.planners.bspline_ga import Planner
from gapath.problem import Plan, Problem

KERNELS: dict[str, Evolve] = {
    "gapath": evolution.KERNELS[usable_kernels()[0]],
    "textbook": textbook.evolve,
}
"""Rivals enter here."""

RUNS = 20
"""Runs of a batch."""


def evolve_with(
    kernel: Evolve, planner: Planner, problem: Problem, streams: Stream
) -> list[History]:
    """Run a batch by some kernel."""
    return run_evolutions(*planner.arguments(problem), streams.copy(), kernel)


def plan_with(kernel: Evolve, planner: Planner, problem: Problem, seed: int) -> Plan:
    """Plan once by some kernel."""
    return planner.using(kernel).plan(problem, stream(seed))


def check_identical(ours: list[History], other: list[History], name: str) -> None:
    """Raise RuntimeError unless the runs of two batches have the same history."""
    for run, both in enumerate(zip(ours, other, strict=True)):
        if not all(np.array_equal(a, b) for a, b in zip(*both, strict=True)):
            raise RuntimeError(f"the {name} kernel gives another run {run}: {both}")


def time_batches(planner: Planner, problem: Problem, rounds: int) -> dict[str, list[float]]:
    """Time one run of a batch, in microseconds, for each kernel and round."""
    query = planner.arguments(problem)
    most, genes = planner.max_epochs, 2 * planner.control_points
    kept = (
        np.empty((RUNS, most), dtype=EPOCHS),
        np.empty((RUNS, most, genes), dtype=np.int32),
        np.empty(RUNS, dtype=np.int64),
    )

    def batch(seed: int) -> Calls:
        streams = np.array([stream(seed, trial) for trial in range(RUNS)])
        calls: Calls = {}
        for name, kernel in KERNELS.items():
            calls[name] = partial(kernel, *query, streams.copy(), *kept)
        return calls

    times, _ = interleave([batch(seed) for seed in range(rounds + 1)])
    return {name: [t / RUNS for t in sample] for name, sample in times.items()}


def measure(quick: bool) -> list[Row]:
    return [
        _setting(problem, name, rounds=1 if quick else 10)
        for problem in map(make_problem, MAPS)
        for name in SETTINGS
    ]


def _setting(problem: Problem, name: str, rounds: int) -> Row:
    planner = make_bspline_ga(name)
    streams = np.array([stream(0, trial) for trial in range(RUNS)])
    results = {rival: evolve_with(k, planner, problem, streams) for rival, k in KERNELS.items()}
    for rival, found in results.items():
        check_identical(results["gapath"], found, rival)
    batches = time_batches(planner, problem, rounds)

    exact: Calls = {
        rival: partial(make_planner(planner_name).plan, problem, stream(0))
        for rival, planner_name in (("A*", "astar"), ("Dijkstra", "dijkstra"))
    }
    times, plans = interleave(
        [
            {
                "GA": partial(plan_with, KERNELS["gapath"], planner, problem, seed),
                "gapath.plan": partial(gapath.plan, problem.map, planner=name, seed=seed),
                "textbook": partial(plan_with, KERNELS["textbook"], planner, problem, seed),
            }
            | exact
            for seed in (0, *range(RUNS * rounds))
        ]
    )
    row: Row = {
        "map": problem.map.name,
        "planner": name,
        "epochs": quartiles([found["GA"].epochs for found in plans]),
    }
    row |= {f"a run, {rival}": quartiles(sample) for rival, sample in batches.items()}
    row["textbook / gapath"] = ratios(batches["textbook"], batches["gapath"])
    row |= {f"{rival} us": quartiles(sample) for rival, sample in times.items()}
    row |= {f"{rival} / GA": ratios(times[rival], times["GA"]) for rival in times if rival != "GA"}
    more = [called - own for called, own in zip(times["gapath.plan"], times["GA"], strict=True)]
    row["gapath.plan - GA us"] = quartiles(more)
    for rival, paper_name in (("GA", name), ("Dijkstra", "dijkstra")):
        paper = found_seconds(problem.map.name, paper_name)
        ours = [t for t, plan in zip(times[rival], plans, strict=True) if plan[rival].feasible]
        if paper and ours:
            row[f"paper's {rival} s"] = statistics.median(paper)
            row[f"paper / {rival}"] = 1e6 * statistics.median(paper) / statistics.median(ours)
    return row
