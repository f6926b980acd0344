"""What trials come to, against exact fractions."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.store.results import Results

numbers = st.floats(-1e100, 1e100) | st.just(math.nan)


@given(st.lists(st.tuples(st.booleans(), numbers, st.integers(0, 2**50)), max_size=30))
def test_sums_are_those_of_fractions_rounded_once(trials):
    success, cost, epochs = (np.array([row[i] for row in trials]) for i in range(3))
    found = Results.of(success, {"cost": cost, "epochs": epochs}.items())
    known = [value for _, value, _ in trials if not math.isnan(value)]
    assert (found.trials, found.succeeded) == (len(trials), sum(row[0] for row in trials))
    assert found.sums["cost"] == float(sum(map(Fraction, known)))
    assert found.sums["epochs"] == float(sum(row[2] for row in trials))
    assert found.counts == ({"cost": len(known)} if len(known) < len(trials) else {})


@pytest.mark.parametrize(
    ("values", "total"),
    [
        ([1.0, math.inf], math.inf),
        ([math.inf, -math.inf], math.nan),
        ([1e308, 1e308], math.inf),
        ([], 0.0),
        ([math.nan], 0.0),
    ],
)
def test_what_has_no_finite_sum_ends_no_run(values, total):
    found = Results.of(np.ones(len(values)), [("cost", values)]).sums["cost"]
    assert found == total or (math.isnan(found) and math.isnan(total))
