"""A map's table, entry by entry."""

from fractions import Fraction
from itertools import product
from math import floor

import naive
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from strategies import problems, weights

from gapath.grid import GridMap
from gapath.kernels.table import fill_parts, fill_table, least_three, weights_of
from gapath.kernels.units import OBSTACLE, SCALE

EDGES = [0.0, 0.5, 1.0, 0.5 / SCALE, 1.5 / SCALE, np.nextafter(0.5 / SCALE, 0), np.nextafter(1, 0)]


@given(st.lists(st.floats(0, 1) | st.sampled_from(EDGES), max_size=70))
def test_weights_are_rounded_half_up_and_only_1_is_an_obstacle(weights):
    table = np.full(len(weights), -7, dtype=np.int32)
    fill_table(np.array(weights, dtype=np.float64), table)
    exact = [floor(Fraction(float(w)) * SCALE + Fraction(1, 2)) for w in weights]
    # a double cannot hold a half and the last bits of a tiny weight: one unit either way there
    for entry, whole, weight in zip(table.tolist(), exact, weights, strict=True):
        assert entry == OBSTACLE if weight == 1 else abs(entry - whole) <= 1


def test_by_hand():
    table = np.empty(5, dtype=np.int32)
    fill_table(np.array([0.0, 0.5, 1.0, 0.99999999, 1.5 / SCALE]), table)
    assert table.tolist() == [0, SCALE // 2, OBSTACLE, SCALE, 2]


@given(st.lists(st.integers(0, 9), max_size=9))
def test_the_least_three_come_in_order_the_first_of_equal_ones_first(numbers):
    found = least_three(np.array(numbers, dtype=np.int32))
    assert found == sorted((number, i) for i, number in enumerate(numbers))[:3]


@given(problems(most=9, least=1), st.lists(st.integers(0, 80), max_size=9))
def test_weights_of_a_path_add_up(problem, places):
    rows, cols = problem.map.weights.shape
    path = [(place % cols, place // cols % rows) for place in places]
    total = sum(int(problem.map.table[y, x]) for x, y in path)
    fields = np.array(path, dtype=np.int32).reshape(-1, 2)
    assert weights_of(problem.map.table, fields) == total


@given(weights(7, least=1), st.booleans())
def test_parts_of_a_map_are_what_can_be_reached_in_the_order_of_fields(values, diagonal):
    parts = np.zeros(values.shape, dtype=np.int32)
    fill_parts(GridMap("random", values).table, diagonal, parts)
    expected, number = np.zeros(values.shape, dtype=np.int32), 0
    for begin in np.ndindex(values.shape):
        if values[begin] == 1 or expected[begin]:
            continue
        number += 1
        waiting = [begin]
        while waiting:
            y, x = waiting.pop()
            expected[y, x] = number
            for v, u in product((y - 1, y, y + 1), (x - 1, x, x + 1)):
                if (diagonal or v == y or u == x) and not naive.is_obstacle(values, u, v):
                    waiting += [(v, u)] if expected[v, u] == 0 else []
    assert parts.tolist() == expected.tolist()
