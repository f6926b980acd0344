"""Groups of trials held against each other, as a whole."""

import itertools
import math
import warnings

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from gapath.pipelines.numbers.comparing.comparison import QUANTITIES, compare
from gapath.pipelines.numbers.comparing.expected import expected
from gapath.pipelines.numbers.comparing.groups import Groups, side_by_side
from gapath.pipelines.numbers.statistics import expected_running_time

DEMSAR = """
0.763 0.768 0.771 0.798
0.599 0.591 0.590 0.569
0.954 0.971 0.968 0.967
0.628 0.661 0.654 0.657
0.882 0.888 0.886 0.898
0.936 0.931 0.916 0.931
0.661 0.668 0.609 0.685
0.583 0.583 0.563 0.625
0.775 0.838 0.866 0.875
1.000 1.000 1.000 1.000
0.940 0.962 0.965 0.962
0.619 0.666 0.614 0.669
0.972 0.981 0.9751 0.975
0.957 0.978 0.946 0.970
"""
"""AUC of C4.5 with four ways of tuning on 14 sets of data (Demsar 2006, Table 6). Of two
0.975 in one row the first ranks before the other there, so it has a digit more here."""


def of_tables(success, chance=None, **spent):
    """Groups a, b, c, ... from tables of blocks by groups."""
    success = np.array(success, float)
    names = tuple("abcdefghij"[: success.shape[1]])
    spent = {name: np.array(values, float) for name, values in spent.items()}
    return Groups(names, success, spent, chance or (True,) * len(names), 0)


def trials_of(runs, n=6):
    """Trials of runs, each given as changes to the columns of a run."""
    plain = {
        "map_digest": "m", "map_instance": 0, "start": "s", "target": "t",
        "corner_cutting": "allow", "seed": 0, "evaluations": 40, "cost": 3.0,
    }  # fmt: skip
    frames = []
    for at, run in enumerate(runs):
        frame = pd.DataFrame({"trial": range(n), "key": f"k{at}", **plain, **run})
        frames.append(frame.assign(feasible=frame["trial"] > 0))
    return pd.concat(frames, ignore_index=True)


def grouped(trials, by, also=()):
    return side_by_side(trials, "feasible", trials[by].astype("category"), also)


def no_nan(comparison):
    numbers = [x for each in comparison.estimates for x in each]
    numbers += [x for pair in comparison.pairs for x in (*pair.difference, pair.adjusted)]
    return not any(isinstance(x, float) and math.isnan(x) for x in numbers)


def test_friedman_of_demsars_table():
    table = np.array([line.split() for line in DEMSAR.split("\n") if line], float)
    comparison = compare(of_tables(np.ones_like(table), cost=1 - table), "cost")
    found = comparison.omnibus
    assert (found.test, found.blocks) == ("Friedman", 14)
    ranks = {each.group: each.rank for each in comparison.estimates}
    assert [round(ranks[name], 3) for name in "abcd"] == [3.143, 2.0, 2.893, 1.964]
    # as printed there, without the correction of ties that SciPy makes
    plain = 12 * 14 / (4 * 5) * (sum(rank**2 for rank in ranks.values()) - 4 * 25 / 4)
    assert round(plain, 2) == 9.28
    assert found.p < stats.chi2.sf(9.28, 3) < 0.05


def test_cochrans_q_by_hand():
    success = [[1, 1, 0], [1, 1, 0], [1, 0, 0], [1, 1, 1], [0, 1, 0], [1, 1, 0]]
    # columns 5, 5, 1; rows 2, 2, 1, 3, 1, 2: 2 (3 * 51 - 121) / (3 * 11 - 23)
    found = compare(of_tables(success), "success").omnibus
    assert found.test == "Cochran's Q"
    assert found.p == pytest.approx(stats.chi2.sf(6.4, 2))


def test_groups_differ_in_pairs_only_if_they_differ_at_all():
    random = np.random.default_rng(5)
    for seed in range(60):
        success = np.random.default_rng(seed).random((40, 6)) < 0.6
        comparison = compare(of_tables(success), "success")
        if comparison.omnibus.p >= 0.05:
            assert not any(pair.apart for pair in comparison.pairs)
    clear = random.random((200, 3)) < [0.2, 0.5, 0.9]
    assert all(pair.apart for pair in compare(of_tables(clear), "success").pairs)


def test_holm_is_taken_over_all_pairs_of_a_quantity():
    success = np.random.default_rng(1).random((80, 4)) < [0.5, 0.6, 0.7, 0.8]
    pairs = compare(of_tables(success), "success").pairs
    ordered = sorted(pairs, key=lambda pair: pair.difference.p)
    least = 0
    for place, pair in enumerate(ordered):
        least = max(least, min(1, (6 - place) * pair.difference.p))
        assert pair.adjusted == pytest.approx(least)


def test_the_best_stands_first_and_the_others_against_it():
    success = np.random.default_rng(2).random((300, 3)) < [0.5, 0.9, 0.6]
    comparison = compare(of_tables(success), "success")
    assert [each.group for each in comparison.estimates] == ["b", "c", "a"]
    against = comparison.against_best()
    assert [(pair.first, pair.second) for pair in against] == [("b", "c"), ("b", "a")]
    for pair in against:
        other = "abc".index(pair.second)
        assert pair.difference.effect == pytest.approx(
            success[:, 1].mean() - success[:, other].mean()
        )
        assert pair.difference.low < pair.difference.effect < pair.difference.high


@settings(max_examples=12)
@given(st.integers(0, 10**6), st.integers(2, 4), st.integers(2, 30), st.booleans())
def test_neither_the_order_of_trials_nor_of_groups_changes_anything(seed, k, n, gaps):
    random = np.random.default_rng(seed)
    success = (random.random((n, k)) < 0.7).astype(float)
    spent = random.integers(1, 9, (n, k)) * 10.0
    if gaps:
        gone = random.random((n, k)) < 0.4
        success[gone] = spent[gone] = np.nan
    rows, columns = random.permutation(n), random.permutation(k)
    cost = np.where(success == 1, spent, np.nan)
    for quantity in ("success", "evaluations", "cost"):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            plain = compare(of_tables(success, evaluations=spent, cost=cost), quantity)
            tables = (success, spent, cost)
            mixed = compare(
                of_tables(tables[0][rows], evaluations=tables[1][rows], cost=tables[2][rows]),
                quantity,
            )
            moved = compare(
                of_tables(tables[0][:, columns], evaluations=tables[1][:, columns],
                          cost=tables[2][:, columns]),
                quantity,
            )  # fmt: skip
        assert no_nan(plain)
        assert mixed.estimates == plain.estimates
        for one, other in zip(plain.pairs, mixed.pairs, strict=True):
            assert one.adjusted == pytest.approx(other.adjusted)
        of = dict(zip("abcd", ["abcd"[column] for column in columns], strict=False))
        mine = {pair[:2]: pair for pair in plain.pairs}
        for pair in moved.pairs:
            names = of[pair.first], of[pair.second]
            one = mine.get(names) or mine[names[::-1]].swapped()
            assert pair.apart == one.apart
            for name in ("p", "effect", "a12"):
                assert getattr(pair.difference, name) == pytest.approx(
                    getattr(one.difference, name)
                )


@pytest.mark.parametrize("spent", [[0] * 18 + [100, 120], [0] * 20])
@pytest.mark.filterwarnings("error")
def test_where_a_resample_spends_nothing_there_is_neither_interval_nor_test(spent):
    table = np.array([spent, [50 + at for at in range(20)]], float).T
    found = expected(table, np.ones_like(table))
    why = "too few that spend anything"
    assert found.estimate(0) == (sum(spent) / 20, None, None, f"{why} for an interval")
    assert found.estimate(1)[3] == ""
    for pair in ((0, 1), (1, 0)):
        (mine,) = found.differences([pair], [True])
        assert (mine.p, mine.low, mine.high, mine.why) == (None, None, None, f"{why} for a test")
        assert (mine.effect is None) == (sum(spent) == 0)


def test_expected_amounts_agree_with_scipys_bootstrap():
    random = np.random.default_rng(4)
    success = random.random((400, 2)) < [0.9, 0.5]
    spent = np.where(success, random.integers(1, 50, (400, 2)), 100) * 10.0
    found = expected(spent, success.astype(float))

    def ratio(*columns, axis=-1):
        (a, b, x, y) = (column.sum(axis=axis) for column in columns)
        return a / x / (b / y)

    columns = (*spent.T, *success.T.astype(float))
    theirs = stats.bootstrap(columns, ratio, paired=True, method="percentile", n_resamples=4000,
                             rng=np.random.default_rng(0)).confidence_interval  # fmt: skip
    (mine,) = found.differences([(0, 1)], [True])
    assert mine.effect == pytest.approx(ratio(*columns))
    assert (mine.low, mine.high) == pytest.approx(theirs, rel=0.03)
    assert found.values[1] == expected_running_time(spent[:, 1], success[:, 1])
    assert mine.p < 1e-6
    assert list(expected(spent, success.astype(float)).differences([(0, 1)], [True])) == [mine]


def test_expected_amounts_of_many_blocks_are_drawn_in_batches():
    random = np.random.default_rng(4)
    success = random.random((6000, 2)) < [0.9, 0.8]
    spent = random.integers(1, 50, (6000, 2)) * 10.0
    found = expected(spent, success.astype(float))
    log = np.log(spent[:, 0].sum() / success[:, 0].sum())
    shares = spent[:, 0] / spent[:, 0].mean() - success[:, 0] / success[:, 0].mean()
    error = shares.std() / math.sqrt(6000)  # the delta method's
    assert found.logs[:, 0].std() == pytest.approx(error, rel=0.1)
    assert found.logs[:, 0].mean() == pytest.approx(log, abs=3 * error)


def test_expected_amounts_are_no_different_19_times_in_20_where_nothing_differs():
    apart = 0
    for seed in range(100):
        random = np.random.default_rng(seed)
        success = (random.random((100, 2)) < 0.7).astype(float)
        spent = np.where(success, random.exponential(1, (100, 2)), 4)
        (found,) = expected(spent, success).differences([(0, 1)], [True])
        apart += found.p < 0.05
    assert apart <= 11


def test_blocks_are_problems_seeds_and_numbers_whatever_stands_beside():
    runs = [
        {"planner.k": 4, "planner.population": 40, "seed": seed} for seed in (1, 2)
    ] + [{"planner.k": 5, "planner.population": 80, "seed": seed} for seed in (2, 1)]  # fmt: skip
    groups = grouped(trials_of(runs), "planner.population")
    assert (groups.names, groups.success.shape) == (("40", "80"), (12, 2))
    assert compare(groups, "success").pairs[0].pairs == 12
    assert not np.isnan(groups.success).any()
    also = grouped(trials_of(runs), "planner.population", ["planner.k"])
    assert compare(also, "success").pairs[0].pairs == 0


def test_a_trial_done_twice_counts_once():
    groups = grouped(trials_of([{"g": 1}, {"g": 2}, {"g": 2, "evaluations": 90}]), "g")
    assert groups.repeated == 6
    assert (groups.spent["evaluations"][:, 1] == 90).all()


def test_trials_without_partners_are_compared_unpaired():
    groups = grouped(trials_of([{"g": 1, "seed": 5}, {"g": 2, "map_digest": "n"}]), "g")
    assert groups.success.shape == (6, 2)
    pair = compare(groups, "cost").pairs[0]
    assert (pair.pairs, pair.difference.test) == (0, "Mann-Whitney")


def test_fewer_pairs_than_half_of_the_smaller_group_are_no_pairs():
    trials = trials_of([{"g": 1}, {"g": 2}])
    few = trials[(trials["g"] == 1) | (trials["trial"] >= 4) | (trials["seed"] == 9)]
    others = trials_of([{"g": 2, "seed": 7, "key": "other"}])
    groups = grouped(pd.concat([few, others], ignore_index=True), "g")
    assert compare(groups, "success").pairs[0].difference.test == "Fisher, exact"
    assert compare(grouped(few, "g"), "success").pairs[0].pairs == 2


def test_three_groups_without_blocks_are_asked_by_other_tests():
    runs = [{"g": g, "seed": g, "cost": [1.0, 2, 3, 4, 5, g]} for g in (1, 2, 3)]
    groups = grouped(trials_of(runs), "g")
    assert compare(groups, "success").omnibus.why == ""
    assert compare(groups, "success").omnibus.p == pytest.approx(1)
    columns = [[2.0, 3, 4, 5, g] for g in (1, 2, 3)]
    found = compare(groups, "cost").omnibus
    assert found.test == "Kruskal-Wallis"
    assert found.p == pytest.approx(stats.kruskal(*columns).pvalue)


def test_a_planner_without_chance_is_no_sample():
    plain = {"evaluations": 0, "cost": 5.0}
    trials = trials_of([{"g": "astar", **plain}, {"g": "dijkstra", **plain}, {"g": "ga"}])
    trials.loc[trials["g"] != "ga", "feasible"] = True
    groups = grouped(trials, "g")
    assert groups.chance == (False, False, True)
    comparison = compare(groups, "success")
    pairs = {pair[:2]: pair for pair in comparison.pairs}
    still = pairs["astar", "dijkstra"]
    assert "no sample" in still.difference.why
    assert (still.difference.p, still.apart) == (None, False)
    assert pairs["astar", "ga"].difference.p is not None
    of = {each.group: each for each in comparison.estimates}
    assert of["astar"].low is None
    assert "without chance" in of["astar"].why
    evaluations = compare(groups, "evaluations")
    assert [each.value for each in evaluations.estimates] == [40, None, None]
    assert evaluations.pairs == ()


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_nothing_is_printed_as_a_number_that_is_none(quantity):
    nothing, everything = np.zeros((5, 3)), np.ones((5, 3))
    cases = [
        of_tables(nothing, evaluations=everything, time=everything, cost=nothing * np.nan),
        of_tables(everything, evaluations=everything, time=everything, cost=nothing),
        of_tables(everything[:1], evaluations=everything[:1], time=everything[:1]),
        of_tables(everything),
        of_tables(np.eye(3), evaluations=np.eye(3), time=np.eye(3), cost=np.eye(3)),
    ]
    for groups in cases:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            comparison = compare(groups, quantity)
        assert no_nan(comparison)
        for each in comparison.estimates:
            assert each.value is not None or each.why
        for pair in comparison.pairs:
            assert pair.difference.p is not None or pair.difference.why


def test_many_groups_have_all_tests_and_the_best_ones_sizes():
    random = np.random.default_rng(0)
    success = np.ones((30, 10))
    spent = random.integers(10, 90, (30, 10)) * 1.0
    names = tuple(f"g{at}" for at in range(14))
    wide = Groups(names, np.ones((30, 14)), {"cost": np.c_[spent, spent[:, :4] + 1]},
                  (True,) * 14, 0)  # fmt: skip
    comparison = compare(wide, "cost")
    best = comparison.best.group
    assert len(comparison.pairs) == 14 * 13 / 2
    assert all(pair.difference.p is not None for pair in comparison.pairs)
    sized = {frozenset(pair[:2]) for pair in comparison.pairs if pair.difference.a12 is not None}
    assert sized == {frozenset((best, name)) for name in names if name != best}
    few = compare(of_tables(success, cost=spent), "cost")
    assert all(pair.difference.a12 is not None for pair in few.pairs)
    assert len(few.pairs) == len(list(itertools.combinations(range(10), 2)))
