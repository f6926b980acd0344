"""Importance of settings that is planted, and of settings that do nothing."""

import math
from itertools import product

import numpy as np
import pandas as pd
import pytest

from gapath.pipelines.sweeps.importance import FEWEST, importance
from gapath.pipelines.sweeps.varied import factor_of

LEVELS = {"a": [1, 2, 4, 8], "b": ["x", "y", "z"], "c": [0.1, 0.2, 0.4, 0.8]}


@pytest.fixture
def cells():
    return pd.DataFrame(list(product(*LEVELS.values())), columns=list(LEVELS))


def factors_of(cells):
    return tuple(factor_of(name, cells[name].astype(object)) for name in LEVELS)


def noise(cells, seed=0):
    return np.random.default_rng(seed).normal(0, 1, len(cells))


@pytest.mark.parametrize("name", LEVELS)
def test_the_only_setting_that_matters_is_found(cells, name):
    codes = pd.factorize(cells[name])[0]
    found = importance(cells, factors_of(cells), 10.0 * codes + noise(cells))
    first, *others = found.weights
    assert first.name == name and first.told and found.why == ""
    assert first.share > 0.7 and found.explained > 0.8
    assert all(abs(each.share) < 0.05 for each in others)


def test_shares_are_those_of_the_variance(cells):
    """Of a sum of two independent parts each has its own variance: 4 to 1 here."""
    a, c = (pd.factorize(cells[name])[0] for name in "ac")
    found = importance(cells, factors_of(cells), 10.0 * a + 5.0 * c + 0.1 * noise(cells))
    shares = {weight.name: weight.share for weight in found.weights}
    assert shares["a"] == pytest.approx(0.8, abs=0.15)
    assert shares["c"] == pytest.approx(0.2, abs=0.1)
    assert abs(shares["b"]) < 0.02


@pytest.mark.parametrize("seed", range(3))
def test_noise_cannot_be_told(cells, seed):
    found = importance(cells, factors_of(cells), noise(cells, seed))
    assert found.weights == () and "explains nothing" in found.why
    assert found.explained < 0.05


def test_a_null_setting_is_seldom_told_from_none():
    told = 0
    for seed in range(6):
        cells = pd.DataFrame(list(product(*LEVELS.values())), columns=list(LEVELS))
        result = 10.0 * pd.factorize(cells["a"])[0] + noise(cells, seed)
        weights = importance(cells, factors_of(cells), result).weights
        told += sum(weight.told for weight in weights if weight.name != "a")
    assert told <= 3  # of 12


@pytest.mark.parametrize(
    ("result", "why"),
    [
        (np.ones(48), "came to the same"),
        (np.r_[np.arange(FEWEST - 1.0), np.full(48 - FEWEST + 1, np.inf)], "nothing is learnt"),
        (np.full(48, np.nan), "nothing is learnt"),
    ],
)
def test_what_cannot_be_told_says_why(cells, result, why):
    found = importance(cells, factors_of(cells), result)
    assert found.weights == () and why in found.why
    assert math.isnan(found.explained)


def test_the_same_cells_give_the_same(cells):
    result = 1.0 * pd.factorize(cells["a"])[0] + noise(cells)
    assert importance(cells, factors_of(cells), result) == importance(
        cells, factors_of(cells), result
    )
