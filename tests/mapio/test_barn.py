"""The reader of BARN worlds, and what it refuses."""

import io
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


def read(path, start=None, target=None, free_weight=0.5, inflation=0, scenario=None):
    return Reader(path, start, target, free_weight, inflation, scenario).read()


FLOOR = """<model name='ground_plane'><static>1</static><link name='link'>
  <collision name='collision'><geometry><plane><size>100 100</size></plane></geometry></collision>
</link></model>"""


def model(number, x, y, radius, shape="cylinder"):
    """A model as the challenge writes it, with what else it says left out."""
    geometry = (
        f"<geometry><{shape}><radius>{radius:f}</radius><length>1</length></{shape}></geometry>"
    )
    return f"""<model name='unit_cylinder_{number}'>
  <static>1</static>
  <pose frame=''>{x:f} {y:f} 0.000000 0.000000 0.000000 0.000000</pose>
  <link name='link'>
    <inertial><mass>1</mass></inertial>
    <collision name='collision'>{geometry}<max_contacts>10</max_contacts></collision>
    <visual name='visual'>{geometry}</visual>
  </link>
</model>
"""


def sdf(cylinders, floor=FLOOR):
    """A world_N.world of these cylinders, made in the format of the challenge's own."""
    models = "".join(model(n, *c) for n, c in enumerate(cylinders))
    state = "".join(
        f"<model name='unit_cylinder_{n}'><pose frame=''>{c[0]:f} {c[1]:f} 0 0 0 0</pose>"
        f"<link name='link'><pose frame=''>{c[0]:f} {c[1]:f} 0 0 0 0</pose></link></model>"
        for n, c in enumerate(cylinders)
    )
    return f"""<sdf version='1.6'><world name='default'>
<light name='sun' type='directional'><pose frame=''>0 0 10 0 -0 0</pose></light>
{floor}{models}<state world_name='default'>{state}</state></world></sdf>"""


def save_world(folder, text):
    (folder / "world_0.world").write_text(text, "utf-8")
    return str(folder / "world_0.world")


def save_path(folder, cells):
    np.save(folder / "path_0.npy", np.array(cells))
    return str(folder / "path_0.npy")


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


@given(cells=CELLS)
def test_a_world_file_gives_the_map_that_json_gives(tmp_path_factory, cells):
    cells -= {(15, 20)}
    folder = tmp_path_factory.mktemp("barn")
    cylinders = [cylinder(i, j) for i, j in sorted(cells)]
    plain = read(save(folder, world(cylinders_xyr=cylinders)))
    same_map(read(save_world(folder, sdf(cylinders))), plain)


def same_map(one, other):
    assert (one.weights == other.weights).all() and one.weights.shape == other.weights.shape
    assert (one.start, one.target, one.origin) == (other.start, other.target, other.origin)
    assert one.resolution == other.resolution


def test_a_path_gives_start_and_target(tmp_path):
    """Cell (x, y) of a path is column x - 1, and row 33 + y from the bottom."""
    path = save_world(tmp_path, sdf([cylinder(0, 0)]))
    cells = [[26, 0], [25, 1], [1, 29]]
    for scenario in (save_path(tmp_path, cells), save_path(tmp_path, np.array(cells, float))):
        grid = read(path, scenario=scenario)
        assert (grid.start, grid.target) == ((25, 63 - 33), (0, 63 - 62))
        assert grid.weights.shape == (64, 30)
        assert read(path, start=[1, 2], scenario=scenario).start == (1, 2)
        assert read(save(tmp_path, world()), scenario=scenario).target == (0, 1)


def npy(array, **more):
    file = io.BytesIO()
    np.save(file, array, **more)
    return file.getvalue()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "0 bytes"),
        (b"hello", "got no array of numbers, expected a path_N.npy"),
        (npy(np.zeros((3, 2), int))[:-5], "no array of numbers"),
        (npy(np.array([{}, {}], dtype=object), allow_pickle=True), "no array of numbers"),
        (npy(np.zeros((3, 3), int)), r"got an array of int64, \(3, 3\), expected cells"),
        (npy(np.zeros((0, 2), int)), r"got an array of int64, \(0, 2\)"),
        (npy(np.zeros(4, int)), r"got an array of int64, \(4,\)"),
        (npy(np.full((2, 2), np.nan)), "expected cells, a finite"),
        (npy(np.zeros((2, 2), "U1")), "got an array of <U1"),
        (
            npy(np.array([[0, 5], [3, 3]])),
            r"path_0.npy, start: got \[-4.575, 5.825\], expected a pl",
        ),
        (npy(np.array([[3, 3], [3, -99]])), "path_0.npy, goal: .* expected a place with"),
    ],
)
def test_bad_paths_are_refused(tmp_path, content, message):
    scenario = tmp_path / "path_0.npy"
    scenario.write_bytes(content)
    with pytest.raises(InputError, match=message):
        read(save(tmp_path, world()), scenario=str(scenario))


ONE = sdf([cylinder(3, 3)])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "0 bytes"),
        ("hello", "no XML"),
        (ONE[:-9], "no XML"),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]>" + ONE, "got a declaration of XML, expected a BARN world"),
        ("<world/>", "got <world>, expected a BARN world: SDF with cylinders"),
        ("<sdf/>", "got <sdf>, expected"),
        (sdf([], "<include><uri>model://house</uri></include>"), "got <include>"),
        (sdf([], model(9, 0, 0, 1, "box")), "model unit_cylinder_9: got box, expected"),
        (sdf([[-4.4, 0.075, 0.075]]), r"cylinders_xyr\[0\]: .* radius 0.075 and a centre"),
        (sdf([[-4.425, 0.075, 0.5]]), r"cylinders_xyr\[0\]: .* radius 0.075 and a centre"),
        (sdf([[0.5, 0.075, 0.075]]), r"cylinders_xyr\[0\]: .* expected a place with"),
        (ONE.replace("<radius>0.075000</radius>", ""), r"cylinders_xyr\[0\]: .* list of 3"),
        (ONE.replace("<radius>0.075000", "<radius>wide"), "model unit_cylinder_0: got 'wide'"),
        (ONE.replace("frame=''>-3", "frame=''>x"), "unit_cylinder_0: got 'x.*', expected numbers"),
        (
            ONE.replace("<inertial>", "<pose>1 0 0 0 0 0</pose><inertial>"),
            "a pose within the model",
        ),
        (sdf([cylinder(15, 20)]), r"start: got \[-2.25, 3.0\], on an obstacle"),
    ],
)
def test_bad_world_files_are_refused(tmp_path, text, message):
    path = save_world(tmp_path, text)
    with pytest.raises(InputError, match=message) as caught:
        read(path)
    assert str(caught.value).startswith(path)


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


def test_json_and_world_files_are_read_as_barn_worlds():
    assert readers()[".json"] == readers()[".world"] == "barn"


def test_the_six_worlds_can_be_crossed(data, tmp_path):
    paths = sorted((data / "barn").glob("*.json"))
    if not paths:
        pytest.skip(f"no worlds in {data / 'barn'}")
    for path in paths:
        grid = read(str(path))
        content = json.loads(path.read_text("utf-8"))
        cylinders = content["cylinders_xyr"]
        world_file = save_world(tmp_path, sdf(cylinders))
        same_map(read(world_file), grid)
        # the challenge's own path, which leads from the first row of the world to its last
        cells = np.array(content["path_cells"])
        ends = read(world_file, scenario=save_path(tmp_path, cells))
        assert (ends.start[1], ends.target[1]) == (30, 1)
        assert not ends.obstacles[30 - cells[:, 1], cells[:, 0] - 1].any()
        assert ends.target == (cells[-1, 0] - 1, 1)
        assert grid.obstacles.sum() == len({tuple(c) for c in cylinders})
        assert (grid.start, grid.target) == ((15, 66), (15, 0))
        assert shortest_path(Problem(grid, grid.start, grid.target)).feasible
