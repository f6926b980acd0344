"""Pairs that are drawn: joined, different, and each by its number alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.units import ALLOW, FORBID
from gapath.scenario.drawn import draw_queries

WEIGHTS = arrays(np.float64, array_shapes(min_dims=2, max_dims=2, max_side=9),
                 elements=st.sampled_from([0.0, 0.5, 1.0]))  # fmt: skip


@given(WEIGHTS, st.sampled_from([ALLOW, FORBID]), st.integers(1, 20))
def test_a_path_joins_what_is_drawn(weights, rule, count):
    grid = GridMap("drawn", weights)
    parts = grid.parts(rule)
    sizes = np.bincount(parts.ravel(), minlength=2)[1:]
    if sizes.max(initial=0) < 2:
        with pytest.raises(InputError, match="no two fields that a path joins"):
            draw_queries(grid, count, rule)
        return
    drawn = draw_queries(grid, count, rule)
    assert len(drawn) == count and drawn.numbers.tolist() == list(range(count))
    for (x, y), (u, v) in zip(drawn.starts.tolist(), drawn.targets.tolist(), strict=True):
        assert (x, y) != (u, v) and parts[y, x] == parts[v, u] > 0
        assert not grid.obstacles[y, x] and not grid.obstacles[v, u]
    more = draw_queries(grid, count + 3, rule).chosen(slice(count))
    assert more.digest == drawn.digest


def test_all_pairs_of_a_part_are_drawn_alike():
    """Three fields in a row and a field alone: six pairs, none with the one alone."""
    grid = GridMap("drawn", np.array([[0.5, 0.5, 0.5, 1.0, 0.5]]))
    drawn = draw_queries(grid, 6000, FORBID)
    pairs, counts = np.unique([drawn.starts[:, 0], drawn.targets[:, 0]], axis=1, return_counts=True)
    assert pairs.T.tolist() == [[a, b] for a in range(3) for b in range(3) if a != b]
    assert counts.min() > 850 and counts.max() < 1150


def test_the_maps_own_pair_is_the_first():
    grid = GridMap("drawn", np.full((4, 5), 0.5), start=(1, 2), target=(4, 0))
    drawn = draw_queries(grid, 3, ALLOW)
    assert (drawn.starts[0].tolist(), drawn.targets[0].tolist()) == ([1, 2], [4, 0])
