"""The few statistics that the tables need, each with failures counted."""

import math
from bisect import bisect_left
from collections.abc import Iterable
from functools import lru_cache
from statistics import NormalDist
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Interval: TypeAlias = tuple[float, float]

_Z = NormalDist().inv_cdf(0.975)
_LEVELS = 0.025, 0.975
_REACH = 40
"""The two middle values of a resample are hardly ever as far from one another in the sample."""
_TINY = 1e-13


def wilson(rate: float, n: int) -> Interval:
    """Give the 95 % interval of a success rate (Wilson 1927).

    A mean of n independent rates, one for each instance of a class of maps, varies at
    most as much as a mean of n coins, so the same interval holds for it, on the safe side.

    Parameters
    ----------
    rate : float
        The observed rate in [0, 1].
    n : int
        Number of independent observations: trials, or instances of a class.

    Returns
    -------
    (low, high) : float
        Both in [0, 1]; (0, 1) where nothing was observed.
    """
    if n == 0:
        return 0.0, 1.0
    z2 = _Z * _Z
    centre = (rate + z2 / (2 * n)) / (1 + z2 / n)
    half = _Z * math.sqrt(rate * (1 - rate) / n + z2 / (4 * n * n)) / (1 + z2 / n)
    # At rates of 0 and 1 one end is exact; rounding must not push it off.
    low = 0.0 if rate == 0 else max(0.0, centre - half)
    high = 1.0 if rate == 1 else min(1.0, centre + half)
    return low, high


def median_interval(values: ArrayLike) -> Interval:
    """Give the 95 % interval of a median by the percentile bootstrap, exactly.

    Of a sample whose median is taken of a resample the distribution is known (Efron 1979, Maritz
    and Jarrett 1978), so nothing is drawn: the ends are its quantiles.

    Parameters
    ----------
    values : (n,) float
        Independent observations, in any unit.

    Returns
    -------
    (low, high) : float
        In the unit of the values; NaN where there are none.
    """
    sample = np.sort(np.asarray(values, dtype=float))
    if sample.size == 0:
        return math.nan, math.nan
    low, high = median_intervals(sample[np.newaxis])
    return float(low[0]), float(high[0])


def median_intervals(samples: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Give `median_interval` of samples of the same size.

    Parameters
    ----------
    samples : (m, n) float64
        A sample a row, ascending, n > 0.

    Returns
    -------
    low, high : (m,) float64
        The interval of each.
    """
    return tuple(_bootstrap_quantile(samples, level) for level in _LEVELS)


def _bootstrap_quantile(samples: NDArray[np.float64], level: float) -> NDArray[np.float64]:
    """Give a quantile of the median of resamples: the least value with at least so much below."""
    middles = _middles(samples.shape[1], level)
    found = np.empty(len(samples))
    step = max(1, 10**6 // len(middles.weight))
    for at in range(0, len(samples), step):
        some = samples[at : at + step]
        values = (some[:, middles.lower] + some[:, middles.upper]) / 2
        order = np.argsort(values, axis=1)
        enough = middles.below + np.cumsum(middles.weight[order], axis=1) >= level
        rows = np.arange(len(some))
        first = values[rows, order[rows, enough.argmax(axis=1)]]
        value = np.where(enough.any(axis=1), first, np.inf)
        found[at : at + step] = np.clip(value, some[:, middles.least], some[:, middles.most])
    return found


class _Middles(NamedTuple):
    """The pairs of middle values of a resample among whose means a quantile of them lies."""

    lower: NDArray[np.int64]
    upper: NDArray[np.int64]
    """Their places in the sorted sample; twice the same for a sample of odd size."""
    weight: NDArray[np.float64]
    """How probable each is."""
    below: float
    """How probable are all pairs that lie at or below `least`."""
    least: int
    most: int
    """The places of values between which the quantile lies."""


@lru_cache(maxsize=1024)
def _middles(n: int, level: float) -> _Middles:
    """Find the pairs for samples of n values.

    Of a resample the k-th value is at most the i-th of the sample if at least k of n draws are
    among its first i: P = I(i / n; k, n - k + 1), the incomplete beta function. Of an even n = 2 m
    the m-th value is at most the i-th and the next beyond the j-th, i <= j, if m draws are among
    the first i and m beyond the j-th: P = (n over m) (i / n)^m (1 - j / n)^m.
    """
    from scipy.special import betainc, gammaln

    def place(k: int) -> int:
        """Find the first i for which the k-th of a resample is among the first i often enough."""
        return bisect_left(range(n), level, lo=1, key=lambda i: betainc(k, n - k + 1, i / n))

    m = n // 2
    least, most = place((n + 1) // 2), place(m + 1)
    if least == most:
        at = np.array([most - 1])
        return _Middles(at, at, np.ones(1), 0.0, most - 1, most - 1)
    i = np.arange(max(1, most - _REACH), most + 1)[:, np.newaxis]
    j = np.arange(least, min(n, least + _REACH) + 1)
    with np.errstate(divide="ignore"):  # a logarithm of 0
        chosen = gammaln(n + 1) - 2 * gammaln(m + 1)
        starts = np.log(i / n) * m + np.log(-np.expm1(m * np.log1p(-1 / i)))
        last = np.log1p(-j / n) * m
        ends = np.log1p(-(j - 1) / n) * m
        ends = ends + np.log(-np.expm1(last - ends))
        apart = np.exp(chosen + starts + ends)
        beyond = np.exp(chosen + starts + np.log1p(-i / n) * m)
    one = betainc(m, m + 1, i / n) - betainc(m, m + 1, (i - 1) / n) - beyond
    weight = np.where(i < j, apart, np.where(i == j, one, 0.0))
    weight[(i >= most) | (j <= least)] = 0.0
    rows, cols = np.nonzero(weight > _TINY)
    below = float(betainc(m + 1, m, least / n))
    lower, upper = i[rows, 0] - 1, j[cols] - 1
    return _Middles(lower, upper, weight[rows, cols], below, least - 1, most - 1)


def expected_running_time(spent: ArrayLike, success: ArrayLike) -> float:
    """Give the expected running time until a success, if a failed run is restarted.

    The effort of all runs, failures included, for each success (Hansen et al., COCO).

    Parameters
    ----------
    spent : (n,) float
        Effort of each run: evaluations, or seconds.
    success : (n,) bool
        Whether the run succeeded.

    Returns
    -------
    float
        In the unit of `spent`; infinite without a success.
    """
    successes = int(np.count_nonzero(np.asarray(success, dtype=bool)))
    return float(np.sum(spent)) / successes if successes else math.inf


def share_within(spent: ArrayLike, success: ArrayLike) -> tuple[NDArray[np.float64], ...]:
    """Give the share of all trials that have succeeded having spent at most so much.

    Parameters
    ----------
    spent : (n,) float
        What each trial spent: evaluations, or steps over the fewest possible.
    success : (n,) bool
        Whether the trial succeeded; one that failed never counts.

    Returns
    -------
    spent : (m,) float64
        Ascending, each once.
    share : (m,) float64
        Of all trials, at that much.
    """
    succeeded = np.asarray(success, dtype=bool)
    levels, counts = np.unique(np.asarray(spent, dtype=float)[succeeded], return_counts=True)
    return levels, np.cumsum(counts) / len(succeeded)


def by_epoch(curves: Iterable[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Give the quartiles of the best fitness by epoch.

    Parameters
    ----------
    curves : iterable of (epochs,) float64
        The best fitness of each trial; one that ended keeps its last.

    Returns
    -------
    (3, E) float64
        Lower quartile, median and upper quartile over all trials, E the longest trial's epochs.
    """
    curves = list(curves)
    longest = max(len(curve) for curve in curves)
    table = np.stack([np.pad(curve, (0, longest - len(curve)), mode="edge") for curve in curves])
    return np.quantile(table, (0.25, 0.5, 0.75), axis=0)
