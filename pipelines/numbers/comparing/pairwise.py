"""Tests of two groups of trials, and the sizes of their differences: SciPy's and statsmodels'."""

import gc
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.pipelines.numbers.statistics import Interval, median_interval, wilson

Vector = NDArray[np.float64]

LEVEL = 0.05
"""A difference counts if it would come about by chance less often than this."""

_RESAMPLES, _AT_ONCE = 1000, 1 << 24
"""Resamples of a bootstrap, and trials in those that are made at once: more would not fit."""


class Difference(NamedTuple):
    """How two groups differ in one quantity; None where a number cannot be had.

    `effect` is a difference of rates, or the ratio of a first group's amount to a second's, with
    its 95 % interval `low` to `high`; `a12` the share of all pairs of a trial of either in which
    the first has more, equal ones by half (Vargha and Delaney 2000); `p` the test's, `zeros` the
    pairs without a difference; `why` says what is missing, and for what reason.
    """

    test: str
    p: float | None = None
    effect: float | None = None
    low: float | None = None
    high: float | None = None
    a12: float | None = None
    zeros: int = 0
    why: str = ""

    def swapped(self) -> "Difference":
        """Give the same with the other group first."""
        ends = self.effect, self.high, self.low
        if self.test in _OF_RATES:
            effect, low, high = (None if end is None else 0.0 - end for end in ends)
        else:
            effect, low, high = (None if end is None else 1 / end for end in ends)
        a12 = None if self.a12 is None else 1 - self.a12
        return self._replace(effect=effect, low=low, high=high, a12=a12)


_MCNEMAR, _SCORE, _FISHER = _OF_RATES = ("McNemar, exact", "score test", "Fisher, exact")
"""Tests whose effect is a difference, not a ratio."""


def holm(ps: Sequence[float | None]) -> list[float | None]:
    """Adjust p-values of several tests (Holm 1979, Scandinavian Journal of Statistics 6, 65-70).

    Parameters
    ----------
    ps : sequence of float or None
        None where there is no test.

    Returns
    -------
    list of float or None
        In the same order.
    """
    from statsmodels.stats.multitest import multipletests

    known = [p for p in ps if p is not None]
    gc.freeze()  # it collects garbage, which takes long where many modules are loaded
    try:
        adjusted = iter(multipletests(known, method="holm")[1] if known else ())
    finally:
        gc.unfreeze()
    return [None if p is None else float(next(adjusted)) for p in ps]


def paired_rates(both: int, first: int, second: int, neither: int) -> Difference:
    """Compare how often two groups succeed, of trials in pairs.

    Parameters
    ----------
    both, first, second, neither : int
        Pairs in which both succeeded, only the first, only the second, none.

    Returns
    -------
    Difference
        McNemar's exact test (statsmodels), and Newcombe's interval of the difference (method 10 of
        Newcombe 1998, Statistics in Medicine 17, 2635-2650).
    """
    from statsmodels.stats.contingency_tables import mcnemar

    n = both + first + second + neither
    effect = (first - second) / n
    low, high = _newcombe(both, first, second, neither)
    result = Difference(_MCNEMAR, None, effect, low, high, zeros=both + neither)
    if n < 2:
        return result._replace(low=None, high=None, why="one pair only, too few for a test")
    if first + second == 0:
        return result._replace(p=1.0, why="no pair in which only one succeeded")
    p = mcnemar([[both, first], [second, neither]], exact=True).pvalue
    return result._replace(p=float(p))


def _newcombe(both: int, first: int, second: int, neither: int) -> Interval:
    """Square and add Wilson's limits of both rates, less what correlates (statsmodels has none)."""
    n = both + first + second + neither
    rates = (both + first) / n, (both + second) / n
    (low1, high1), (low2, high2) = (wilson(rate, n) for rate in rates)
    margins = (both + first) * (second + neither) * (both + second) * (first + neither)
    product = both * neither - first * second
    less = min(n / 2, product) if product > 0 else 0  # a correction for continuity
    phi = (product - less) / math.sqrt(margins) if margins else 0.0

    def reach(one: float, other: float) -> float:
        return math.sqrt(max(0.0, one**2 - 2 * phi * one * other + other**2))

    effect = rates[0] - rates[1]
    low = effect - reach(rates[0] - low1, high2 - rates[1])
    high = effect + reach(high1 - rates[0], rates[1] - low2)
    return max(low, -1.0), min(high, 1.0)


def unpaired_rates(succeeded: tuple[int, int], n: tuple[int, int]) -> Difference:
    """Compare how often two groups succeed, of trials that make no pairs.

    Parameters
    ----------
    succeeded, n : (int, int)
        Successes and trials of both.

    Returns
    -------
    Difference
        The score test, or Fisher's exact one where fewer than 5 successes or failures are
        expected in a group; Newcombe's interval of the difference (statsmodels).
    """
    from scipy.stats import fisher_exact
    from statsmodels.stats.proportion import confint_proportions_2indep, test_proportions_2indep

    (x1, x2), (n1, n2) = succeeded, n
    effect = x1 / n1 - x2 / n2
    overall = (x1 + x2) / (n1 + n2)
    few = min(n1, n2) * min(overall, 1 - overall) < 5
    result = Difference(_FISHER if few else _SCORE, None, effect)
    if min(n1, n2) < 2:
        return result._replace(why="a group of one trial only, too few for a test")
    low, high = confint_proportions_2indep(x1, n1, x2, n2, method="newcomb")
    result = result._replace(low=float(low), high=float(high))
    if overall in (0, 1):
        return result._replace(p=1.0, why="all trials ended alike")
    if few:
        return result._replace(p=float(fisher_exact([[x1, n1 - x1], [x2, n2 - x2]]).pvalue))
    with np.errstate(divide="ignore"):  # it takes the ratio of odds, too
        p = test_proportions_2indep(x1, n1, x2, n2, method="score").pvalue
    return result._replace(p=float(p))


def paired_amounts(
    first: Vector, second: Vector, sized: bool = True, p: float | None = None
) -> Difference:
    """Compare what two groups spend, of trials in pairs.

    Parameters
    ----------
    first, second : (n,) float64
        Of each pair, in one unit.
    sized : bool
        Whether to give the size of the difference, too.
    p : float, optional
        `signed_rank` of the differences, if that is known.

    Returns
    -------
    Difference
        Wilcoxon's signed rank test; as effect the median of the pairs' ratios, with its bootstrap
        interval over pairs, where all amounts are positive.
    """
    n = len(first)
    zeros = int(np.count_nonzero(first == second))
    result = Difference("Wilcoxon, signed rank", zeros=zeros)
    if n < 2:
        return result._replace(why=f"{'one pair' if n else 'no pair'} only, too few for a test")
    if sized and min(first.min(), second.min()) > 0:
        # logarithms, so that swapping both gives the inverse, also between two middle values
        ratios = np.log(first) - np.log(second)
        ends = (float(np.median(ratios)), *median_interval(ratios))
        effect, low, high = (math.exp(end) for end in ends)
        result = result._replace(effect=effect, low=low, high=high)
    if zeros == n:
        return result._replace(p=1.0, why="the same in all pairs")
    if p is None:
        p = float(signed_rank((first - second)[:, np.newaxis])[0])
    return result._replace(p=p)


def signed_rank(differences: NDArray[np.float64]) -> Vector:
    """Give the p-value of Wilcoxon's signed rank test of each column.

    Differences of 0 are left out (Wilcoxon 1945).

    Parameters
    ----------
    differences : (n, m) float64
        Of n pairs, not all 0 in any column.

    Returns
    -------
    (m,) float64
        Two-sided.
    """
    from scipy.stats import wilcoxon

    if len(differences) > 50:  # where SciPy takes the normal distribution whatever the column
        columns = [differences]
    else:  # it chooses the distribution by all columns together, so each alone
        columns = np.split(differences, differences.shape[1], axis=1)
    return np.concatenate([wilcoxon(each, axis=0).pvalue for each in columns])


def unpaired_amounts(first: Vector, second: Vector, sized: bool = True) -> Difference:
    """Compare what two groups spend, of trials that make no pairs.

    Parameters
    ----------
    first, second : (n,) and (m,) float64
        Of each trial, in one unit.
    sized : bool
        Whether to give the size of the difference, too.

    Returns
    -------
    Difference
        The Mann-Whitney test; as effect the ratio of medians, with its bootstrap interval over the
        trials of each group, where all amounts are positive.
    """
    from scipy.stats import bootstrap, mannwhitneyu

    result = Difference("Mann-Whitney")
    if min(len(first), len(second)) < 2:
        return result._replace(why="a group of one trial only, too few for a test")
    if sized and min(first.min(), second.min()) > 0:
        batch = max(1, min(_RESAMPLES, _AT_ONCE // (len(first) + len(second))))
        low, high = bootstrap(
            (first, second), _median_ratio, n_resamples=_RESAMPLES, method="percentile",
            batch=batch, rng=np.random.default_rng(0), vectorized=True,
        ).confidence_interval  # fmt: skip
        effect = float(_median_ratio(first, second))
        result = result._replace(effect=effect, low=float(low), high=float(high))
    if first.min() == second.max() == first.max() == second.min():
        return result._replace(p=1.0, why="the same in all trials")
    return result._replace(p=float(mannwhitneyu(first, second).pvalue))


def _median_ratio(first: Vector, second: Vector, axis: int = -1) -> Vector:
    ratio: Vector = np.median(first, axis=axis) / np.median(second, axis=axis)
    return ratio


def more_often(first: Vector, second: Vector) -> float:
    """Give Vargha and Delaney's A12, from the Mann-Whitney statistic U: U / (n m).

    Parameters
    ----------
    first, second : (n,) and (m,) float64
        Of each trial, in one unit.

    Returns
    -------
    float
        The share of all n m pairs of trials in which the first has more, equal ones by half.
    """
    from scipy.stats import mannwhitneyu

    u = mannwhitneyu(first, second, method="asymptotic").statistic
    return float(u) / (len(first) * len(second))


def more_often_by_problem(
    first: Vector, second: Vector, of_first: Vector, of_second: Vector
) -> float | None:
    """Give A12 within problems: pooled, those that few solve would say which group has more.

    Parameters
    ----------
    first, second : (n,) and (m,) float64
        Of each trial, in one unit.
    of_first, of_second : (n,) and (m,) float64
        The problem of each trial.

    Returns
    -------
    float or None
        The mean of `more_often` over the problems that both have; None if there is none.
    """
    shared = np.intersect1d(of_first, of_second)
    each = [
        more_often(first[of_first == problem], second[of_second == problem]) for problem in shared
    ]
    return float(np.mean(each)) if each else None
