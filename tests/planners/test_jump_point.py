"""Which maps jump point search takes, and what it says of others."""

import numpy as np
import pytest
from PIL import Image

import gapath
from gapath.api import load_map
from gapath.components import build
from gapath.discovery import yaml_values
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.rng import stream
from gapath.planning.shortest_path import shortest_path
from gapath.problem import PlanStatus, Problem


def jps(**values):
    return build("planner", yaml_values("planner", "jps") | values, "planner")


class Known:
    """What a robot knows of a map: its table, and no more that does not change."""

    def __init__(self, grid):
        self.table, self.rows, self.cols = grid.table, grid.rows, grid.cols


def one_heavy(x, y):
    weights = np.full((5, 7), 0.5)
    weights[2, 3], weights[y, x] = 1.0, 0.75
    return GridMap("one", weights)


@pytest.mark.parametrize("kind", [lambda grid: grid, Known], ids=["map", "known"])
@pytest.mark.parametrize(
    ("heavy", "takes"), [((0, 0), True), ((6, 4), True), ((1, 0), False), ((5, 4), False)]
)
def test_start_and_target_may_weigh_what_they_will(heavy, takes, kind):
    problem = Problem(one_heavy(*heavy), (0, 0), (6, 4))
    best = shortest_path(problem)
    object.__setattr__(problem, "map", kind(problem.map))
    if takes:
        jps().check(problem)
        plan = jps().plan(problem, stream(0))
        assert (plan.status, plan.cost) == (best.status, best.cost)
        return
    with pytest.raises(InputError, match=r"map: got fields of several weights, expected one weig"):
        jps().check(problem)
    assert jps().plan(problem, stream(0)).status is PlanStatus.NOT_FOUND
    jps(minimise="length").check(problem)


def test_the_library_refuses_a_map_of_several_weights():
    grid = one_heavy(1, 0)
    with pytest.raises(InputError, match=r"several weights.*planner=astar takes any map"):
        gapath.plan(grid, (0, 0), (6, 4), planner="jps")
    assert gapath.plan(grid, (0, 0), (6, 4), planner="jps_length").feasible


def test_a_command_refuses_it_before_anything_is_written(gapath, tmp_path):
    Image.fromarray(np.array([[90, 120], [90, 90]], dtype=np.uint8)).save(tmp_path / "w.png")
    line = f"map=image map.path={tmp_path / 'w.png'} map.start=[0,0] map.target=[1,1] planner=jps"
    code, text, errors = gapath(*line.split())
    assert (code, text, errors.count("\n")) == (2, "", 1)
    assert errors.startswith("gapath: map: got fields of several weights")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("minimise", ["", "time", "Weights"])
def test_what_it_minimises_is_weights_or_length(minimise):
    with pytest.raises(InputError, match=r'planner\.minimise: .*"weights" or "length"'):
        jps(minimise=minimise)


def test_papers_maps_cost_what_astar_finds():
    for name in ("kg18_test1", "kg18_test3", "kg18_test4"):
        grid = load_map(name)
        problem = Problem(grid, grid.start, grid.target)
        assert jps().plan(problem, stream(0)).cost == shortest_path(problem).cost
