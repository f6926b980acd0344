"""The reader of BARN worlds, and what it refuses."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.discovery import readers
from gapath.errors import InputError
from gapath.mapio.barn import Reader, inflated
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem

START, GOAL = [-2.25, 3.0, 1.57], [-2.25, 13.0]
CELLS = st.sets(st.tuples(st.integers(0, 29), st.integers(0, 63)), max_size=60)


def cylinder(i, j):
    return [round(-4.5 + 0.15 * (i + 0.5), 6), round(0.15 * (j + 0.5), 6), 0.075]


def world(**values):
    good = {"world": 0, "cylinders_xyr": [cylinder(0, 0)], "start": START, "goal": GOAL}
    return good | values


def save(folder, content):
    path = folder / "world.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content), "utf-8")
    return str(path)


def read(path, start=None, target=None, free_weight=0.5, inflation=0):
    return Reader(path, start, target, free_weight, inflation).read()


@given(cells=CELLS)
def test_a_cylinder_fills_its_cell(tmp_path_factory, cells):
    cells -= {(15, 20)}
    folder = tmp_path_factory.mktemp("barn")
    cylinders = [cylinder(i, j) for i, j in sorted(cells)]
    grid = read(save(folder, world(cylinders_xyr=cylinders)))
    assert grid.weights.shape == (87, 30)
    assert (grid.start, grid.target) == ((15, 66), (15, 0))
    assert {(x, 86 - y) for y, x in np.argwhere(grid.obstacles)} == cells
    fields = np.argwhere(grid.obstacles)[:, ::-1].astype(np.int32)
    centres = {tuple(c) for c in np.round(grid.to_metres(fields), 4)}
    assert centres == {tuple(np.round(c[:2], 4)) for c in cylinders}


@given(cells=CELLS, fields=st.integers(0, 4))
def test_obstacles_grow_by_the_chebyshev_distance(cells, fields):
    blocked = np.zeros((64, 30), dtype=bool)
    for i, j in cells:
        blocked[j, i] = True
    slow = [
        [any(max(abs(i - u), abs(j - v)) <= fields for u, v in cells) for i in range(30)]
        for j in range(64)
    ]
    assert inflated(blocked, fields).tolist() == slow


def test_a_near_goal_needs_no_more_rows_than_the_lattice(tmp_path):
    grid = read(save(tmp_path, world(goal=[-0.01, 9.59])), free_weight=0.25)
    assert grid.weights.shape == (64, 30)
    assert grid.target == (29, 0)
    assert (grid.resolution, grid.origin, grid.source) == (0.15, (-4.5, 0.0, 0.0), "barn")
    assert set(np.unique(grid.weights)) == {0.25, 1.0}


def test_other_ends_may_be_named(tmp_path):
    path = save(tmp_path, world(cylinders_xyr=[cylinder(15, 20)]))
    grid = read(path, start=[3, 60], target=[20, 5])
    assert (grid.start, grid.target) == ((3, 60), (20, 5))
    with pytest.raises(InputError, match=r"start: got .*, on an obstacle"):
        read(path)
    near = save(tmp_path, world(cylinders_xyr=[cylinder(14, 21)]))
    assert read(near).start == (15, 66)
    with pytest.raises(InputError, match="on an obstacle"):
        read(near, inflation=1)


DEEP = "[" * 100_000


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "0 bytes"),
        ("type octile", "no JSON"),
        (DEEP, "no JSON"),
        ('{"start":' + "9" * 5000 + "}", "no JSON"),
        ('{"start": [NaN, 1]}', "NaN is no number"),
        ('{"start": [-Infinity, 1]}', "-Infinity is no number"),
        ("[]", r"got \[\], expected a BARN world"),
        ("[[[1]]]", "got list, expected a BARN world"),
        ("3", "got 3, expected a BARN world"),
        ({}, "start: got nothing"),
        ({"start": START, "goal": GOAL}, "cylinders_xyr: got nothing"),
        (world(start="here"), "start: got 'here', expected a list"),
        (world(start=[1.0]), r"start: got \[1.0\], expected a list of 2 or 3"),
        (world(start=[-2.25, "3"]), "expected a list of 2 or 3 finite numbers"),
        (world(start=[True, 3.0]), "expected a list of 2 or 3 finite numbers"),
        (world(start=[1e300, 3.0]), "expected a list of 2 or 3 finite numbers"),
        (json.dumps(world()).replace("13.0", "1e999"), "expected a list of 2 finite numbers"),
        (json.dumps(world()).replace("13.0", "9" * 400), "expected a list of 2 finite numbers"),
        (world(start=[0.1, 3.0]), r"start: got \[0.1, 3.0\], expected a place with"),
        (world(goal=[-2.25, -0.1]), "goal: .* expected a place with"),
        (world(goal=[-2.25, 1e6]), "goal: .* expected a place with .* 0 <= y < 150"),
        (world(goal=[*GOAL, 0, 0]), r"goal: got \[-2.25, 13.0, 0, 0\], expected a list of 2"),
        (world(cylinders_xyr={}), "cylinders_xyr: got dict, expected a list"),
        (world(cylinders_xyr=[[1, 2]]), r"cylinders_xyr\[0\]: got \[1, 2\], expected a list of 3"),
        (world(cylinders_xyr=[cylinder(0, 0), None]), r"cylinders_xyr\[1\]: got None"),
        (world(cylinders_xyr=[cylinder(30, 5)]), r"cylinders_xyr\[0\]: .* 0 <= y < 9.6"),
        (world(cylinders_xyr=[cylinder(5, 64)]), r"cylinders_xyr\[0\]: .* 0 <= y < 9.6"),
        (world(cylinders_xyr=[[-4.425, 0.075, 0.5]]), "radius 0.075 and a centre on the lattice"),
        (world(cylinders_xyr=[[-4.4, 0.075, 0.075]]), "radius 0.075 and a centre on the lattice"),
    ],
)
def test_bad_worlds_are_refused_with_one_clear_sentence(tmp_path, content, message):
    path = save(tmp_path, content)
    with pytest.raises(InputError, match=message) as caught:
        read(path)
    assert str(caught.value).startswith(path)
    assert len(str(caught.value)) < 400 + len(path)


def test_a_huge_file_is_not_opened(tmp_path):
    with pytest.raises(InputError, match="bytes, expected between"):
        read(save(tmp_path, " " * (1 << 21)))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"free_weight": 1.0}, "map.free_weight"),
        ({"free_weight": float("nan")}, "map.free_weight"),
        ({"inflation": -1}, "map.inflation"),
        ({"inflation": 31}, "map.inflation"),
    ],
)
def test_settings_out_of_range_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        read("no such file", **values)


def test_json_files_are_read_as_barn_worlds():
    assert readers()[".json"] == "barn"


def test_the_six_worlds_can_be_crossed(data):
    paths = sorted((data / "barn").glob("*.json"))
    if not paths:
        pytest.skip(f"no worlds in {data / 'barn'}")
    for path in paths:
        grid = read(str(path))
        cylinders = json.loads(path.read_text("utf-8"))["cylinders_xyr"]
        assert grid.obstacles.sum() == len({tuple(c) for c in cylinders})
        assert (grid.start, grid.target) == ((15, 66), (15, 0))
        assert shortest_path(Problem(grid, grid.start, grid.target)).feasible
