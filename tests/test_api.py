"""The library's three lines."""

import math
import subprocess
import sys
from importlib import metadata

import numpy as np
import pytest
from matplotlib.figure import Figure

import gapath
from gapath import api
from gapath import grid as grids
from gapath.components import build
from gapath.discovery import yaml_values
from gapath.running.naming import usual_values
from gapath.store.settings import flatten


@pytest.fixture(name="gapath_command")
def command(request):
    return request.getfixturevalue("gapath")  # the name is the library's here


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


def test_settings_may_be_numbers_of_an_array_or_a_table():
    grid, cost = gapath.load_map("kg18_test1"), 100
    for population in np.array([cost]):
        plain = gapath.plan(grid, planner="ga1", population=cost, vln=1e5)
        taken = gapath.plan(grid, planner="ga1", population=population, vln=np.float64(1e5))
        assert taken.evaluations == plain.evaluations
    with pytest.raises(gapath.InputError, match=r"population: got .*2\.5"):
        gapath.plan(grid, planner="ga1", population=np.float64(2.5))


def test_a_plan_knows_what_was_asked():
    grid = gapath.load_map("kg18_test4")
    for planner in ("astar", "ga1"):
        plan = gapath.plan(grid, (1, 2), (60, 40), planner=planner, corner_cutting="forbid")
        asked = plan.problem
        assert asked.map is grid
        assert (asked.start, asked.target) == ((1, 2), (60, 40))
        assert asked.corner_cutting is gapath.CornerCutting.FORBID
    walled = np.full((3, 3), 0.5)
    walled[1] = 1.0
    plan = gapath.plan(gapath.GridMap("walled", walled), (0, 0), (2, 2), planner="ga1")
    assert "no path exists" in plan.plot(Figure().subplots()).get_title()


DRIVES = {
    "as it is": ("kg18_map3", "kg18", {}),
    "another sensor": ("kg18_map1", "kg18_astar", {"sensor.range": 7, "sensor.occlusion": True}),
    "a map that changes": ("kg18_map2", "replan_astar", {"changes.every": 5, "changes.side": 6}),
    "few steps": ("kg18_map4", "dstar_lite", {"step_limit": 40, "unknown_weight": 0.25}),
}


@pytest.mark.parametrize(("name", "navigator", "settings"), DRIVES.values(), ids=DRIVES)
def test_a_drive_is_the_first_one_of_the_run(gapath_command, tmp_path, name, navigator, settings):
    words = [f"drive.{key}={value}" for key, value in settings.items()]
    code, _, errors = gapath_command(
        "task=drive", f"map={name}", f"navigator={navigator}", "seed=7", "recorder=mcap", *words
    )
    assert (code, errors) == (0, "")
    (folder,) = tmp_path.glob("out/drive/*")
    of_run = gapath.run(folder).trial(0)
    named = {key.replace(".", "_"): value for key, value in settings.items()}
    mine = gapath.drive(gapath.load_map(name), navigator=navigator, seed=7, **named)
    assert mine.outcome is of_run.outcome
    assert mine.places.tolist() == of_run.places.tolist()
    assert np.array_equal(mine.known(), of_run.known(), equal_nan=True)
    assert [type(event) for event in mine.events] == [type(event) for event in of_run.events]
    answers = [[(c.answer.cost, c.answer.path.tolist()) for c in d.calls] for d in (mine, of_run)]
    assert answers[0] == answers[1]


def test_every_setting_of_a_drive_can_be_given():
    grid = gapath.load_map("kg18_map1")
    for name in flatten(usual_values()["drive"]):
        with pytest.raises(gapath.InputError) as caught:
            gapath.drive(grid, **{name.replace(".", "_"): "nonsense"})
        assert caught.value.where == f"drive.{name}"


def test_what_a_robot_knows_before_may_be_a_map_or_a_file(tmp_path):
    grid = gapath.load_map("kg18_map1")
    rows = ["".join("@" if wall else "." for wall in row) for row in grid.obstacles]
    head = f"type octile\nheight {grid.rows}\nwidth {grid.cols}\nmap\n"
    (tmp_path / "walls.map").write_text(head + "\n".join(rows) + "\n")
    drives = [
        gapath.drive(grid, navigator="replan_astar", known_map=known)
        for known in (None, grid, tmp_path / "walls.map")
    ]
    assert not (drives[0].known(0)[grid.obstacles] == 1).all()
    for drive in drives[1:]:
        assert (drive.known(0)[grid.obstacles] == 1).all()
        assert drive.places.tolist() == drives[1].places.tolist()


def test_a_navigator_can_be_given_and_kernels_chosen():
    grid = gapath.load_map("kg18_map3")
    ready = build("navigator", yaml_values("navigator", "kg18"), "navigator")
    drives = [
        gapath.drive(grid, navigator=navigator, seed=3, kernels=kernels)
        for navigator in ("kg18", ready)
        for kernels in ("auto", "scalar")
    ]
    assert len({drive.places.tobytes() for drive in drives}) == 1
    other = gapath.drive(grid, navigator="kg18", seed=3, explore_interval=1)
    assert other.places.tobytes() != drives[0].places.tobytes()


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"map": np.full((5, 5), 0.5)}, "map: got ndarray, expected a gapath.GridMap"),
        ({"start": (2, 2)}, r"map.start: got \[2, 2\], an obstacle, expected a free field"),
        ({"target": None}, "map.target: got None"),
        ({"target": (9, 9)}, "map.target: got"),
        ({"navigator": "kg19"}, "navigator: got kg19, .*; did you mean kg18"),
        ({"navigator": 3}, "navigator: got 3, expected a name in conf/navigator"),
        ({"navigator": gapath.GridMap}, "navigator: got <class"),
        ({"sensor_rang": 3}, "navigator.sensor_rang: .*; did you mean sensor_range"),
        ({"explore_intervall": 3}, "navigator.explore_intervall: .* explore_interval"),
        ({"sensor_range": 0}, "drive.sensor.range: got 0, expected an integer from 1 to 1000"),
        ({"explore_interval": 0}, "navigator.explore_interval: got 0"),
        ({"corner_cutting": "maybe"}, "corner_cutting: got maybe"),
        ({"kernels": "cuda"}, "kernels: got cuda"),
        ({"seed": -1}, "seed: got -1"),
        ({"known_map": "x.pdf"}, "drive.known_map: got x.pdf"),
        ({"known_map": gapath.GridMap("b", np.zeros((1, 1)))}, "drive.known_map: got 1 x 1 fields"),
    ],
)
def test_bad_arguments_of_a_drive_are_refused(values, message):
    weights = np.full((5, 5), 0.5)
    weights[2, 2] = 1.0
    grid = gapath.GridMap("mine", weights)
    with pytest.raises(gapath.InputError, match=message):
        gapath.drive(**{"map": grid, "start": (0, 0), "target": (4, 4), **values})


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
