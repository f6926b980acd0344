"""The free field nearest to one that is blocked."""

import naive_visibility as twin
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from visibility_strategies import pictures

from gapath.scenario.nearest import nearest_free


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
