"""Numbers of cells, against the functions for one group, pandas, and simulated trials."""

import math

import numpy as np
import pytest

from gapath.pipelines.numbers.statistics import expected_running_time, wilson
from gapath.pipelines.sweeps.cells import expected, summarise_cells
from gapath.pipelines.sweeps.measures import Effort, measures_of
from gapath.pipelines.sweeps.varied import cases_of
from gapath.task import find_task

from .made import Tried, driven, planned

EFFORT = Effort("spent", "spent", 1.0, lambda trials: trials)


def cells_of(tried, task="plan", make=planned):
    trials, runs = make(tried)
    return summarise_cells(trials, cases_of(runs), measures_of(find_task(task))).table, trials


def test_numbers_are_those_of_pandas():
    tried = [
        Tried("ga1", map="kg18_test1", n=7, success=0.6, evaluations=40),
        Tried("ga1", map="kg18_test1", n=5, success=1, evaluations=90, seed=3),
        Tried("ga2", map="kg18_test1", n=9, success=0.3, evaluations=10, instance=1),
        Tried("ga2", map="kg18_test1", n=9, success=1, evaluations=10, instance=2),
        Tried("ga2", n=4, success=0.5),
        Tried("astar", n=4, success=1, evaluations=0),
    ]
    table, trials = cells_of(tried)
    assert len(table) == 4 and table["n"].sum() == len(trials)
    for row in table.to_dict("records"):
        mine = trials[(trials["map"] == row["place"]) & (trials["planner"] == row["method"])]
        found = mine["feasible"]
        assert set(row["runs"]) == set(mine["key"])
        assert (row["n"], row["succeeded"]) == (len(mine), found.sum())
        solved = mine.groupby("map_instance")["feasible"].agg(["any", "all"])
        assert (row["problems"], row["once"], row["always"]) == (len(solved), *solved.sum())
        seconds = mine["plan_time_s"]
        assert row["expected_seconds"] == pytest.approx(seconds.sum() / found.sum())
        for key, level in (("median", 0.5), ("q1", 0.25), ("q3", 0.75)):
            assert row[f"seconds_{key}"] == pytest.approx(seconds.quantile(level))
            ratio = mine["optimality_ratio"].quantile(level)
            assert row[f"optimality_ratio_{key}"] == pytest.approx(ratio)
        if row["method"] == "astar":  # has no chance, and no epochs
            names = ("success_low", "expected_evaluations", "evaluations_median", "epochs_median")
            assert all(math.isnan(row[name]) for name in names)
            continue
        assert (row["success_low"], row["success_high"]) == pytest.approx(
            wilson(found.mean(), len(mine))
        )
        evaluations = mine["evaluations"]
        assert row["expected_evaluations"] == pytest.approx(
            expected_running_time(evaluations, found)
        )
        assert row["found_epochs_median"] == pytest.approx(mine.loc[found, "epochs"].median())
        low, high = row["expected_evaluations_low"], row["expected_evaluations_high"]
        assert low <= row["expected_evaluations"] <= high


def test_all_failed():
    (row,) = cells_of([Tried(n=10, success=0, evaluations=100)])[0].to_dict("records")
    assert (row["success"], row["once"]) == (0, 0)
    assert row["expected_evaluations"] == row["expected_evaluations_high"] == math.inf
    # What ten trials spend at the greatest rate that none of ten successes allows.
    assert row["expected_evaluations_low"] == pytest.approx(104.5 / wilson(0, 10)[1])
    assert math.isnan(row["optimality_ratio_median"])


def test_one_trial_has_no_interval_of_what_is_expected():
    (row,) = cells_of([Tried(n=1, success=1, evaluations=70)])[0].to_dict("records")
    assert row["expected_evaluations"] == 70
    assert math.isnan(row["expected_evaluations_low"])


def test_a_planner_without_evaluations_whose_costs_differ_has_chance():
    trials, runs = planned([Tried("astar", n=4, evaluations=0)])
    trials["cost"] = [1.0, 2.0, 1.0, 1.0]
    measures = measures_of(find_task("plan"))
    (row,) = summarise_cells(trials, cases_of(runs), measures).table.to_dict("records")
    assert (row["success_low"], row["success_high"]) == pytest.approx(wilson(0.5, 4))


def test_drives_count_steps_over_the_shortest_of_failures_too():
    tried = [Tried("kg18", n=4, success=0.5)]
    (row,) = cells_of(tried, "drive", driven)[0].to_dict("records")
    assert row["expected_steps_ratio"] == pytest.approx((20 + 21 + 22 + 23) / 20 / 2)
    assert row["expected_seconds"] == pytest.approx(0.5)
    assert (row["returned"], row["overran"], row["never_left"]) == (0.5, 0, 0)


@pytest.mark.parametrize(("rate", "least"), [(0.9, 0.925), (0.5, 0.925), (0.15, 0.9)])
def test_the_interval_of_what_is_expected_holds_the_truth(rate, least):
    """Of 2000 samples of 100 trials, failures dearer than successes, about 95 % hold it."""
    random = np.random.default_rng(4)
    samples, n = 2000, 100
    success = random.random(samples * n) < rate
    spent = np.where(success, random.exponential(100, samples * n), 500.0)
    truth = (rate * 100 + (1 - rate) * 500) / rate
    found = expected(EFFORT, spent, success.astype(float), (np.repeat(range(samples), n), samples))
    low, high = found["expected_spent_low"], found["expected_spent_high"]
    inside = np.mean((low <= truth) & (truth <= high))
    assert least <= inside <= 0.975, inside


def test_a_run_over_a_scenario_has_the_problems_of_its_trials():
    """Five problems twice, of which the first three succeed both times, the fourth once."""
    trials, runs = planned([Tried("ga1", n=10, success=0.7), Tried("ga2", n=10, success=0.7)])
    trials["start"] = [f"({i // 2}, 0)" for i in range(10)] * 2
    cells = summarise_cells(trials, cases_of(runs), measures_of(find_task("plan")))
    assert cells.table[["problems", "once", "always"]].to_numpy().tolist() == [[5, 4, 3]] * 2
    numbers = cells.trials["problem"].to_numpy().reshape(2, 5, 2)
    assert (numbers == numbers[:1, :, :1]).all() and len(np.unique(numbers)) == 5
