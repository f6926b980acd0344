"""What groups of runs come to is what all of their trials together come to."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gapath.pipelines.asking.groups import grouped
from gapath.pipelines.numbers.statistics import expected_running_time, wilson
from gapath.store.results import Results

from .conftest import MAPS, rows_of


def test_groups_by_hand(ask):
    rows = rows_of(ask, "--group", "planner.population,map", "--where", "map <> 'kg18_test3'")
    assert [(row["planner.population"], row["map"]) for row in rows] == [
        *((size, name) for size in (20, 40, 100) for name in ("kg18_test1", "kg18_test4")),
        (None, "kg18_test1"),
    ]
    assert [row["runs"] for row in rows] == [1] * 7
    never = rows[1]
    assert (never["success"], never["success_low"]) == (0, 0) and 0 < never["success_high"] < 0.3
    assert never["expected_evaluations"] is None and never["length"] == 25
    exact = rows[-1]  # draws no random numbers
    assert (exact["success"], exact["success_low"], exact["expected_evaluations"]) == (
        1,
        None,
        None,
    )
    text = ask("--group", "map")[1].splitlines()
    assert text[0].split()[:4] == ["map", "runs", "trials", "success"]
    assert "∞" in text[-1] and "kg18_test4" in text[-1]


def test_groups_are_ordered_by_what_they_came_to(ask):
    rows = rows_of(ask, "--group", "map", "--sort", "-success", "--columns", "success,map")
    assert [row["map"] for row in rows] == list(MAPS)
    assert list(rows[0]) == ["success", "map"]
    rows = rows_of(ask, "--group", "map", "--columns", "success")
    assert list(rows[0]) == ["map", "success"]


trials = st.lists(
    st.tuples(
        st.booleans(),
        st.integers(0, 3000),
        st.floats(1e-6, 10),
        st.floats(1, 1e3) | st.just(np.nan),
    ),
    min_size=1,
    max_size=6,
)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(["a", "b", None]), st.booleans(), trials), min_size=1))
def test_groups_are_those_of_all_trials_together(runs):
    names = ("feasible", "evaluations", "plan_time_s", "length")
    tables = [pd.DataFrame(rows, columns=names) for _, _, rows in runs]
    came = [Results.of(table["feasible"], table[[*names[1:]]].items()) for table in tables]
    by = ["map", "planner.stop"]
    keys = pd.DataFrame([row[:2] for row in runs], columns=by).astype({"map": "str"})
    found = grouped(keys, came, by)
    together = pd.concat(
        [table.assign(**key, run=i) for i, (table, key) in
         enumerate(zip(tables, keys.to_dict("records"), strict=True))]
    )  # fmt: skip
    groups = list(together.groupby(by, dropna=False))
    assert len(groups) == len(found)
    for (_, group), (_, row) in zip(groups, found.iterrows(), strict=True):
        n, rate = len(group), group["feasible"].mean()
        assert (row["runs"], row["trials"], row["success"]) == (group["run"].nunique(), n, rate)
        for name in names[1:]:
            assert row[name] == pytest.approx(group[name].mean(), rel=1e-12, nan_ok=True)
        seconds = expected_running_time(group["plan_time_s"], group["feasible"])
        assert row["expected_seconds"] == pytest.approx(seconds, rel=1e-12)
        if group["evaluations"].any():
            evaluations = expected_running_time(group["evaluations"], group["feasible"])
            assert row["expected_evaluations"] == pytest.approx(evaluations, rel=1e-12)
            assert (row["success_low"], row["success_high"]) == wilson(rate, n)
        else:
            assert row[["expected_evaluations", "success_low", "success_high"]].isna().all()
