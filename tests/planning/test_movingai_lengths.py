"""A* on real maps: its lengths are the published ones."""

import math

import pytest

from gapath.mapio.movingai import Reader, read_scenario
from gapath.planning.path import octile_length
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Problem

SCENARIOS = [
    ("dao/arena.map", "dao/arena.map.scen"),
    ("dao/lak110d.map", "dao/lak110d.map.scen"),
    ("dao/orz107d.map", "dao/orz107d.map.scen"),
    ("da2/lt_house.map", "da2/lt_house.map.scen"),
    ("mapf/room-32-32-4.map", "mapf/room-32-32-4-random-1.scen"),
    ("cities/Berlin_1_256.map", "cities/Berlin_1_256.map.scen"),
    ("mazes/maze512-32-7.map", "mazes/maze512-32-7.map.scen"),
]


@pytest.mark.parametrize(("map_file", "scenario"), SCENARIOS)
def test_lengths_equal_the_published_ones(data, map_file, scenario):
    """Diagonal steps cost sqrt(2) and cut no corner; Moving AI Lab (Sturtevant 2012).

    The files give six digits, which is less than 1e-3 from 1000 on.
    """
    folder = data / "movingai"
    grid = Reader(str(folder / map_file), None, None, 0.5, None, 0).read()
    rows = read_scenario(folder / scenario)
    for row in rows[:: max(len(rows) // 60, 1)]:
        problem = Problem(grid, row.start, row.target, CornerCutting.FORBID)
        plan = shortest_path(problem, by_length=True)
        length = octile_length(plan.path)
        assert math.isclose(length, row.optimal_length, rel_tol=5e-6, abs_tol=1e-3), row
