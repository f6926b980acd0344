"""The library's three lines."""

import math
import subprocess
import sys
from importlib import metadata

import numpy as np
import pytest

import gapath
from gapath import api
from gapath import grid as grids
from gapath.components import build
from gapath.discovery import yaml_values


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


def test_a_planner_is_made_once_for_its_settings(monkeypatch):
    grid, made = gapath.load_map("kg18_test1"), []
    monkeypatch.setattr(api, "_made", {})
    monkeypatch.setattr(api, "build", lambda *given: made.append(given) or build(*given))
    for _ in range(3):
        for settings in ({}, {"population": 40}, {"population": 40, "max_epochs": 7}):
            gapath.plan(grid, planner="ga1", **settings)
            gapath.plan(grid, planner="ga1", **dict(reversed(settings.items())))
    assert len(made) == 3
    gapath.plan(grid, planner="ga1", kernels="scalar")
    gapath.plan(grid, planner="ga1", mutation_probability=1)
    gapath.plan(grid, planner="ga1", mutation_probability=1.0)
    assert len(made) == 6
    with pytest.raises(gapath.InputError, match="population"):
        gapath.plan(grid, planner="ga1", population=True)
    for population in range(20, 20 + 2 * api._MOST_MADE):
        gapath.plan(grid, planner="ga1", population=population, max_epochs=1)
    assert len(api._made) <= api._MOST_MADE


def test_what_hangs_together_is_found_out_once_a_map(monkeypatch):
    grid, calls = gapath.load_map("kg18_test4"), []
    fill = grids.fill_parts
    monkeypatch.setattr(grids, "fill_parts", lambda *given: calls.append(given) or fill(*given))
    for seed in range(5):
        for rule in gapath.CornerCutting:
            gapath.plan(grid, planner="ga1", seed=seed, corner_cutting=rule.name.lower())
    assert len(calls) == 2  # with and without diagonal steps


def test_a_planner_can_be_given_and_kernels_chosen():
    grid = gapath.load_map("kg18_test3")
    ready = build("planner", yaml_values("planner", "ga3"), "planner")
    plans = [
        gapath.plan(grid, planner=planner, seed=3, kernels=kernels)
        for planner in ("ga3", ready)
        for kernels in ("auto", "scalar")
    ]
    assert len({(plan.cost, plan.epochs, plan.path.tobytes()) for plan in plans}) == 1


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"map": np.full((5, 5), 0.5)}, "map: got ndarray, expected a gapath.GridMap"),
        ({"planner": 3}, "planner: got 3"),
        ({"planner": gapath.GridMap}, "planner: got <class"),
        ({"kernels": "cuda"}, "kernels: got cuda"),
        ({"planner": "ga9"}, "planner: got ga9, expected one of"),
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
        gapath.plan(**{"map": grid, "start": (0, 0), "target": (4, 4), **values})


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
