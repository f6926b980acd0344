"""Generated maps of 2000 x 1000 fields: what planners find and cost, and how fast they are.

Each instance has two problems: across, between the ends that the map has, where a way round an
obstacle is often free of cost; and diagonal, between free fields as far apart along x as along y,
where it never is. Rooms of 512 x 512 have problems between random fields. Times, ratios and costs
as of `field_movingai`.
"""

import gapath
from benchmarks.field import compared, contenders, summary
from benchmarks.measure import Row
from benchmarks.posed import random_problems
from gapath.grid import Field, GridMap
from gapath.problem import CornerCutting, Problem
from gapath.scenario.nearest import nearest_free

CLASSES = (
    "field_rooms", "field_map4", "field_clutter", "field_maze", "field_noise", "field_terrain",
)  # fmt: skip
PLANNERS = ("memetic", "memetic_quality", "jps")
INSTANCES = 3
WIDTH, HEIGHT = 2000, 1000
ROOMS, ROOM_SIDES, ROOM_PROBLEMS = 512, (8, 16, 32), 50


def across(grid: GridMap) -> Problem:
    """Pose the map's own problem."""
    assert grid.start is not None and grid.target is not None
    return Problem(grid, grid.start, grid.target)


def diagonal(grid: GridMap) -> Problem:
    """Pose one from the upper border to the lower one, as far to the right as down."""
    left, down = (grid.cols - grid.rows) // 2, grid.rows - 1
    return Problem(
        grid, _nearest_joined(grid, (left, 0)), _nearest_joined(grid, (left + down, down))
    )


def _nearest_joined(grid: GridMap, place: Field) -> Field:
    """Find the field nearest to a place that is joined with the map's start."""
    closed = grid.obstacles.copy()
    while True:
        found = nearest_free(closed, place)
        assert grid.start is not None and found is not None
        if grid.joined(grid.start, found, CornerCutting.FORBID):
            return found
        closed[found[1], found[0]] = True


def measure(quick: bool) -> list[Row]:
    size = {"width": WIDTH // 10, "height": HEIGHT // 10} if quick else {}
    instances = range(1 if quick else INSTANCES)
    rows: list[Row] = []
    for name in CLASSES:
        grids = [gapath.load_map(name, instance=i, **size) for i in instances]
        for ends, pose in (("across", across), ("diagonal", diagonal)):
            rows += _rows(name, ends, [pose(grid) for grid in grids])
    for side in ROOM_SIDES[:1] if quick else ROOM_SIDES:
        grid = gapath.load_map("field_rooms", width=ROOMS, height=ROOMS, size=side)
        drawn = random_problems(grid, 2 if quick else ROOM_PROBLEMS, side, CornerCutting.ALLOW)
        rows += _rows(f"field_rooms[size={side}]", "random", drawn)
    return rows


def _rows(name: str, ends: str, problems: list[Problem]) -> list[Row]:
    rows, grid = [], problems[0].map
    for planner, heats in compared(problems, contenders(PLANNERS)):
        row: Row = {"class": name, "ends": ends, "planner": planner}
        row |= {"fields": f"{grid.cols} x {grid.rows}"}
        rows.append(
            row | ({"problems": heats} if isinstance(heats, str) else summary(planner, heats))
        )
    return rows
