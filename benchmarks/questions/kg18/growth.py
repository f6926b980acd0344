"""GA 1-3 against A* as maps grow: KG18's four classes of known maps, 5000 to 16 million fields.

The generator of the classes draws 100 x 50 fields and no others, so larger maps are its canonical
ones with every field repeated: obstacles and gaps grow with the map. Start and target
stay single fields, in the middle of what theirs have become; the fields around them have the base
weight, since a block that weighs nothing would leave A* without a heuristic. Planners are as
configured, what they measure in fields included. Times in microseconds, of `Planner.plan`.

- "found" is the share of runs, a seed each, that found a path; one that found none counts with
  its 500 epochs. A* always finds one, and none costs less, or this stops.
- "A* / GA, table built" above 1 says that the genetic algorithm plans faster; "A* / GA" is of the
  first query on a map, for which both need the map's table and A* its least weight besides.
"""

from dataclasses import replace
from functools import partial

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
    repeat_fields,
    timed,
)
from gapath.kernels.rng import stream
from gapath.mapio.reconstructed import BASE_WEIGHT
from gapath.problem import Plan, Problem

SIZES = {(100, 50): 50, (400, 200): 30, (1000, 500): 10, (4000, 4000): 5}
"""Columns and rows, multiples of the canonical map's, with the rounds that each is timed."""


def enlarged(problem: Problem, cols: int, rows: int) -> Problem:
    """Pose a problem again on its map with every field repeated."""
    grid = problem.map
    across, down = cols // grid.cols, rows // grid.rows
    weights = grid.weights.copy()
    for x, y in (problem.start, problem.target):
        weights[y, x] = BASE_WEIGHT
    weights = repeat_fields(weights, across, down)
    start, target = (
        (x * across + across // 2, y * down + down // 2) for x, y in (problem.start, problem.target)
    )
    for x, y in (start, target):
        weights[y, x] = 0.0
    return Problem(replace(grid, weights=weights, start=start, target=target), start, target)


def time_tables(problem: Problem, times: int) -> tuple[list[float], list[float]]:
    """Time the table that kernels read and the least weight that A* needs, microseconds."""
    tables, least = [], []
    for _ in range(times):
        grid = replace(problem.map)  # maps keep what they have built
        tables.append(timed(partial(getattr, grid, "table"))[0])
        ends = (problem.start, problem.target)
        least.append(timed(partial(grid.least_weight, *ends))[0])
    return tables, least


def check_least(optimum: Plan, plan: Plan) -> None:
    """Raise RuntimeError unless the optimum is a path, and costs no more than another plan's."""
    if not optimum.feasible or (plan.feasible and plan.cost < optimum.cost):
        raise RuntimeError(f"A* does not find the least cost: {optimum} and {plan}")


def measure(quick: bool) -> list[Row]:
    sizes = dict.fromkeys(list(SIZES)[:2], 2) if quick else SIZES
    return [
        row
        for name in MAPS
        for size, rounds in sizes.items()
        for row in _size(enlarged(make_problem(name), *size), rounds)
    ]


def _size(problem: Problem, rounds: int) -> list[Row]:
    grid = problem.map
    tables, least = time_tables(problem, rounds)
    grid.least_weight(problem.start, problem.target)  # builds the table as well
    planners = {name: make_planner(name) for name in (*SETTINGS, "astar")}

    def rivals(seed: int) -> Calls:
        return {
            name: partial(planner.plan, problem, stream(seed)) for name, planner in planners.items()
        }

    times, found = interleave([rivals(seed) for seed in (0, *range(rounds))])
    exact = times["astar"]
    exact_first = [sum(parts) for parts in zip(exact, tables, least, strict=True)]
    rows: list[Row] = []
    for name in SETTINGS:
        for plans in found:
            check_least(plans["astar"], plans[name])
        first = [sum(parts) for parts in zip(times[name], tables, strict=True)]
        rows.append(
            {
                "class": grid.name,
                "size": f"{grid.cols} x {grid.rows}",
                "planner": name,
                "seeds": rounds,
                "found": sum(plans[name].feasible for plans in found) / rounds,
                "GA us": quartiles(times[name]),
                "A* us": quartiles(exact),
                "table us": quartiles(tables),
                "least weight us": quartiles(least),
                "A* / GA": ratios(exact_first, first),
                "A* / GA, table built": ratios(exact, times[name]),
            }
        )
    return rows
