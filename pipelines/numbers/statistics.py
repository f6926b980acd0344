"""The few statistics that the tables need, each with failures counted."""

import math
from collections.abc import Iterable
from functools import lru_cache
from statistics import NormalDist
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Interval: TypeAlias = tuple[float, float]

_Z = NormalDist().inv_cdf(0.975)
_RESAMPLES = 1000


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


def median_interval(values: ArrayLike, seed: int = 0) -> Interval:
    """Give the 95 % interval of a median by the percentile bootstrap (Efron 1979).

    Parameters
    ----------
    values : (n,) float
        Independent observations, in any unit.
    seed : int
        Key of the resampling; the same values and seed give the same interval.

    Returns
    -------
    (low, high) : float
        In the unit of the values; NaN where there are none.
    """
    sample = np.sort(np.asarray(values, dtype=float))
    if sample.size == 0:
        return math.nan, math.nan
    if sample[0] == sample[-1]:
        return float(sample[0]), float(sample[0])
    lower, upper = _middles(sample.size, seed)
    low, high = np.quantile((sample[lower] + sample[upper]) / 2, (0.025, 0.975))
    return float(low), float(high)


@lru_cache(maxsize=64)
def _middles(n: int, seed: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Give the places of the two middle values of each resample in the sorted sample."""
    random = np.random.Generator(np.random.SFC64(seed))
    draws = random.integers(n, size=(_RESAMPLES, n))
    middles = (n - 1) // 2, n // 2
    draws.partition(middles, axis=1)
    return draws[:, middles[0]].copy(), draws[:, middles[1]].copy()


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
