"""M22's planner as pictures and obstacles become larger and more, and what resizing saves.

Scene 1 of the class of the experiments, the robot's radius growing with the picture (5 pixels at
800 x 600); times in ms, "a generation" in us. Stages are those of a plan; the genetic algorithm's
has the check that a path exists.
"resize": the same with ``resize: true``, which works on the smallest picture that closes no gap.
"search" is the search for that picture, "scale" how many pixels a side become one; "whole /
resized" above 1 says that it saved time, "without search" that it would, were the scale known.
"""

from functools import partial
from typing import Any

from benchmarks.measure import Calls, Row, interleave, make_planner, quartiles, ratios
from gapath.kernels.rng import stream
from gapath.mapio.scene import draw
from gapath.problem import Problem

SIZES = ((400, 300), (800, 600), (1600, 1200), (3200, 2400))
OBSTACLES = (6, 20, 100)
STAGES = ("dilation", "keypoints", "graph", "genetic algorithm")


def measure(quick: bool) -> list[Row]:
    sizes, obstacles = (SIZES[:2], OBSTACLES[:2]) if quick else (SIZES, OBSTACLES)
    return [_size(*size, count, 1 if quick else 4) for count in obstacles for size in sizes]


def _size(cols: int, rows: int, obstacles: int, rounds: int) -> Row:
    grid = draw(1, obstacles, cols, rows)
    assert grid.start is not None and grid.target is not None
    problem = Problem(grid, grid.start, grid.target)
    planners: dict[str, Any] = {
        name: make_planner("visibility_ga", robot_radius=5 * cols / 800, resize=resize)
        for name, resize in (("plain", False), ("resized", True))
    }

    def rivals(seed: int) -> Calls:
        return {
            name: partial(planner.plan, problem, stream(seed)) for name, planner in planners.items()
        }

    times, found = interleave([rivals(seed) for seed in (0, *range(rounds))])
    plans = [plans["plain"] for plans in found]
    row: Row = {
        "picture": f"{cols} x {rows}",
        "obstacles": obstacles,
        "points": len(plans[0].survey().points),
        "found": sum(plan.feasible for plan in plans) / len(plans),
        "whole": quartiles([us / 1e3 for us in times["plain"]]),
    }
    for stage in STAGES:
        row[stage] = quartiles([1e3 * plan.stages[stage] for plan in plans])
    generations = [1e6 * plan.stages[STAGES[-1]] / plan.epochs for plan in plans]
    row["a generation"] = quartiles(generations)

    resized = [plans["resized"] for plans in found]
    searches = [1e6 * plan.stages["resizing"] for plan in resized]
    without = [us - search for us, search in zip(times["resized"], searches, strict=True)]
    row["resize: scale"] = resized[0].survey().block
    row["resize: whole"] = quartiles([us / 1e3 for us in times["resized"]])
    row["resize: search"] = quartiles([us / 1e3 for us in searches])
    row["whole / resized"] = ratios(times["plain"], times["resized"])
    row["without search"] = ratios(times["plain"], without)
    return row
