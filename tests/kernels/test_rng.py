"""Random streams against NumPy's own SFC64."""

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.errors import InputError
from gapath.kernels import rng

keys = st.integers(0, 2**64 - 1)
word = st.integers(0, 2**64 - 1)


@given(keys, keys, keys)
def test_words_equal_numpy(seed, trial, call):
    words = np.empty(50, dtype=np.uint64)
    stream = rng.stream(seed, trial, call)
    rng.fill(stream, words[:20])
    rng.fill(stream, words[20:])
    oracle = naive.Words(seed, trial, call)
    assert words.tolist() == [oracle.take() for _ in range(50)]


def test_the_first_call_of_the_first_trial_is_meant_if_none_is_named():
    assert rng.stream(7).tolist() == rng.stream(7, 0).tolist() == rng.stream(7, 0, 0).tolist()


@given(word, st.integers(1, 2**31 - 1))
def test_bounded_integers_by_their_definition(value, n):
    assert rng.high(np.uint64(value), n) == naive.high(value, n)
    assert rng.low(np.uint64(value), n) == naive.low(value, n)
    assert 0 <= rng.high(np.uint64(value), n) < n


@given(word, st.floats(0, 1))
def test_events_by_their_definition(value, probability):
    threshold = rng.probability_threshold(probability)
    assert rng.happens(np.uint64(value), threshold) == naive.happens(value, probability)


def test_certain_and_impossible_events():
    for value in (0, 2**64 - 1):
        assert rng.happens(np.uint64(value), rng.probability_threshold(1.0))
        assert not rng.happens(np.uint64(value), rng.probability_threshold(0.0))


def test_streams_differ_in_every_key():
    words = np.empty((4, 4), dtype=np.uint64)
    for row, key in zip(words, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], strict=True):
        rng.fill(rng.stream(*key), row)
    assert len(set(words.ravel().tolist())) == 16


@pytest.mark.parametrize("key", [(-1, 0, 0), (0, 2**64, 0), (0, 0, -3)])
def test_keys_out_of_range_are_refused(key):
    with pytest.raises(InputError, match=r"integer in \[0, 2\*\*64\)"):
        rng.stream(*key)
