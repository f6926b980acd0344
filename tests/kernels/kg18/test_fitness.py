"""KG18 eq. (5) against the naive twin, and by hand."""

import naive
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from strategies import RULES, weights

from gapath.grid import GridMap
from gapath.kernels.kg18.bspline import basis
from gapath.kernels.kg18.fitness import fitness
from gapath.kernels.lines import KEY_BITS, ONE_OBSTACLE, line_key


def split(key):
    return key >> KEY_BITS, key & (ONE_OBSTACLE - 1)


def test_a_path_by_hand():
    """Start and target 0, three fields of 0.5 between, one obstacle, one field outside."""
    values = np.full((1, 6), 0.5)
    values[0, 0] = values[0, 5] = 0.0
    values[0, 2] = 1.0
    table = GridMap("hand", values).table
    assert split(line_key(table, 0, 0, 5, 0, 0)) == (1, 3 * 32768)
    assert split(line_key(table, 0, 0, 6, 0, 0)) == (2, 3 * 32768)
    assert split(line_key(table, 0, 0, -3, 0, 0)) == (3, 0)


@given(
    weights(),
    st.lists(st.tuples(st.integers(-60, 80), st.integers(-60, 80)), min_size=3, max_size=6),
    st.sampled_from(RULES),
    st.booleans(),
)
def test_fitness_equals_the_naive_twin(values, points, rule, per_span):
    chromosome = np.array([c for point in points for c in point], dtype=np.int32)
    key = fitness(
        GridMap("random", values).table,
        chromosome,
        basis(len(points), 5, per_span),
        RULES.index(rule),
    )
    path = naive.polyline(naive.way_points(chromosome, 5, per_span))
    assert split(key) == naive.fitness(values, path, rule)


@given(
    weights(),
    st.tuples(st.integers(-(2**17), 2**17), st.integers(-300, 300)),
    st.tuples(st.integers(-300, 300), st.integers(-(2**17), 2**17)),
)
def test_lines_far_outside_the_map_are_counted_without_walking_them(values, a, b):
    from gapath.kernels.raster import polyline

    fields = polyline(np.array([a, b], dtype=np.int32))[1:]
    rows, cols = values.shape
    inside = ((fields >= 0) & (fields < (cols, rows))).all(axis=1)
    table = GridMap("random", values).table
    entries = table[fields[inside, 1], fields[inside, 0]].astype(np.int64)
    blocked = entries >= 1 << 24
    expected = (~inside).sum() + blocked.sum(), entries[~blocked].sum()
    assert split(line_key(table, *a, *b, 0)) == expected
