"""The DDA lines against exact fractions, and by hand."""

import naive
import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from gapath.kernels.raster import COORDINATE_LIMIT, polyline

near = st.integers(-60, 60)
far = st.integers(-COORDINATE_LIMIT, COORDINATE_LIMIT)


def fields(points):
    return list(map(tuple, polyline(np.array(points, dtype=np.int32)).tolist()))


def test_a_line_by_hand():
    """dx = 4, dy = 2: y = floor(i / 2 + 1/2)."""
    assert fields([(0, 0), (4, 2)]) == [(0, 0), (1, 1), (2, 1), (3, 2), (4, 2)]


def test_mirror_images_round_ties_to_other_fields_by_hand():
    """dy = 1: floor(1/2 + 1/2) = 1; dy = -1: floor(-1/2 + 1/2) = 0."""
    assert fields([(0, 0), (2, 1)])[1] == (1, 1)
    assert fields([(0, 0), (2, -1)])[1] == (1, 0)


@given(st.tuples(near, near), st.tuples(near, near))
def test_the_way_back_crosses_the_same_fields(a, b):
    assert fields([a, b]) == fields([b, a])[::-1]


@given(st.lists(st.tuples(near, near), min_size=1, max_size=6))
@example([(3, 3), (3, 3), (3, 3)])
def test_polylines_equal_the_naive_twin(points):
    assert fields(points) == naive.polyline(points)


@given(st.tuples(far, far), st.tuples(far, far), st.lists(st.integers(0, 2**18), max_size=40))
def test_long_lines_are_exact_field_by_field(a, b, steps):
    n = max(abs(b[0] - a[0]), abs(b[1] - a[1]))
    line = polyline(np.array([a, b], dtype=np.int32))
    assert len(line) == n + 1
    for i in {s % (n + 1) for s in steps} if n else {0}:
        exact = [
            (2 * a[c] * n + 2 * i * (b[c] - a[c]) + n) // (2 * n) if n else a[c] for c in (0, 1)
        ]
        assert line[i].tolist() == exact


@given(st.lists(st.tuples(near, near), min_size=1, max_size=6))
def test_successive_fields_are_neighbours(points):
    steps = np.abs(np.diff(np.array(fields(points)), axis=0))
    assert (steps.max(axis=1, initial=0) == 1).all() if len(steps) else True
