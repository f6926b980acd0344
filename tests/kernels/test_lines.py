"""Lines and paths, field by field, against the naive twin and by hand."""

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import RULES, problems, weights

from gapath.grid import GridMap
from gapath.kernels.lines import (
    APART,
    BLOCKED,
    CORNER,
    ENDS,
    KEY_BITS,
    ONE_OBSTACLE,
    OUTSIDE,
    cuts_corner,
    entry,
    line_key,
    path_sum,
)
from gapath.kernels.units import OBSTACLE

NEAR = st.tuples(st.integers(-2, 8), st.integers(-2, 8))
FAR = st.tuples(st.integers(-20, 30), st.integers(-20, 30))


def test_outside_the_map_lie_obstacles():
    table = np.array([[1, 2, 3], [4, 5, OBSTACLE]], dtype=np.int32)
    for y, x in np.ndindex(4, 5):
        inside = 1 <= x <= 3 and 1 <= y <= 2
        assert entry(table, x - 1, y - 1) == (table[y - 1, x - 1] if inside else OBSTACLE)


@given(weights(8), NEAR, NEAR | FAR, st.booleans(), st.sampled_from(range(len(RULES))))
def test_a_lines_key_is_the_twins(values, a, b, back, rule):
    a, b = (b, a) if back else (a, b)
    obstacles, cost = naive.fitness(values, naive.polyline([a, b]), RULES[rule])
    if naive.is_obstacle(values, *a):
        obstacles -= 1
    else:
        cost -= naive.fitness(values, [a])[1]
    key = line_key(GridMap("random", values).table, *a, *b, rule)
    assert (key >> KEY_BITS, key & (ONE_OBSTACLE - 1)) == (obstacles, cost)


@given(weights(5, least=1), st.data())
def test_corners_that_are_cut_are_the_twins(values, data):
    rows, cols = values.shape
    table = GridMap("random", values).table
    place = st.tuples(st.integers(0, cols - 1), st.integers(0, rows - 1))
    x, y = data.draw(place)
    for u in range(max(x - 1, 0), min(x + 2, cols)):
        for v in range(max(y - 1, 0), min(y + 2, rows)):
            for rule, name in enumerate(RULES):
                cut = cuts_corner(table, x, y, u, v, rule)
                assert cut == naive.forbidden(values, (x, y), (u, v), name)


PICTURE = ["..@", "...", "@.."]
HALF_WEIGHT = 32768


@pytest.mark.parametrize(
    ("path", "rule", "expected"),
    [
        ([(0, 0), (1, 1), (2, 2)], "allow", (3 * HALF_WEIGHT, 3)),
        ([(0, 0), (1, 0), (1, 1), (1, 2), (2, 2)], "no_diagonals", (5 * HALF_WEIGHT, 5)),
        ([(1, 0), (1, 1), (2, 2)], "allow", (ENDS, 0)),
        ([(0, 1), (1, 1), (2, 2)], "allow", (ENDS, 0)),
        ([(0, 0), (1, 1), (1, 2)], "allow", (ENDS, 0)),
        ([(0, 0), (1, 1), (2, 1)], "allow", (ENDS, 0)),
        ([(0, 0), (1, 1), (2, 1), (3, 1), (2, 2)], "allow", (OUTSIDE, 3)),
        ([(0, 0), (1, 1), (1, 2), (1, 3), (2, 2)], "allow", (OUTSIDE, 3)),
        ([(0, 0), (-1, 0), (0, 0), (1, 1), (2, 2)], "allow", (OUTSIDE, 1)),
        ([(0, 0), (0, -1), (0, 0), (1, 1), (2, 2)], "allow", (OUTSIDE, 1)),
        ([(0, 0), (1, 0), (2, 0), (2, 1), (2, 2)], "allow", (BLOCKED, 2)),
        ([(0, 0), (2, 2)], "allow", (APART, 1)),
        ([(0, 0), (0, 0), (1, 1), (2, 2)], "allow", (APART, 1)),
        ([(0, 0), (0, 1), (2, 1), (2, 2)], "allow", (APART, 2)),
        ([(0, 0), (1, 0), (1, 2), (2, 2)], "allow", (APART, 2)),
        ([(0, 0), (1, 0), (2, 1), (2, 2)], "one_side", (4 * HALF_WEIGHT, 4)),
        ([(0, 0), (1, 0), (2, 1), (2, 2)], "forbid", (CORNER, 2)),
        ([(0, 0), (1, 1), (2, 2)], "no_diagonals", (CORNER, 1)),
    ],
)
def test_what_is_wrong_with_a_path_by_hand(path, rule, expected):
    weights = np.array([[1.0 if c == "@" else 0.5 for c in row] for row in PICTURE])
    table, fields = GridMap("hand", weights).table, np.array(path, dtype=np.int32)
    assert path_sum(table, fields, (0, 0), (2, 2), RULES.index(rule)) == expected


@given(problems(most=8, least=1), st.lists(st.sampled_from(range(9)), max_size=12))
def test_a_paths_sum_is_the_twins(problem, moves):
    values, (x, y) = problem.map.weights, problem.start
    path = [(x, y)]
    for move in moves:
        x, y = x + move % 3 - 1, y + move // 3 - 1
        path.append((x, y))
    rule = problem.corner_cutting
    table, array = problem.map.table, np.array(path, dtype=np.int32)
    found, where = path_sum(table, array, problem.start, path[-1], int(rule))
    for i in range(1, len(path) + 1):
        obstacles, cost = naive.fitness(values, path[:i], rule.name.lower())
        if obstacles or path[i - 2 : i - 1] == path[i - 1 : i]:
            assert found < 0 and where == i - 1
            return
    assert (found, where) == (cost, len(path))
