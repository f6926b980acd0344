"""The past path: Sec. 4.6's simplification, and moves along paths and back."""

import itertools

import naive_drive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.driving.past_path import Track, simplified
from gapath.events import Mode

walks = st.lists(st.sampled_from(naive_drive.HEADINGS), max_size=40).map(
    lambda steps: tuple(
        itertools.accumulate(steps, lambda a, b: (a[0] + b[0], a[1] + b[1]), initial=(0, 0))
    )
)


@given(walks)
def test_simplified_does_as_described(past):
    assert simplified(past) == naive_drive.simplified(past)


@given(walks)
def test_simplified_keeps_what_matters(past):
    kept = simplified(past)
    assert len(set(kept)) == len(kept)
    assert (kept[0], kept[-1]) == (past[0], past[-1])
    assert set(itertools.pairwise(kept)) <= set(itertools.pairwise(past))
    assert simplified(kept) == kept
    if len(set(past)) == len(past):
        assert kept == past


@pytest.mark.parametrize(
    ("past", "kept"),
    [
        ("a", "a"),
        ("abc", "abc"),
        ("abcb", "ab"),
        ("abcbd", "abd"),
        ("abcdbce", "abce"),
        ("abacad", "ad"),  # the last a, not the next one
        ("abcdcba", "a"),
    ],
)
def test_simplified_by_example(past, kept):
    assert simplified(tuple(past)) == tuple(kept)


def test_going_on_and_back():
    path = np.array([[0, 0], [1, 1], [2, 1]], dtype=np.int32)
    there = Track(((0, 0),)).adopt(path).go_on()
    assert (there.place, there.mode) == ((1, 1), Mode.EXPLORE)
    assert there.stood.at == 0 and there.moved.at == 1
    there = there.moved.go_on()
    assert there.place == (2, 1) and there.path.tolist() == [[1, 1], [2, 1]]
    back = there.moved.go_back()
    assert (back.place, back.mode) == ((1, 1), Mode.RETURN)
    assert back.past == ((0, 0), (1, 1), (2, 1)) == back.stood.past
    back = back.moved.go_back()
    assert back.place == (0, 0)
    assert back.moved.go_back().place == (0, 0)  # at the start it stands
    assert not back.moved.adopt(path).returning
