"""What the robot knows: growth, and bounds that are never above the truth."""

import numpy as np
from drive_strategies import UNKNOWN, queries
from hypothesis import given
from hypothesis import strategies as st
from naive import shortest_cost

from gapath.driving.known_map import KnownMap, _lies_between
from gapath.driving.navigation import Situation
from gapath.grid import GridMap
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.planning.shortest_path import shortest_path


def as_weights(known):
    return np.where(known.table == OBSTACLE, 1.0, known.table / SCALE)


@given(queries())
def test_seen_fields_are_true_and_others_unknown(drawn):
    problem, query = drawn
    known = query.map
    expected = np.where(known.seen, problem.map.table, int(UNKNOWN * SCALE))
    assert (known.table == expected).all()
    for x, y in (problem.start, problem.target):
        assert known.seen[y, x]


@given(queries())
def test_astar_is_exact_on_what_is_known(drawn):
    """Its estimate is built on `least_weight`: a bound too high would spoil the optimum."""
    _, query = drawn
    rule = query.corner_cutting.name.lower()
    expected = shortest_cost(as_weights(query.map), query.start, query.target, rule)
    assert shortest_path(query).cost == expected


@given(queries())
def test_no_field_between_undercuts_the_least_weight(drawn):
    """Except the drive's start, which counts only where no straightest way leads over it."""
    problem, query = drawn
    least = query.map.least_weight(query.start, query.target)
    others = query.map.table.copy()
    for x, y in (problem.start, query.start, query.target):
        others[y, x] = OBSTACLE
    assert least <= others.min()


def test_a_light_start_on_the_way_lowers_the_bound():
    values = np.full((3, 9), 0.5)
    values[1, 4] = 0.0
    known = KnownMap(GridMap("light", values), (4, 1), (8, 1), UNKNOWN)
    assert known.least_weight((4, 1), (8, 1)) == SCALE // 2
    assert known.least_weight((0, 1), (8, 1)) == 0
    assert shortest_path(Situation(known, (0, 1), (8, 1), 0)).cost == 8 * 0.5


def test_what_is_known_before_the_drive():
    values = np.full((5, 5), 0.25)
    values[2, 2] = 1.0
    before = np.full((5, 5), 0.25)
    before[1, 1] = before[0, 0] = before[4, 4] = 1.0
    known = KnownMap(GridMap("w", values), (0, 0), (4, 4), UNKNOWN, GridMap("b", before))
    obstacles = {(int(x), int(y)) for y, x in np.argwhere(known.table == OBSTACLE)}
    assert obstacles == {(1, 1)}  # the ends are free in the world
    assert known.table[2, 2] == SCALE // 2
    assert not known.seen[1, 1]
    known.look(GridMap("w", values).table, (0, 0), 1, 4, False)
    obstacles = {(int(x), int(y)) for y, x in np.argwhere(known.table == OBSTACLE)}
    assert obstacles == {(2, 2)}
    assert known.least_weight((0, 0), (4, 4)) == SCALE // 4


def test_dearer_is_a_copy():
    known = KnownMap(GridMap("w", np.full((4, 4), 0.5)), (0, 0), (3, 3), UNKNOWN)
    copy = known.dearer(((1, 1), (1, 1), (2, 1)), 3.0)
    changed = {(int(x), int(y)) for y, x in np.argwhere(copy.table != known.table)}
    assert changed == {(1, 1), (2, 1)}
    assert copy.table[1, 1] == 3.5 * SCALE
    assert (known.table == SCALE // 2).sum() == 16
    assert copy.least_weight((0, 0), (3, 3)) == SCALE // 2
    appeared = np.full((4, 4), 0.5)
    appeared[2, 2] = 1.0  # behind the robot
    known.look(GridMap("w", appeared).table, (0, 0), 1, 3, False)
    assert known.dearer(((2, 2),), 3.0).table[2, 2] >= OBSTACLE


places = st.tuples(st.integers(0, 8), st.integers(0, 5))


@given(places, places)
def test_whether_the_start_shortens_a_way_is_told_by_its_neighbours(start, target):
    y, x = np.mgrid[0:6, 0:9]
    to_start = np.maximum(abs(x - start[0]), abs(y - start[1]))
    to_target = np.maximum(abs(x - target[0]), abs(y - target[1]))
    between = to_start + to_target[start[1], start[0]] == to_target
    assert _lies_between(start, target, 6, 9) == (np.count_nonzero(between) > 1)
