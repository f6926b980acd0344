"""The past path: Sec. 4.6's simplification, and moves along paths and back."""

import itertools
import tracemalloc

import naive_drive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.driving.navigation import Past
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
    there = Track(Past(((0, 0),))).adopt(path).go_on()
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


fields = st.tuples(st.integers(0, 2), st.integers(0, 2))


@given(st.lists(st.tuples(st.integers(0, 9), st.lists(fields, max_size=3) | st.integers(0, 5))))
def test_pasts_that_share_their_fields_are_as_tuples(changes):
    """Each change makes a new one of any of those before: longer, or without its last fields."""
    pasts, tuples = [Past(((0, 0),))], [((0, 0),)]
    for which, change in changes:
        past, known = pasts[which % len(pasts)], tuples[which % len(pasts)]
        if isinstance(change, int):
            pasts.append(past[:-change])  # of none of them, too
            tuples.append(known[:-change])
        else:
            pasts.append(past + tuple(change))
            tuples.append(known + tuple(change))
    for past, known in zip(pasts, tuples, strict=True):
        assert past == known and known == past and len(past) == len(known)
        assert tuple(past) == tuple(past[i] for i in range(len(past))) == known
        assert tuple(past[1::2]) == known[1::2] and (not known or past[-1] == known[-1])
    for (i, past), (j, other) in itertools.product(enumerate(pasts), repeat=2):
        assert (past == other) == (tuples[i] == tuples[j])


def test_a_way_back_takes_memory_as_its_steps():
    tracemalloc.start()
    pasts = [Past(((0, 0),))]
    for _ in range(3000):
        pasts.append(pasts[-1] + ((1, 1),))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 10**6  # as tuples they took 36 MB
