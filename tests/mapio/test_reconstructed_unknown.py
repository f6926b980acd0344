"""The classes of maps that a robot drives through without knowing them."""

import numpy as np
import pytest
from scipy import ndimage
from strategies import planner

from gapath.driving.drive import Sensor, drive
from gapath.driving.known_map import KnownMap
from gapath.driving.world import Changes
from gapath.errors import InputError
from gapath.events import Outcome
from gapath.kernels.lines import ONE_OBSTACLE, line_key
from gapath.kernels.units import ALLOW
from gapath.mapio.reconstructed import UNKNOWN_CLASSES, Reader, generate
from gapath.navigators.kg18 import Navigator
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, PlanStatus, Problem

INSTANCES = range(30)
SOLVABLE = ["kg18_map1", "kg18_map2", "kg18_map3", "kg18_map4"]
ALL_EIGHT = np.ones((3, 3))
SENSOR = Sensor(range=4, occlusion=False)
KG18 = Navigator(
    planner(population=100, control_points=5, max_epochs=100),
    planner(population=40, min_epochs=10, max_epochs=10),
    [
        planner(population=100, control_points=k, min_epochs=10, max_epochs=200)
        for k in (4, 5, 6, 8)
    ],
    explore_interval=5,
    retreat_interval=[2, 3],
    return_penalty=0.0,
)


def problem(name, instance, rule=CornerCutting.ALLOW):
    grid = generate(name, instance)
    return Problem(grid, grid.start, grid.target, rule)


def outcome(name, instance, trial):
    still = Changes(every=0, lifetime=1, side=1)
    return drive(problem(name, instance), KG18, SENSOR, still, 0, trial, 2000, 0.5).outcome


@pytest.mark.parametrize("name", UNKNOWN_CLASSES)
def test_the_committed_map_is_the_canonical_instance(name):
    read, drawn = Reader(name, 0).read(), generate(name, 0)
    assert read.digest == drawn.digest
    assert (read.name, read.start, read.target, read.source) == (
        name,
        (0, 24),
        (98, 24),
        "reconstructed",
    )
    assert generate(name, 7).digest == generate(name, 7).digest


@pytest.mark.parametrize("name", UNKNOWN_CLASSES)
def test_instances_differ_and_their_ends_are_clear(name):
    grids = [generate(name, i) for i in INSTANCES]
    assert len({grid.digest for grid in grids}) == len(INSTANCES)
    for grid in grids:
        assert grid.weights.shape == (50, 100)
        assert set(np.unique(grid.weights)) == {0.0, 0.5, 1.0}
        assert np.argwhere(grid.weights == 0).tolist() == [[24, 0], [24, 98]]
        assert not grid.obstacles[19:30, :6].any()
        assert not grid.obstacles[19:30, 93:].any()


@pytest.mark.parametrize("name", SOLVABLE)
def test_the_straight_line_is_blocked_but_another_way_is_free(name):
    for i in INSTANCES:
        p = problem(name, i, CornerCutting.FORBID)
        assert line_key(p.map.table, *p.start, *p.target, ALLOW) >= ONE_OBSTACLE
        assert shortest_path(p).feasible


@pytest.mark.parametrize(("name", "count"), [("kg18_map1", 1), ("kg18_map2", 22)])
def test_simple_obstacles_are_so_many_rectangles(name, count):
    for i in INSTANCES:
        labels, found = ndimage.label(generate(name, i).obstacles, ALL_EIGHT)
        assert found == count
        for number, box in enumerate(ndimage.find_objects(labels), start=1):
            assert (labels[box] == number).all()


def test_rooms_have_thin_walls_and_doors_that_are_three_fields_wide_or_more():
    for i in INSTANCES:
        grid = generate("kg18_map3", i)
        assert not ndimage.binary_erosion(grid.obstacles, np.ones((2, 2))).any()
        _, parts = ndimage.label(~grid.obstacles)
        assert parts == 1  # no room without a door
        wide = ndimage.binary_erosion(~grid.obstacles, ALL_EIGHT, border_value=1)
        labels, _ = ndimage.label(wide)
        assert labels[grid.start[::-1]] == labels[grid.target[::-1]] > 0
        doors_closed = ndimage.binary_closing(np.pad(grid.obstacles, 6), np.ones((7, 7)))
        _, rooms = ndimage.label(~doors_closed[6:-6, 6:-6])
        assert rooms >= 6


def test_complex_environments_have_blind_alleys():
    """Fields that one reaches without going left, but must leave to the left."""
    for i in INSTANCES:
        free = ~generate("kg18_map4", i).obstacles
        from_start = reached_without_going_left(free, (24, 0))
        to_target = reached_without_going_left(free[:, ::-1], (24, 1))[:, ::-1]
        assert (from_start & ~to_target).sum() >= 100


def reached_without_going_left(free, place):
    reached = np.zeros_like(free)
    reached[place] = True
    for x in range(place[1], free.shape[1]):
        column, _ = ndimage.label(free[:, x])
        seeds = (reached[:, x] | (reached[:, x - 1] if x else False)) & free[:, x]
        reached[:, x] = np.isin(column, np.unique(column[seeds])) & free[:, x]
    return reached


def test_an_enclosed_target_cannot_be_reached_and_the_start_shows_nothing_of_it():
    for i in INSTANCES:
        p = problem("kg18_enclosed", i)
        assert shortest_path(p).status is PlanStatus.INFEASIBLE
        for heading in range(8):
            known = KnownMap(p.map, p.start, p.target, 0.5)
            known.look(p.map.table, p.start, heading, SENSOR.range, SENSOR.occlusion)
            assert (known.table < p.map.table.max()).all()


@pytest.mark.parametrize("name", SOLVABLE[:3])
def test_the_first_three_classes_are_nearly_always_crossed(name):
    outcomes = [outcome(name, i, 0) for i in INSTANCES]
    assert outcomes.count(Outcome.REACHED) >= 29


def test_the_fourth_class_is_sometimes_too_hard_and_no_drive_is_endless():
    # Of four drives on each of the 30 instances 89 % reached the target.
    outcomes = [outcome("kg18_map4", i, 0) for i in (0, 1, 2, 3, 5, 6)]
    assert Outcome.OVERRAN not in outcomes
    assert 3 <= outcomes.count(Outcome.REACHED) <= 5


def test_a_robot_comes_back_from_an_enclosed_target():
    assert outcome("kg18_enclosed", 0, 0) is Outcome.RETURNED


@pytest.mark.parametrize(
    ("values", "message"),
    [(("kg18_map5", 0), "map.map_class"), (("kg18_map4", -1), "map.instance")],
)
def test_unknown_classes_and_instances_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        Reader(*values)
