"""The population: rows that move, a diary that grows, and who passes obstacles on the same side."""

import naive_memetic as slow
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from naive_memetic import places, polygons, vertices

from gapath.grid import GridMap
from gapath.kernels.memetic.population import (
    END,
    EPOCH,
    GAIN,
    OPERATOR,
    ROW,
    RUNGS,
    TOTAL,
    Diary,
    individuals,
    length_of,
    noted,
    put,
    same_side,
    with_room,
)
from gapath.problem import CornerCutting

POLYGON = st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=9)


@given(st.lists(st.tuples(st.integers(0, 2), POLYGON), min_size=1, max_size=12))
def test_a_population_and_its_diary_are_lists_of_polygons(changes):
    members = individuals(3, 1)
    diary = Diary(
        np.empty((1, 6), dtype=np.int64), np.empty((1, 2), dtype=np.int32),
        np.zeros(2, dtype=np.int64),
    )  # fmt: skip
    rows, told = {}, []
    for i, (row, points) in enumerate(changes):
        costs = np.arange(len(points)) + i
        members = put(members, row, vertices(points), costs, len(points), 100 + i)
        rows[row] = (points, costs[:-1].tolist(), 100 + i)
        told += points
        diary = noted(diary, members, 7 * i, row, i % 5, 1000 - i)
        members = with_room(members, len(points) + i)
    for row, (points, costs, total) in rows.items():
        size = members.sizes[row]
        assert places(members.points[row, :size]) == points
        assert members.costs[row, : size - 1].tolist() == costs
        assert members.totals[row] == total
    assert [n for n in range(3) if members.sizes[n] == 0] == [n for n in range(3) if n not in rows]
    n, m = diary.counts
    assert (n, m) == (len(changes), len(told))
    assert places(diary.vertices[:m]) == told
    ends = np.cumsum([len(points) for _, points in changes])
    for i, (row, _) in enumerate(changes):
        told_of = diary.changes[i][[EPOCH, ROW, OPERATOR, GAIN, TOTAL, END]].tolist()
        assert told_of == [7 * i, row, i % 5, 1000 - i, 100 + i, ends[i]]


@given(polygons(least=2), st.data())
def test_sides_are_compared_at_as_many_places_as_by_the_slow_twin(drawn, data):
    problem, first = drawn
    name, rule = problem.corner_cutting.name.lower(), int(problem.corner_cutting)
    middle = data.draw(st.integers(0, len(first) - 1))
    second = data.draw(st.sampled_from([[first[0], first[-1]], first[: middle + 1] + first[-1:]]))
    assert length_of(vertices(first), len(first)) == len(slow.naive.polyline(first)) - 1
    if first[0] == first[-1] and len(set(first)) == 1:
        return
    table = problem.map.table
    same = same_side(table, vertices(first), len(first), vertices(second), len(second), rule)
    assert same == slow.same_side(problem.map.weights, first, second, name, RUNGS)


@pytest.mark.parametrize(
    ("first", "second", "same"),
    [
        ([(0, 5), (10, 0), (20, 5)], [(0, 5), (10, 1), (20, 5)], True),
        ([(0, 5), (10, 0), (20, 5)], [(0, 5), (10, 10), (20, 5)], False),
        ([(0, 5), (10, 10), (20, 5)], [(0, 5), (9, 9), (10, 10), (20, 5)], True),
        ([(0, 5), (2, 5), (10, 0), (20, 5)], [(0, 5), (10, 0), (20, 5)], True),
    ],
)
@pytest.mark.parametrize("rule", list(CornerCutting), ids=lambda rule: rule.name.lower())
def test_sides_of_one_obstacle(first, second, same, rule):
    weights = np.full((11, 21), 0.5)
    weights[3:8, 8:13] = 1.0
    table = GridMap("one", weights).table
    for a, b in ((first, second), (second, first)):
        found = same_side(table, vertices(a), len(a), vertices(b), len(b), int(rule))
        assert found is same


def test_a_column_between_two_rays_is_overlooked():
    """So the docstring says: 15 rays look at most."""
    weights = np.full((11, 41), 0.5)
    weights[5, 20] = 1.0
    first, second = [(0, 5), (20, 0), (40, 5)], [(0, 5), (20, 10), (40, 5)]
    for column, same in ((20, False), (21, True)):
        weights[5, 19:23] = 0.5
        weights[5, column] = 1.0
        table = GridMap("column", weights).table
        assert same_side(table, vertices(first), 3, vertices(second), 3, 0) is same
