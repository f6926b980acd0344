"""The library's three lines."""

import math
import subprocess
import sys
from importlib import metadata

import numpy as np
import pytest

import gapath


def test_three_lines(tmp_path):
    (tmp_path / "m.map").write_text("type octile\nheight 2\nwidth 4\nmap\n....\n....\n")
    grid = gapath.load_map(tmp_path / "m.map")
    plan = gapath.plan(grid, (0, 0), (3, 1), planner="ga3", seed=7)
    assert plan.status is gapath.PlanStatus.FOUND
    assert plan.path[0].tolist() == [0, 0]
    assert plan.path[-1].tolist() == [3, 1]
    again = gapath.plan(grid, (0, 0), (3, 1), planner="ga3", seed=7)
    assert again.path.tolist() == plan.path.tolist()


def test_maps_of_our_own_by_name():
    grid = gapath.load_map("kg18_test2", instance=3)
    assert (grid.name, grid.instance, grid.start) == ("kg18_test2", 3, (0, 24))
    assert gapath.plan(grid, planner="astar").feasible


def test_settings_replace_the_yamls():
    grid = gapath.load_map("kg18_test4")
    plan = gapath.plan(grid, planner="ga1", max_epochs=3, population=20)
    assert plan.epochs == 3
    assert plan.evaluations == 20 + 2 * 15
    assert plan.cost >= 100_000


def test_a_map_from_an_array():
    weights = np.full((10, 10), 0.5)
    weights[:9, 5] = 1.0
    plan = gapath.plan(gapath.GridMap("mine", weights), (0, 0), (9, 0), planner="dijkstra")
    assert plan.cost == 19 * 0.5
    walled = weights.copy()
    walled[:, 5] = 1.0
    plan = gapath.plan(gapath.GridMap("mine", walled), (0, 0), (9, 0), planner="ga1")
    assert plan.status is gapath.PlanStatus.INFEASIBLE
    assert math.isinf(plan.cost)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"planner": "ga9"}, "planner: got 'ga9', expected one of astar"),
        ({"corner_cutting": "maybe"}, "corner_cutting: got maybe"),
        ({"population": 2}, "planner.population: got 2"),
        ({"colour": "red"}, "planner.colour: got an unknown name"),
        ({"start": None}, "map.start: got None"),
        ({"start": (9, 9)}, "map.start: got"),
        ({"seed": -1}, "seed: got -1"),
    ],
)
def test_bad_arguments_are_refused(values, message):
    grid = gapath.GridMap("mine", np.full((5, 5), 0.5))
    with pytest.raises(gapath.InputError, match=message):
        gapath.plan(grid, **{"start": (0, 0), "target": (4, 4), **values})


@pytest.mark.parametrize("name", ["nowhere", "notes.txt", "gone.map"])
def test_maps_that_are_not_there_are_refused(name):
    with pytest.raises(gapath.InputError, match=name):
        gapath.load_map(name)


def test_public_names_are_there_and_imported_late():
    assert set(gapath.__all__) <= set(dir(gapath))
    for name in set(gapath.__all__) - {"__version__"}:
        assert getattr(gapath, name).__module__.startswith("gapath")
    assert gapath.__version__ == metadata.version("gapath")
    with pytest.raises(AttributeError, match="nothing"):
        gapath.nothing  # noqa: B018
    code = "import sys, gapath; sys.exit('numba' in sys.modules or 'hydra' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
