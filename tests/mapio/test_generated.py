"""The generated classes: of their kind at any size, their ends joined and far apart."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from gapath.components import build
from gapath.discovery import yaml_values
from gapath.errors import InputError
from gapath.mapio.generated import CLASSES
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Problem

WIDTH, HEIGHT = 300, 200
INSTANCES = range(5)


def drawn(name, instance=0, **values):
    values = yaml_values("map", name) | {"width": WIDTH, "height": HEIGHT} | values
    return build("map", values | {"instance": instance}, "map").read()


@pytest.mark.parametrize("name", CLASSES)
def test_a_map_is_as_large_as_asked_for_and_instances_differ(name):
    values = yaml_values("map", name)
    assert (values["width"], values["height"], values["map_class"]) == (2000, 1000, name)
    grids = [drawn(name, i) for i in INSTANCES]
    assert len({grid.digest for grid in grids}) == len(INSTANCES)
    for i, grid in enumerate(grids):
        assert (grid.cols, grid.rows) == (WIDTH, HEIGHT)
        assert (grid.name, grid.instance, grid.source) == (name, i, "generated")
    again = drawn(name, 3)
    ends = (grids[3].start, grids[3].target)
    assert (again.digest, again.start, again.target) == (grids[3].digest, *ends)


@pytest.mark.parametrize("name", CLASSES)
def test_ends_are_joined_by_every_rule_and_lie_at_opposite_borders(name):
    for i in INSTANCES:
        grid = drawn(name, i)
        assert grid.start[0] <= 0.2 * WIDTH and grid.target[0] >= 0.8 * WIDTH
        for rule in CornerCutting:
            assert shortest_path(Problem(grid, grid.start, grid.target, rule)).feasible


@pytest.mark.parametrize("name", [name for name in CLASSES if name != "field_terrain"])
def test_all_but_terrain_are_uniform(name):
    assert set(np.unique(drawn(name).weights)) == {0.5, 1.0}


@pytest.mark.parametrize("share", [0.0, 0.1, 0.3, 0.4])
def test_a_share_of_the_fields_is_obstacles(share):
    for i in INSTANCES:
        noise, clutter = (drawn(f"field_{n}", i, share=share) for n in ("noise", "clutter"))
        assert noise.obstacles.mean() == pytest.approx(share, abs=0.01)
        more = clutter.obstacles.sum() - share * WIDTH * HEIGHT
        assert 0 <= more <= 60 * 60 * (share > 0)  # less than one obstacle


def free_runs(row):
    """Lengths of the free runs of a row."""
    labels, _ = ndimage.label(~row)
    return np.bincount(labels)[1:]


@settings(max_examples=25)
@given(st.integers(1, 40), st.integers(20, 120), st.integers(20, 120), st.integers(0, 2**32 - 1))
def test_between_two_places_of_a_maze_there_is_one_way(size, width, height, instance):
    """Free fields enclose no wall: every piece of wall is joined to the border."""
    grid = drawn("field_maze", instance, width=width, height=height, size=size)
    walled = np.pad(grid.obstacles, 1, constant_values=True)
    assert ndimage.label(~grid.obstacles)[1] == 1
    assert ndimage.label(walled, np.ones((3, 3)))[1] == 1


@pytest.mark.parametrize("size", [1, 5, 16])
def test_corridors_are_as_wide_as_asked_for_and_walls_one_field_thick(size):
    blocked = drawn("field_maze", size=size).obstacles
    for lines in (blocked, blocked.T):
        assert min(min(free_runs(line), default=size) for line in lines) == size
    if size > 1:
        assert not ndimage.binary_erosion(blocked, np.ones((2, 2))).any()


@pytest.mark.parametrize("size", [2, 8, 32])
def test_rooms_are_square_behind_walls_of_one_field_with_narrow_doors(size):
    blocked = drawn("field_rooms", size=size).obstacles
    walls = blocked.copy()
    walls[:, size :: size + 1][:, : (WIDTH + 1) // (size + 1) - 1] = True
    walls[size :: size + 1][: (HEIGHT + 1) // (size + 1) - 1] = True
    assert (walls | blocked).sum() == walls.sum()  # no obstacle but in a wall
    assert ndimage.label(~blocked)[1] == 1
    labels, doors = ndimage.label(walls & ~blocked)
    sides = np.array([np.shape(labels[box]) for box in ndimage.find_objects(labels)])
    assert sides.min() == 1 and sides.max() == min(3, size)
    _, rooms = ndimage.label(~walls)
    assert rooms == ((WIDTH + 1) // (size + 1)) * ((HEIGHT + 1) // (size + 1))
    rows, cols = (HEIGHT + 1) // (size + 1), (WIDTH + 1) // (size + 1)
    possible = rows * (cols - 1) + cols * (rows - 1)
    least = rows * cols - 1  # a maze's, then half of the others
    others = possible - least
    assert (doors - least) / others == pytest.approx(0.5, abs=2 / np.sqrt(others))


def test_terrain_is_smooth_between_0_1_and_0_9():
    size = 40
    for i in INSTANCES:
        grid = drawn("field_terrain", i, size=size, share=0.0)
        assert 0.1 <= grid.weights.min() < 0.3 and 0.7 < grid.weights.max() <= 0.9
        for axis in (0, 1):  # Perlin's fade is nowhere steeper than 1.5 heights in a distance
            assert np.abs(np.diff(grid.weights, axis=axis)).max() <= 1.5 * 0.8 / size + 2e-4
        assert drawn("field_terrain", i).obstacles.mean() == pytest.approx(0.1, abs=0.03)


def test_map_4_is_five_walls_that_leave_a_gap_at_one_border_in_turn():
    for i in INSTANCES:
        blocked = drawn("field_map4", i).obstacles
        labels, walls = ndimage.label(blocked)
        assert walls == 5
        boxes = sorted(ndimage.find_objects(labels), key=lambda box: box[1].start)
        touching = [box[0].start == 0 for box in boxes]
        assert touching in ([True, False] * 2 + [True], [False, True] * 2 + [False])
        for (rows, cols), column in zip(boxes, (14, 31, 48, 65, 82), strict=True):
            assert abs(cols.start - column * WIDTH / 100) <= 0.03 * WIDTH + 1
            assert 0.02 * WIDTH <= cols.stop - cols.start <= 0.03 * WIDTH
            assert 6 / 50 * HEIGHT <= HEIGHT - (rows.stop - rows.start) <= 12 / 50 * HEIGHT


@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("field_rooms", {"map_class": "field_room"}, "map.map_class: got field_room, expected one"),
        ("field_rooms", {"instance": -1}, "map.instance: got -1"),
        ("field_rooms", {"width": 19}, "map.width: got 19, expected an integer from 20 to 8192"),
        ("field_noise", {"height": 8193}, "map.height: got 8193"),
        ("field_rooms", {"size": 1}, "map.size: got 1, expected an integer from 2 to 1024"),
        ("field_maze", {"size": None}, "map.size: got None, expected an integer from 1 to 1024"),
        ("field_map4", {"size": 3}, "map.size: got 3, expected null: field_map4 has no such"),
        ("field_maze", {"share": 0.3}, "map.share: got 0.3, expected null: field_maze has no such"),
        ("field_noise", {"share": 0.41}, "map.share: got 0.41, expected a number from 0 to 0.4"),
        ("field_clutter", {"share": float("nan")}, "map.share: got nan"),
        ("field_terrain", {"share": None}, "map.share: got None, expected a number from 0 to 0.4"),
    ],
)
def test_what_is_out_of_range_or_of_another_class_is_refused(name, values, message):
    with pytest.raises(InputError, match=message):
        build("map", yaml_values("map", name) | values, "map")
