"""S04's genetic algorithm: generations a second, and how many times fewer rivals do.

Search space 7 as it is, 10 x 10, and with each field made 2 x 2 and 5 x 5; the settings of
``conf/planner/sedighi.yaml``, 200 individuals; whole runs, so set-up counts. A ratio
"gapath / ..." above 1 says that gapath is the faster one.

- DEAP: the same operators, written as its users write them, with gapath's kernels to measure
  and rate the paths (`benchmarks/rivals/row_column_deap.py`). The target is 20. Individuals are
  cloned as lists: with DEAP's own deepcopy a generation takes three to six times as long.
- twin: plain Python, the oracle of the tests (`tests/twins/naive_row_column.py`). It takes the same
  random numbers and its epochs are identical, or this stops.
"""

import sys
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from benchmarks.measure import (
    Calls,
    Row,
    interleave,
    make_planner,
    make_problem,
    quartiles,
    ratios,
    repeat_fields,
)
from gapath.grid import GridMap
from gapath.kernels.rng import stream
from gapath.problem import Plan, Problem

sys.path.insert(0, str(Path(__file__).parents[3] / "tests" / "twins"))  # the twin

import naive
import naive_row_column

ENLARGED = (1, 2, 5)
EPOCHS = {"gapath": 200, "DEAP": 50, "twin": 3}


def enlarged(times: int) -> Problem:
    """Pose search space 7 with `times` x `times` fields for each."""
    small = make_problem("s04_sp07").map
    grid = GridMap(small.name, repeat_fields(small.weights, times, times))
    return Problem(grid, (0, 0), (grid.cols - 1, grid.rows - 1))


def rivals(problem: Problem, epochs: dict[str, int], seed: int) -> Calls:
    """Give those that can run here; each does its own number of epochs."""
    planners: dict[str, Any] = {
        name: make_planner("sedighi", max_epochs=number) for name, number in epochs.items()
    }
    calls: Calls = {
        "gapath": partial(planners["gapath"].plan, problem, stream(seed)),
        "twin": partial(
            naive_row_column.evolve,
            problem.map.weights,
            problem.start,
            problem.target,
            planners["twin"],
            naive.Words(seed),
        ),
    }
    if find_spec("deap"):
        from benchmarks.rivals import row_column_deap

        calls["DEAP"] = partial(row_column_deap.evolve, problem, planners["DEAP"], seed)
    return calls


def check_identical(plan: Plan, epochs: list[dict[str, Any]]) -> None:
    """Raise RuntimeError unless the twin's epochs are the plan's first ones."""
    assert plan.evolution is not None
    ours = plan.evolution.chromosomes[: len(epochs)].tolist()
    if ours != [epoch["chromosome"] for epoch in epochs]:
        raise RuntimeError("the twin's epochs are others")


def measure(quick: bool) -> list[Row]:
    epochs = {name: min(number, 5) for name, number in EPOCHS.items()} if quick else EPOCHS
    return [_size(times, epochs, 2 if quick else 20) for times in ENLARGED]


def _size(times: int, epochs: dict[str, int], rounds: int) -> Row:
    problem = enlarged(times)
    seeds = (0, *range(rounds))
    found, results = interleave([rivals(problem, epochs, seed) for seed in seeds])
    for result in results:
        check_identical(result["gapath"], result["twin"])
    each = {name: [us / epochs[name] for us in sample] for name, sample in found.items()}
    row: Row = {"map": problem.map.name, "n": problem.map.cols}
    for name in EPOCHS:
        if name not in each:
            row[f"{name} epochs/s"] = "skipped: the bench extra is not installed"
            continue
        row[f"{name} epochs/s"] = quartiles([1e6 / us for us in each[name]])
        if name != "gapath":
            row[f"gapath / {name}"] = ratios(each[name], each["gapath"])
    return row
