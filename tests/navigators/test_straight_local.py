"""S04's local planning: straight on, around what is in the way, and back."""

import itertools

import numpy as np
import pytest
from drive_strategies import queries
from hypothesis import given
from hypothesis import strategies as st

from gapath.components import build
from gapath.discovery import yaml_values
from gapath.driving.drive import Sensor, drive
from gapath.driving.world import Changes
from gapath.errors import InputError
from gapath.events import Outcome
from gapath.grid import GridMap
from gapath.kernels.units import OBSTACLE
from gapath.navigators.straight_local import staircase, subsections
from gapath.problem import CornerCutting, Problem

STATIC, SENSOR = Changes(0, 1, 1), Sensor(4, False)
places = st.tuples(st.integers(0, 60), st.integers(0, 60))


def navigator(**values):
    return build("navigator", yaml_values("navigator", "sedighi") | values, "navigator")


def go(weights, start, target, seed=0, **values):
    problem = Problem(GridMap("map", weights), start, target, CornerCutting.NO_DIAGONALS)
    return drive(problem, navigator(**values), SENSOR, STATIC, seed, 0, 2000, 0.5)


def test_a_staircase_by_hand():
    path = staircase((0, 0), (4, 2)).tolist()
    assert path == [[0, 0], [1, 0], [1, 1], [2, 1], [3, 1], [3, 2], [4, 2]]
    assert staircase((3, 3), (3, 3)).tolist() == [[3, 3]]
    assert staircase((3, 3), (0, 3)).tolist() == [[3, 3], [2, 3], [1, 3], [0, 3]]


@given(places, places)
def test_a_staircase_is_short_and_near_the_straight_line(start, target):
    path = staircase(start, target)
    dx, dy = target[0] - start[0], target[1] - start[1]
    assert tuple(path[0]) == start and tuple(path[-1]) == target
    assert len(path) == abs(dx) + abs(dy) + 1
    assert (np.abs(np.diff(path, axis=0)).sum(axis=1) == 1).all()
    off = np.abs((path[:, 0] - start[0]) * dy - (path[:, 1] - start[1]) * dx)
    assert (2 * off <= abs(dx) + abs(dy)).all()  # the nearest field of either move


@given(queries(), st.lists(st.integers(2, 20), min_size=1, max_size=3))
def test_a_subsection_is_the_map_around_robot_and_obstacle(case, sides):
    _, query = case
    table = query.map.table
    line = staircase(query.start, query.target)
    blocked = table[line[:, 1], line[:, 0]] >= OBSTACLE
    if not blocked.any():
        return
    for around in subsections(query, line, blocked, sides):
        x, y = around.map.corner
        n = around.map.rows
        assert n == around.map.cols and n in sides
        for v in range(n):
            for u in range(n):
                inside = 0 <= x + u < query.map.cols and 0 <= y + v < query.map.rows
                assert around.map.table[v, u] == (table[y + v, x + u] if inside else OBSTACLE)
        assert (around.start[0] + x, around.start[1] + y) == query.start
        target = [around.target[0] + x, around.target[1] + y]
        at = line.tolist().index(target)
        assert not blocked[at] and blocked[:at].any()
        assert max(around.start + around.target) < n


def test_it_goes_straight_until_something_is_in_the_way():
    weights = np.full((20, 40), 0.5)
    weights[6:14, 20] = 1.0
    driven = go(weights, (0, 10), (39, 10))
    assert driven.outcome is Outcome.REACHED
    steps = [frame.place for frame in driven.frames]
    seen = next(
        i for i, frame in enumerate(driven.frames) if frame.decision and frame.decision.calls
    )
    assert steps[:seen] == [(x, 10) for x in range(seen)]  # straight on
    assert seen >= 15  # no sooner than it sees the obstacle
    assert all(abs(u - x) + abs(v - y) == 1 for (x, y), (u, v) in itertools.pairwise(steps))


def test_a_known_obstacle_far_away_does_not_stop_it():
    weights = np.full((20, 90), 0.5)
    weights[8:13, 60] = 1.0
    grid = GridMap("far", weights)
    problem = Problem(grid, (0, 10), (89, 10))
    going = navigator(subsections=[10, 20])
    driven = drive(problem, going, SENSOR, STATIC, 0, 0, 500, 0.5, before=grid)
    first = next(i for i, f in enumerate(driven.frames) if f.decision and f.decision.calls)
    assert driven.frames[first - 1].place == (54, 10)  # five fields before it, as no square of 20
    assert driven.outcome is Outcome.REACHED


def test_it_turns_round_once_and_goes_home_without_news():
    weights = np.full((30, 40), 0.5)
    weights[2:28, 20] = 1.0
    weights[2, 5:20] = weights[27, 5:20] = 1.0  # a pocket too large for its squares
    driven = go(weights, (8, 15), (39, 15), subsections=[10])
    assert driven.outcome is Outcome.RETURNED
    assert driven.frames[-1].place == (8, 15)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("subsections", []),
        ("subsections", [1]),
        ("subsections", [10, 701]),
        ("retreat_interval", 0),
        ("retreat_interval", 10**6 + 1),
        ("planner", 3),
    ],
)
def test_bad_settings(name, value):
    with pytest.raises(InputError, match=rf"navigator\.{name}"):
        navigator(**{name: value})


def test_a_planner_that_needs_too_much_memory_on_the_largest_square_is_refused():
    with pytest.raises(InputError, match=r"planner\.max_epochs: .* GiB"):
        navigator(planner={"base": "sedighi", "max_epochs": 10**6}, subsections=[10, 700])
