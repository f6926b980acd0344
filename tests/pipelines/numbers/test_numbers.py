import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binom, binomtest

from gapath.pipelines.numbers.statistics import (
    expected_running_time,
    median_interval,
    median_intervals,
    share_within,
    wilson,
)


@given(st.integers(1, 2000).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_wilson_agrees_with_scipy(case):
    found, n = case
    expected = binomtest(found, n).proportion_ci(method="wilson")
    assert wilson(found / n, n) == pytest.approx((expected.low, expected.high), abs=1e-12)


def test_wilson_of_the_papers_three_executions():
    low, high = wilson(2 / 3, 3)
    assert (round(low, 2), round(high, 2)) == (0.21, 0.94)


def test_wilson_is_exact_at_its_ends_and_knows_nothing_of_nothing():
    assert wilson(0.0, 7)[0] == 0.0
    assert wilson(1.0, 7)[1] == 1.0
    assert wilson(0.5, 0) == (0.0, 1.0)


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=200))
def test_median_interval_lies_within_the_sample_whatever_its_order(values):
    low, high = median_interval(values)
    assert min(values) <= low <= high <= max(values)
    assert median_interval(values[::-1]) == (low, high)


def test_median_interval_of_edge_cases():
    assert median_interval([3.0, 3.0]) == (3.0, 3.0)
    assert median_interval([1.0]) == (1.0, 1.0)
    assert all(math.isnan(end) for end in median_interval([]))


@settings(max_examples=30)
@given(st.lists(st.integers(0, 30), min_size=1, max_size=6))
def test_median_interval_is_that_of_all_resamples(values):
    """Slow twin: every resample there is, each with the same chance."""
    resamples = np.array(list(itertools.product(values, repeat=len(values))))
    medians = np.sort(np.median(resamples, axis=1))
    ends = [medians[math.ceil(level * len(medians)) - 1] for level in (0.025, 0.975)]
    assert median_interval(values) == pytest.approx(ends)


@pytest.mark.parametrize("n", [25, 26, 101, 102, 500, 1001])
def test_median_interval_is_the_limit_of_resampling(n):
    """Slow twin: many resamples; so many of their medians lie below and above the ends."""
    random = np.random.default_rng(n)
    sample = random.exponential(size=n)
    medians = np.array([np.median(random.choice(sample, n)) for _ in range(20_000)])
    for end, level in zip(median_interval(sample), (0.025, 0.975), strict=True):
        assert np.mean(medians < end) < level + 0.004
        assert np.mean(medians <= end) > level - 0.004


def test_median_interval_of_textbook_sizes():
    """The m-th of n = 2 m - 1 draws is among the first i if a coin of i / n says so m times."""
    for n in (5, 9, 51, 999):
        m = n // 2 + 1
        low, high = median_interval(range(1, n + 1))
        for end, level in ((low, 0.025), (high, 0.975)):
            assert binom.sf(m - 1, n, (end - 1) / n) < level <= binom.sf(m - 1, n, end / n)


@given(st.integers(1, 60), st.integers(1, 8), st.integers(0, 9))
def test_samples_of_one_size_are_done_at_once(n, count, seed):
    samples = np.sort(np.random.default_rng(seed).integers(0, 20, (count, n)).astype(float))
    together = np.stack(median_intervals(samples), axis=1).tolist()
    assert together == [list(median_interval(sample)) for sample in samples]


def test_median_interval_covers_the_median_about_19_times_in_20():
    random = np.random.default_rng(1)
    intervals = [median_interval(random.exponential(size=60)) for _ in range(200)]
    covered = sum(low <= math.log(2) <= high for low, high in intervals)
    assert 180 <= covered <= 199


def test_expected_running_time_counts_failures():
    assert expected_running_time([10, 20, 500, 500], [True, True, False, False]) == 515.0
    assert expected_running_time([500, 500], [False, False]) == math.inf
    assert expected_running_time([4, 6], [True, True]) == 5.0


@given(st.lists(st.tuples(st.integers(1, 30), st.booleans()), min_size=1, max_size=30))
def test_share_within_counts_as_the_definition_does(rows):
    spent, shares = share_within(*zip(*rows, strict=True))
    assert list(spent) == sorted({level for level, succeeded in rows if succeeded})
    for at, share in zip(spent, shares, strict=True):
        assert share == pytest.approx(np.mean([good and level <= at for level, good in rows]))
