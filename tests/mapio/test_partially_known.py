"""A robot that knows a part of the map: MRPB's office02 without the rooms in its middle."""

import pytest
from strategies import planner

from gapath.driving.drive import Sensor, drive
from gapath.driving.known_map import KnownMap
from gapath.driving.world import Changes
from gapath.events import Outcome
from gapath.mapio.rosmap import Reader
from gapath.navigators.kg18 import Navigator
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem

START, TARGET = (115, 200), (258, 200)  # the corridors left and right of the unknown rooms


def office(data, name, unknown):
    path = data / "ros" / "mrpb" / name / "map.yaml"
    if not path.is_file():
        pytest.skip(f"no {path}")
    return Reader(str(path), list(START), list(TARGET), 0.5, unknown).read()


@pytest.fixture
def pair(data):
    """The true map, and what the robot knows: walls, the rest unknown and therefore free."""
    return office(data, "office02", "obstacle"), office(data, "office02_partially_unknown", "free")


def test_the_two_maps_fit_each_other(pair):
    true, before = pair
    assert true.weights.shape == before.weights.shape == (380, 380)
    assert (true.resolution, true.origin) == (before.resolution, before.origin)
    assert not (before.obstacles & ~true.obstacles).any()
    inside = true.obstacles[156:234, 122:253] & ~before.obstacles[156:234, 122:253]
    assert inside.sum() > 500


def test_the_robot_begins_with_the_partial_map(pair):
    true, before = pair
    known = KnownMap(true, START, TARGET, 0.5, before)
    assert (known.table == before.table).all()
    assert known.seen.sum() == 2


def test_a_drive_across_the_office_meets_rooms_that_the_robot_did_not_know(pair):
    true, before = pair
    problem = Problem(true, START, TARGET)
    navigator = Navigator(
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
    driven = drive(problem, navigator, Sensor(4, False), Changes(0, 1, 1), 0, 0, 2000, 0.5, before)
    assert driven.outcome is Outcome.REACHED
    places = [frame.place for frame in driven.frames]
    assert any(before.weights[y, x] < 1 and 122 <= x < 253 for x, y in places)
    assert not any(true.obstacles[y, x] for x, y in places)
    replans = [f for f in driven.frames[1:] if any(c.part == "C" for c in f.decision.calls)]
    assert len(replans) > 1  # the first path, and what unknown walls made necessary
    assert len(places) - 1 > len(shortest_path(problem).path) - 1
