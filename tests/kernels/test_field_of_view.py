"""The robot's view against its description, all eight headings (KG18 Sec. 5)."""

import itertools

import naive
import naive_drive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import RULES, weights

from gapath.grid import GridMap
from gapath.kernels.field_of_view import follow, heading_of, remaining_cost, sense
from gapath.kernels.units import OBSTACLE


def see(table, place, heading, layers, occlusion):
    """Look once on a map of which nothing is known; give the fields seen."""
    known = np.full(table.shape, -1, dtype=np.int32)
    seen = np.zeros(table.shape, dtype=np.bool_)
    news, least = np.empty((2, (layers + 1) ** 2), dtype=np.int64), np.array([1 << 30])
    count = sense(table, known, seen, *place, heading, layers, occlusion, news, 0, least)
    fields = {(int(i) % table.shape[1], int(i) // table.shape[1]) for i in news[0, :count]}
    assert len(fields) == count
    assert (news[1, :count] == table.ravel()[news[0, :count]]).all()
    assert least[0] == table[seen].min(initial=1 << 30)
    assert fields == {(int(x), int(y)) for y, x in np.argwhere(seen)}
    assert (known == np.where(seen, table, -1)).all()
    return fields


@given(
    weights(),
    st.integers(0, 1000),
    st.integers(0, 7),
    st.integers(0, 6),
    st.booleans(),
)
def test_view_equals_its_description(values, at, heading, layers, occlusion):
    table = GridMap("random", values).table
    place = (at % table.shape[1], at // table.shape[1] % table.shape[0])
    expected = naive_drive.view(table, place, heading, layers, occlusion)
    assert see(table, place, heading, layers, occlusion) == expected


@pytest.mark.parametrize("heading", range(8))
def test_layer_x_has_2_x_plus_1_fields(heading):
    table = np.zeros((41, 41), dtype=np.int32)
    before = set()
    for layers in range(11):
        fields = see(table, (20, 20), heading, layers, False)
        assert len(fields - before) == 2 * layers + 1  # KG18 eq. (7)
        assert before < fields
        before = fields


def test_only_what_is_new_or_changed_is_news():
    table = np.zeros((9, 9), dtype=np.int32)
    known, seen = np.zeros_like(table), np.zeros(table.shape, dtype=np.bool_)
    news, least = np.empty((2, 9), dtype=np.int64), np.array([OBSTACLE])
    look = (known, seen, 4, 4, 0, 2, False, news, 0, least)
    assert sense(table, *look) == 9
    assert sense(table, *look) == 0
    table[4, 6] = OBSTACLE
    assert sense(table, *look) == 1
    assert news[:, 0].tolist() == [4 * 9 + 6, OBSTACLE]
    table[4, 6] = 0
    assert sense(table, *look) == 1
    assert known[4, 6] == 0


def test_an_obstacle_hides_what_lies_behind_it_but_not_itself():
    table = np.zeros((9, 9), dtype=np.int32)
    table[3:6, 5] = OBSTACLE
    seen = see(table, (4, 4), 0, 4, True)
    assert {(5, 3), (5, 4), (5, 5)} <= seen
    assert not {(x, y) for x, y in seen if x > 5}
    assert see(table, (4, 4), 0, 4, False) > seen


@pytest.mark.parametrize("heading", range(8))
def test_neighbours_are_never_hidden(heading):
    """A diagonal step shows both fields beside it: corners are known before they are passed."""
    table = np.full((5, 5), OBSTACLE, dtype=np.int32)
    assert len(see(table, (2, 2), heading, 1, True)) == 4


@given(st.integers(-50, 50), st.integers(-50, 50))
def test_headings(dx, dy):
    heading = heading_of(dx, dy)
    if max(abs(dx), abs(dy)) == 0:
        assert heading == 0
        return
    x, y = naive_drive.HEADINGS[heading]
    assert heading == naive_drive.heading_of(dx, dy)
    assert x * dx >= 0 and y * dy >= 0 and x * dx + y * dy > 0
    assert heading_of(-dx, -dy) == (heading + 4) % 8


def test_headings_of_steps():
    assert [heading_of(*step) for step in naive_drive.HEADINGS] == list(range(8))


@st.composite
def walks(draw):
    """A map and a path on it, which may lead over obstacles."""
    values = draw(weights())
    rows, cols = values.shape
    x, y = draw(st.integers(0, cols - 1)), draw(st.integers(0, rows - 1))
    fields = [(x, y)]
    for dx, dy in draw(st.lists(st.sampled_from(naive_drive.HEADINGS), max_size=12)):
        x, y = min(max(x + dx, 0), cols - 1), min(max(y + dy, 0), rows - 1)
        fields.append((x, y))
    return values, np.array(fields, dtype=np.int32)


@given(walks(), st.integers(0, 3), st.data())
def test_remaining_cost(walk, rule, data):
    values, path = walk
    table = GridMap("random", values).table
    first = data.draw(st.integers(0, len(path) - 1))
    entries = table[path[first:, 1], path[first:, 0]]
    steps = itertools.pairwise(map(tuple, path[first:].tolist()))
    cut = any(naive.forbidden(values, a, b, RULES[rule]) for a, b in steps)
    expected = -1 if cut or (entries == OBSTACLE).any() else entries.sum()
    assert remaining_cost(table, path, first, rule) == expected


@given(walks(), st.integers(0, 3), st.integers(1, 4), st.booleans())
def test_to_follow_a_path_is_to_look_step_by_step(walk, rule, layers, occlusion):
    values, path = walk
    target = tuple(path[len(path) // 2].tolist())  # somewhere, as where a path passes it
    table = GridMap("random", values).table
    known = np.full(table.shape, OBSTACLE // 2, dtype=np.int32)
    expected, told = known.copy(), []
    for i, ((x, y), (u, v)) in enumerate(itertools.pairwise(path.tolist())):
        heading = heading_of(u - x, v - y)
        fields = naive_drive.view(table, (x, y), heading, layers, occlusion)
        news = {y * table.shape[1] + x for x, y in fields if expected[y, x] != table[y, x]}
        told.append((heading, news))
        for x, y in fields:
            expected[y, x] = table[y, x]
        if remaining_cost(expected, path, i, rule) < 0 or (u, v) == target:
            break

    steps = len(path) - 1
    news, looks = np.empty((2, table.size), dtype=np.int64), np.empty((2, steps), dtype=np.int64)
    seen, least = np.zeros(table.shape, dtype=np.bool_), np.array([1 << 30])
    sees = (layers, occlusion, news, looks, least)
    goal = target[1] * table.shape[1] + target[0]
    count = follow(table, known, seen, path, steps, goal, rule, *sees)
    ends = looks[1, :count].tolist()
    shown = [set(news[0, a:b].tolist()) for a, b in zip([0, *ends], ends, strict=False)]
    assert list(zip(looks[0, :count].tolist(), shown, strict=True)) == told
    assert (known == expected).all()
    if count:
        assert (news[1, : ends[-1]] == table.ravel()[news[0, : ends[-1]]]).all()
        assert least[0] == table[seen].min()


def test_who_follows_a_path_stops_where_an_obstacle_comes_in_sight():
    values = np.full((9, 60), 0.5)
    values[4, 40] = 1.0
    table = GridMap("one", values).table
    known, seen = np.full_like(table, table[0, 0]), np.zeros(table.shape, dtype=np.bool_)
    path = np.array([(x, 4) for x in range(60)], dtype=np.int32)
    news, looks = np.empty((2, table.size), dtype=np.int64), np.empty((2, 59), dtype=np.int64)
    least = np.array([1 << 30])
    assert follow(table, known, seen, path, 59, -1, 0, 5, False, news, looks, least) == 36


def known_but_for(picture, known, path, layers=1):
    """Follow a path across a map of which all but the difference is known; give looks and news."""
    table, known = (GridMap("p", np.array(rows)).table.copy() for rows in (picture, known))
    seen, path = np.ones(table.shape, dtype=np.bool_), np.array(path, dtype=np.int32)
    news, least = np.empty((2, table.size), dtype=np.int64), np.array([1 << 30])
    looks = np.empty((2, len(path) - 1), dtype=np.int64)
    sees = (layers, False, news, looks, least)
    count = follow(table, known, seen, path, len(path) - 1, -1, 0, *sees)
    return count, looks[:, :count].tolist(), news[0, : looks[1, count - 1]].tolist()


def test_who_follows_a_path_stops_at_what_alone_is_new():
    free, wall = [0.5] * 6, [0.5, 0.5, 0.5, 1.0, 0.5, 0.5]
    path = [(x, 0) for x in range(6)]
    assert known_but_for([wall], [free], path) == (3, [[0, 0, 0], [0, 0, 1]], [3])
    assert known_but_for([wall], [wall], path) == (1, [[0], [0]], [])  # it was known before
    assert known_but_for([free], [wall], path, layers=5) == (5, [[0] * 5, [1] * 5], [3])


@pytest.mark.parametrize(
    ("heading", "numbers"),
    [
        (0, [12, 8, 13, 18, 4, 9, 14, 19, 24]),
        (2, [12, 16, 17, 18, 20, 21, 22, 23, 24]),
        (4, [12, 16, 11, 6, 20, 15, 10, 5, 0]),
        (6, [12, 8, 7, 6, 4, 3, 2, 1, 0]),
    ],
)
def test_fields_are_told_layer_by_layer_in_one_order(heading, numbers):
    table = np.zeros((5, 5), dtype=np.int32)
    seen, news = np.zeros(table.shape, dtype=np.bool_), np.empty((2, 9), dtype=np.int64)
    assert sense(table, table, seen, 2, 2, heading, 2, False, news, 0, np.array([0])) == 9
    assert news[0].tolist() == numbers
