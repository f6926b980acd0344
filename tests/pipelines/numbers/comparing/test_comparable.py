"""Groups are held against each other on what all of them have."""

import numpy as np
import pandas as pd
import pytest

from gapath.pipelines.numbers.comparing.comparable import comparable
from gapath.pipelines.numbers.comparing.comparison import compare
from gapath.pipelines.numbers.comparing.groups import side_by_side


def trials_of(*runs):
    """Trials of runs: group, problem, number of trials, and whether they draw random numbers."""
    frames = [
        pd.DataFrame(
            {
                "key": f"k{at}", "group": group, "map_digest": problem, "map_instance": 0,
                "start": "s", "target": "t", "seed": 0, "trial": range(n), "feasible": True,
                "evaluations": 40 * chance, "cost": np.arange(n) * chance + 3.0 * len(problem),
                "plan_time_s": np.arange(n) + 1.0,
            }
        )
        for at, (group, problem, n, chance) in enumerate(runs)
    ]  # fmt: skip
    trials = pd.concat(frames, ignore_index=True)
    return trials, trials.pop("group").astype("category")


@pytest.mark.parametrize(
    ("runs", "left", "said"),
    [
        ([("a", "m", 9, True), ("b", "m", 9, True)], {"a": 9, "b": 9}, ""),
        (
            [("a", "m", 9, True), ("b", "m", 9, True), ("b", "n", 5, True)],
            {"a": 9, "b": 9},
            "5 trials are left out: not all groups have their problem",
        ),
        ([("a", "m", 9, True), ("b", "n", 9, True)], {"a": 9, "b": 9}, "No problem is one of all"),
        (
            [("a", "m", 99, True), ("b", "m", 99, True), ("c", "m", 1, True)],
            {"a": 99, "b": 99},
            "c is left out: 1 trial, where others have 99.",
        ),
        (  # one trial of A* says all
            [("a", "m", 99, True), ("b", "m", 99, True), ("c", "m", 1, False)],
            {"a": 99, "b": 99, "c": 1},
            "",
        ),
        (  # the accident's problem counts for nobody
            [("a", "m", 99, True), ("b", "m", 99, True), ("c", "n", 1, True)],
            {"a": 99, "b": 99},
            "c is left out",
        ),
    ],
)
def test_trials_are_of_problems_that_all_groups_have(runs, left, said):
    found = comparable(*trials_of(*runs), ())
    assert found.group.value_counts().to_dict() == left
    assert list(found.group.cat.categories) == list(left)
    assert " ".join(found.said).startswith(said) if said else found.said == ()


def test_settings_that_vary_make_problems_of_their_own():
    trials, group = trials_of(
        ("a", "m", 4, True), ("b", "m", 4, True), ("b", "m", 6, True)
    )  # fmt: skip
    trials["planner.k"] = trials["key"].map({"k0": 4, "k1": 4, "k2": 5})
    found = comparable(trials, group, ("planner.k",))
    assert found.group.value_counts().to_dict() == {"a": 4, "b": 4}
    assert "instance, planner.k" in found.said[0]


def beside(*runs):
    trials, group = trials_of(*runs)
    return side_by_side(trials, "feasible", group)


def test_copies_of_one_answer_count_once_but_for_times():
    """Two problems, twenty trials each of two planners without chance: two answers each."""
    runs = [(group, problem, 20, False) for group in "ab" for problem in ("m", "nn")]
    groups = beside(*runs)
    assert [each.n for each in compare(groups, "cost").estimates] == [2, 2]
    assert [each.n for each in compare(groups, "time").estimates] == [40, 40]
    with_chance = [*runs[:2], *((group, problem, 20, True) for group, problem, *_ in runs[2:])]
    groups = beside(*with_chance)
    assert [each.n for each in compare(groups, "cost").estimates] == [40, 40]


def test_a12_is_taken_within_problems():
    """b costs more than a on both, but finds the dear one seldom: pooled it would look cheaper."""
    trials, group = trials_of(*[(g, p, 20, True) for g in "ab" for p in ("m", "nnnnnnnnnnnn")])
    trials["cost"] = trials["cost"] + (group == "b") * 0.5
    dear = (trials["map_digest"] != "m") & (group == "b") & (trials["trial"] > 1)
    trials["feasible"] = ~dear
    (pair,) = compare(side_by_side(trials, "feasible", group), "cost").pairs
    share = pair.difference.a12 if pair.first == "b" else 1 - pair.difference.a12
    m = trials[trials["map_digest"] == "m"]
    costs = [m.loc[group[m.index] == g, "cost"].to_numpy() for g in "ba"]
    cheap = np.mean(np.greater.outer(*costs) + np.equal.outer(*costs) / 2)
    n = trials[(trials["map_digest"] != "m") & trials["feasible"]]
    costs = [n.loc[group[n.index] == g, "cost"].to_numpy() for g in "ba"]
    rare = np.mean(np.greater.outer(*costs) + np.equal.outer(*costs) / 2)
    assert share == pytest.approx((cheap + rare) / 2)
