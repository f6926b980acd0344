"""Many groups at once, against one group after another."""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.pipelines.numbers.drive_summary import OUTCOMES, summarise_drives
from gapath.pipelines.numbers.grouped import Groups, grouped
from gapath.pipelines.numbers.statistics import expected_running_time, median_interval, wilson
from gapath.pipelines.numbers.summary import over_instances, summarise_by

NAMES = ["kg18_test2", "zzz", "kg18_test1", "arena"]
values = st.floats(-1e3, 1e3) | st.integers(0, 3).map(float) | st.just(math.nan)
rows = st.lists(st.tuples(st.sampled_from(NAMES), st.integers(0, 2), values), max_size=60)


def frame_of(rows, as_categories):
    frame = pd.DataFrame(rows, columns=["map", "map_instance", "x"]).astype({"map": "str"})
    frame = frame.astype({"map_instance": "int64", "x": "float64"})
    return frame.astype({"map": "category"}) if as_categories else frame


@given(rows, st.booleans())
def test_groups_are_those_of_one_after_another(rows, as_categories):
    frame = frame_of(rows, as_categories)
    names, groups = grouped(frame, ["map", "map_instance"])
    pairs = sorted({row[:2] for row in rows})
    assert list(names.itertuples(index=False, name=None)) == pairs
    assert not isinstance(names["map"].dtype, pd.CategoricalDtype)
    spread, quartiles = groups.spreads(frame["x"]), groups.quartiles(frame["x"])
    for at, pair in enumerate(pairs):
        mine = np.array([row[2] for row in rows if row[:2] == pair])
        known = mine[~np.isnan(mine)]
        assert groups.sizes[at] == len(mine)
        assert groups.counts(frame["x"] > 1)[at] == (known > 1).sum()
        assert groups.distinct(frame["x"])[at] == len(set(known))
        assert groups.sums(frame["x"].fillna(0))[at] == np.nan_to_num(mine).sum()
        ends = np.quantile(known, (0.25, 0.5, 0.75)) if len(known) else [math.nan] * 3
        np.testing.assert_array_equal([column[at] for column in quartiles], ends)
        low, high = median_interval(known)
        found = [column[at] for column in spread]
        np.testing.assert_array_equal(found, [ends[1], low, high, ends[0], ends[2]])


def test_what_is_in_no_group_counts_nowhere():
    groups = Groups(np.array([1, -1, 1, 0]), 3)
    assert groups.sizes.tolist() == [1, 2, 0]
    assert groups.sums([1, 10, 100, 1000]).tolist() == [1000, 101, 0]
    assert groups.distinct(pd.Series([1, 2, 1, 1])).tolist() == [1, 1, 0]
    assert groups.quartiles([5, 6, 7, 8]).median[:2].tolist() == [8, 6]
    assert math.isnan(groups.spreads([5, 6, 7, 8]).low[2])


trials = st.lists(
    st.tuples(
        st.sampled_from(NAMES), st.integers(0, 2), st.booleans(), st.integers(0, 4),
        st.floats(0.001, 10),
    ),
    min_size=1, max_size=40,
)  # fmt: skip


@given(trials)
def test_summaries_are_those_of_one_setting_after_another(rows):
    frame = pd.DataFrame(rows, columns=["map", "map_instance", "feasible", "epochs", "plan_time_s"])
    frame["evaluations"] = 40 * frame["epochs"]
    frame["optimality_ratio"] = (1 + frame["plan_time_s"]).where(frame["feasible"])
    frame["length_ratio"] = math.nan
    together = summarise_by(frame.astype({"map": "category"}), ["map"]).set_index("map")
    assert sorted(together.index) == sorted(set(frame["map"]))
    for name, group in frame.groupby("map"):
        row, drawn = together.loc[name], group["epochs"].any()
        rate = group["feasible"].mean()
        assert (row["n"], row["found"], row["success"]) == (
            len(group), group["feasible"].sum(), rate,
        )  # fmt: skip
        ends = wilson(rate, len(group)) if drawn else (math.nan, math.nan)
        np.testing.assert_array_equal([row["success_low"], row["success_high"]], ends)
        epochs = np.quantile(group["epochs"], 0.75) if drawn else math.nan
        np.testing.assert_array_equal(row["epochs_q3"], epochs)
        spent = group["evaluations"] if drawn else group["evaluations"] * math.nan
        ert = expected_running_time(spent.to_numpy(), group["feasible"])
        np.testing.assert_array_equal(row["ert_evaluations"], ert)
        ert = expected_running_time(group["plan_time_s"], group["feasible"])
        assert row["ert_seconds"] == pytest.approx(ert)
        low, _ = median_interval(group["plan_time_s"])
        assert row["seconds_low"] == low
        rates = group.groupby("map_instance")["feasible"].mean()
        over = over_instances(group, Groups.one(len(group)), "feasible", "rate")
        assert over["rate"][0] == pytest.approx(rates.mean())
        assert [over[key][0] for key in ("instances", "always", "never")] == [
            len(rates), (rates == 1).sum(), (rates == 0).sum(),
        ]  # fmt: skip


@given(trials)
def test_summaries_of_drives_are_those_of_one_setting_after_another(rows):
    frame = pd.DataFrame(rows, columns=["map", "map_instance", "stays", "steps", "compute_time_s"])
    frame["outcome"] = [OUTCOMES[steps % 3] for steps in frame["steps"]]
    frame["stands"] = frame["steps"].where(frame["stays"], -1)
    frame["evaluations"] = (frame["compute_time_s"] > 5).astype(int)
    frame = frame.assign(steps_ratio=math.nan, replans=1, calls_a=frame["steps"], calls_b=2,
                         calls_c=0)  # fmt: skip
    together = summarise_by(frame, ["map_instance"], summarise_drives).set_index("map_instance")
    for name, group in frame.groupby("map_instance"):
        row = together.loc[name]
        steps = group.groupby("map")["steps"].nunique()
        repeats = not group["evaluations"].any() and (steps == 1).all()
        for outcome in OUTCOMES:
            count = (group["outcome"] == outcome).sum()
            assert (row[outcome], row[f"{outcome}_rate"]) == (count, count / len(group))
            ends = (math.nan, math.nan) if repeats else wilson(count / len(group), len(group))
            found = [row[f"{outcome}_low"], row[f"{outcome}_high"]]
            np.testing.assert_array_equal(found, ends)
        stayed = (group["outcome"] == "returned") & (group["stands"] == group["steps"])
        assert (row["never_left"], row["calls_b"]) == (stayed.sum(), 2)
        assert row["calls_a"] == pytest.approx(group["steps"].mean())
        assert row["steps_median"] == np.median(group["steps"])


def test_nothing_comes_to_nothing():
    frame = frame_of([], True).assign(feasible=True, epochs=1, evaluations=1, plan_time_s=0.1,
                                      optimality_ratio=1.0, length_ratio=1.0)  # fmt: skip
    made = summarise_by(frame[:0], ["map"])
    assert len(made) == 0 and {"map", "n", "epochs_median", "ert_seconds"} <= set(made)
