"""Tests of two groups: textbook examples, and SciPy's and statsmodels' own answers."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from gapath.pipelines.numbers.comparing.pairwise import (
    holm,
    more_often,
    paired_amounts,
    paired_rates,
    signed_rank,
    unpaired_amounts,
    unpaired_rates,
)

DARWIN = [6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75]
"""Differences in height of 15 pairs of plants, eighths of an inch (Fisher 1935, from Darwin)."""

cells = st.integers(0, 40)
amounts = st.lists(st.integers(1, 9), min_size=2, max_size=30)


def test_mcnemar_by_hand():
    # of 6 pairs in which one only succeeded 5 are the first's: 2 (1 + 6) / 2^6
    assert paired_rates(10, 5, 1, 4).p == pytest.approx(14 / 64)
    assert paired_rates(10, 5, 1, 4).effect == pytest.approx(4 / 20)


def test_mcnemar_of_agrestis_approval_ratings():
    # Agresti, Categorical Data Analysis, Table 10.1: 944 of 1600 approve, then 880
    found = paired_rates(794, 150, 86, 570)
    assert found.effect == pytest.approx(0.04)
    assert found.p == pytest.approx(stats.binomtest(86, 236).pvalue)
    assert (round(found.low, 2), round(found.high, 2)) == (0.02, 0.06)


@pytest.mark.parametrize(
    ("table", "low", "high"),
    [
        ((36, 12, 2, 0), 0.0569, 0.3404),  # Newcombe 1998, method 10
        ((1, 1, 7, 12), -0.507, -0.026),  # Fagerland, Lydersen and Laake 2014
    ],
)
def test_newcombes_interval_as_published(table, low, high):
    found = paired_rates(*table)
    decimals = len(str(low).partition(".")[2])
    assert (round(found.low, decimals), round(found.high, decimals)) == (low, high)


@given(cells, cells, cells, cells)
def test_the_interval_of_pairs_holds_the_difference_and_turns_with_the_groups(a, b, c, d):
    if a + b + c + d < 2:
        return
    found, turned = paired_rates(a, b, c, d), paired_rates(a, c, b, d).swapped()
    assert -1 <= found.low <= found.effect <= found.high <= 1
    for name in ("p", "effect", "low", "high"):
        assert getattr(found, name) == pytest.approx(getattr(turned, name), abs=1e-12)


def test_newcombes_interval_covers_the_difference_about_19_times_in_20():
    random = np.random.default_rng(3)
    chances, covered = [0.5, 0.3, 0.1, 0.1], 0
    for table in random.multinomial(60, chances, size=400):
        found = paired_rates(*map(int, table))
        covered += found.low <= 0.2 <= found.high
    assert 370 <= covered <= 395


def test_trials_without_pairs_by_their_number():
    few, many = unpaired_rates((9, 4), (10, 10)), unpaired_rates((90, 60), (100, 100))
    assert few.test.startswith("Fisher")
    assert few.p == pytest.approx(stats.fisher_exact([[9, 1], [4, 6]])[1])
    assert many.test == "score test"
    # without a continuity correction, but for the factor (n - 1) / n of Miettinen and Nurminen
    chi = stats.chi2_contingency([[90, 10], [60, 40]], correction=False)[0]
    assert many.p == pytest.approx(stats.chi2.sf(chi * 199 / 200, 1), rel=0.05)
    assert many.effect == pytest.approx(0.3)
    # Newcombe 1998, Statistics in Medicine 17, 873-890, example (a): 56/70 - 48/80
    example = unpaired_rates((56, 48), (70, 80))
    assert (round(example.low, 4), round(example.high, 4)) == (0.0524, 0.3339)


def test_rates_of_all_and_none_warn_of_nothing():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for counts in ((30, 0), (0, 30), (30, 30), (0, 0), (30, 15), (15, 0)):
            found = unpaired_rates(counts, (30, 30))
            assert found.low <= found.effect <= found.high


def test_wilcoxon_of_darwins_plants():
    second = np.full(15, 100.0)
    found = paired_amounts(second + DARWIN, second)
    assert found.p == pytest.approx(0.041259765625)  # 2 * P(W <= 24), SciPy's example
    assert found.effect == pytest.approx(1.24)  # the median difference is 24


@settings(max_examples=10)
@given(st.integers(51, 80), st.integers(0, 100))
def test_signed_ranks_of_columns_are_those_of_each_column(n, seed):
    table = np.random.default_rng(seed).integers(-3, 9, size=(n, 3)).astype(float)
    alone = [stats.wilcoxon(column).pvalue for column in table.T]
    assert signed_rank(table) == pytest.approx(alone)
    short = table[:9]
    alone = [stats.wilcoxon(column).pvalue for column in short.T]
    assert signed_rank(short) == pytest.approx(alone)


def test_a12_by_hand():
    # of nine pairs 3 > 2 alone is more, (2, 2) and (3, 3) are equal
    assert more_often(np.array([1.0, 2, 3]), np.array([2.0, 3, 4])) == pytest.approx(2 / 9)
    assert more_often(np.array([5.0, 6]), np.array([1.0])) == 1


@given(amounts, amounts)
def test_a12_is_what_vargha_and_delaney_define_and_turns(first, second):
    first, second = np.array(first, float), np.array(second, float)
    defined = np.mean([(a > b) + (a == b) / 2 for a in first for b in second])
    assert more_often(first, second) == pytest.approx(defined)
    assert more_often(second, first) == pytest.approx(1 - defined)


@settings(max_examples=25)
@given(st.lists(st.tuples(st.integers(1, 99), st.integers(1, 99)), min_size=2, max_size=40))
def test_amounts_of_pairs_turn_with_the_groups_and_keep_without_order(pairs):
    first, second = np.array(pairs, float).T
    found, turned = paired_amounts(first, second), paired_amounts(second, first).swapped()
    mixed = paired_amounts(first[::-1], second[::-1])
    assert found.effect == pytest.approx(turned.effect)
    assert found.p == pytest.approx(turned.p)
    assert mixed == pytest.approx(found) or mixed.p == pytest.approx(found.p)
    assert found.low <= found.effect <= found.high
    assert (mixed.effect, mixed.low) == (found.effect, found.low)


@given(amounts, amounts)
def test_amounts_without_pairs_agree_with_scipy(first, second):
    first, second = np.array(first, float), np.array(second, float)
    found = unpaired_amounts(first, second)
    same = len({*first, *second}) == 1
    assert found.p == (1 if same else pytest.approx(stats.mannwhitneyu(first, second).pvalue))
    assert found.effect == np.median(first) / np.median(second)
    assert unpaired_amounts(first, second) == found


def test_holm_of_published_values():
    # the example of four tests that the literature repeats: 4 p, 3 p, 2 p, and no less than before
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([None, 0.6, None, 0.5]) == [None, 1.0, None, 1.0]
    assert holm([]) == []


@pytest.mark.parametrize(
    ("found", "why"),
    [
        (paired_rates(1, 0, 0, 0), "one pair"),
        (paired_rates(3, 0, 0, 2), "no pair in which only one succeeded"),
        (unpaired_rates((1, 3), (1, 5)), "one trial only"),
        (unpaired_rates((5, 6), (5, 6)), "alike"),
        (paired_amounts(np.array([3.0]), np.array([2.0])), "one pair"),
        (paired_amounts(np.array([]), np.array([])), "no pair"),
        (paired_amounts(np.ones(4), np.ones(4)), "same in all pairs"),
        (unpaired_amounts(np.ones(1), np.ones(4)), "one trial only"),
        (unpaired_amounts(np.ones(3), np.ones(4)), "same in all trials"),
    ],
)
def test_what_cannot_be_had_says_why(found, why):
    assert why in found.why
    assert not any(isinstance(x, float) and math.isnan(x) for x in found)


def test_amounts_of_nothing_have_a_test_but_no_ratio():
    found = paired_amounts(np.array([0.0, 2, 3]), np.array([1.0, 4, 5]))
    assert found.p is not None
    assert found.effect is None
