"""The free field nearest to one that is blocked."""

import naive_visibility as twin
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from visibility_strategies import pictures

from gapath.grid import GridMap
from gapath.scenario.nearest import nearest_free, nearest_told


@given(pictures(most=12), st.integers(0, 2**32 - 1))
def test_the_nearest_free_field_equals_the_twin(picture, seed):
    place = np.random.default_rng(seed).integers(0, picture.shape[::-1]).tolist()
    found = nearest_free(picture, tuple(place))
    assert found == twin.nearest_free(picture, place)
    if not picture[place[1], place[0]]:
        assert found == tuple(place)


def test_the_nearest_free_field_by_hand():
    picture = np.ones((5, 5), dtype=np.bool_)
    assert nearest_free(picture, (2, 2)) is None
    picture[4, 2] = picture[2, 4] = picture[2, 0] = picture[0, 0] = False
    assert nearest_free(picture, (2, 2)) == (0, 2)  # of three the first row, then column
    assert nearest_free(picture, (2, 3)) == (2, 4)


@pytest.mark.parametrize(("place", "told"), [
    ({}, "[3, 0]"),
    ({"resolution": 0.5}, "[3, 0], in metres [1.75m,0.75m]"),
    ({"resolution": 0.5, "source": "barn"}, "[3, 0], in metres [1.75m,0.75m]"),
    ({"origin": (-10.0, 2.0, 0.0), "source": "rosmap"}, "[3, 0], in metres [-6.5m,3.5m]"),
])  # fmt: skip
def test_a_map_with_a_scale_or_an_origin_tells_metres_too(place, told):
    """By hand: the centre of column 3, and of the upper of two rows."""
    grid = GridMap("hall", np.full((2, 4), 0.5), **place)
    obstacles = np.array([[1, 1, 1, 0], [1, 1, 1, 1]], dtype=np.bool_)
    assert nearest_told(grid, obstacles, (0, 0)) == told
    assert nearest_told(grid, np.ones((2, 4), dtype=np.bool_), (0, 0)) is None
