"""A map's table, entry by entry."""

from fractions import Fraction
from math import floor

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gapath.kernels.table import fill_table
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
