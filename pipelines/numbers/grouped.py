"""Sums and quantiles of many groups at once: one pass over the trials, however many groups."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from gapath.pipelines.numbers.statistics import median_intervals

Column = NDArray[np.float64]


class Spread(NamedTuple):
    """Median, its 95 % bootstrap interval, and quartiles; NaN where there are no values."""

    median: Column
    low: Column
    high: Column
    q1: Column
    q3: Column


class Quartiles(NamedTuple):
    """Lower quartile, median and upper quartile; NaN where there are no values."""

    q1: Column
    median: Column
    q3: Column


@dataclass(frozen=True, eq=False)
class Groups:
    """To which group each trial belongs.

    Parameters
    ----------
    of : (n,) int64
        The group of each trial, from 0; -1 of one that is in none.
    count : int
        How many groups there are. None is empty.
    """

    of: NDArray[np.int64]
    count: int

    @classmethod
    def one(cls, n: int) -> Self:
        """Put n trials into one group."""
        return cls(np.zeros(n, dtype=np.int64), 1)

    @cached_property
    def _order(self) -> NDArray[np.intp]:
        """Trials by group, in their order within each."""
        order = np.argsort(self.of, kind="stable")
        return order[np.count_nonzero(self.of < 0) :]

    @cached_property
    def sizes(self) -> NDArray[np.int64]:
        """How many trials each group has, (count,)."""
        return np.bincount(self.of[self._order], minlength=self.count)

    def sums(self, values: ArrayLike) -> NDArray[np.float64]:
        """Sum up values, one a trial: (count,) float64."""
        ordered = np.asarray(values, dtype=np.float64)[self._order]
        return np.array([ordered[mine].sum() for mine in _slices(self.sizes)])

    def counts(self, flags: ArrayLike) -> NDArray[np.int64]:
        """Count the trials of which something is true: (count,) int64."""
        return self.sums(np.asarray(flags, dtype=np.bool_)).astype(np.int64)

    def distinct(self, values: pd.Series) -> NDArray[np.int64]:
        """Count the different values, one a trial: (count,) int64."""
        found = values.groupby(self.of).nunique().reindex(range(self.count), fill_value=0)
        return np.asarray(found, dtype=np.int64)

    def quartiles(self, values: ArrayLike) -> Quartiles:
        """Give the quartiles of values, one a trial; those that are NaN are left out."""
        ascending, sizes = self._ascending(values)
        return Quartiles(*(_quantile(ascending, sizes, level) for level in (0.25, 0.5, 0.75)))

    def spreads(self, values: ArrayLike) -> Spread:
        """Describe how values spread, one a trial; those that are NaN are left out."""
        ascending, sizes = self._ascending(values)
        q1, median, q3 = (_quantile(ascending, sizes, level) for level in (0.25, 0.5, 0.75))
        low, high = np.full((2, self.count), np.nan)
        first = np.cumsum(sizes) - sizes
        for size in np.unique(sizes[sizes > 0]):
            alike = np.flatnonzero(sizes == size)
            samples = ascending[first[alike, np.newaxis] + np.arange(size)]
            low[alike], high[alike] = median_intervals(samples)
        return Spread(median, low, high, q1, q3)

    def _ascending(self, values: ArrayLike) -> tuple[Column, NDArray[np.int64]]:
        """Give the values that are known, by group and ascending in each, and how many it has."""
        ordered = np.asarray(values, dtype=np.float64)[self._order]
        known = ~np.isnan(ordered)
        sizes = np.bincount(self.of[self._order][known], minlength=self.count)
        ordered = ordered[known]
        for mine in _slices(sizes):
            ordered[mine].sort()
        return ordered, sizes


def _slices(sizes: NDArray[np.int64]) -> list[slice]:
    """Give the place of each group among values that stand by group."""
    ends = np.cumsum(sizes)
    return [slice(*pair) for pair in zip((ends - sizes).tolist(), ends.tolist(), strict=True)]


def _quantile(ascending: Column, sizes: NDArray[np.int64], level: float) -> Column:
    """Give a quantile of each group, between two values as `numpy.quantile` does."""
    found = np.full(len(sizes), np.nan)
    some = sizes > 0
    first = (np.cumsum(sizes) - sizes)[some]
    place = level * (sizes[some] - 1)
    below = np.floor(place).astype(np.int64)
    low = ascending[first + below]
    high = ascending[first + np.minimum(below + 1, sizes[some] - 1)]
    part, step = place - below, high - low
    found[some] = np.where(part < 0.5, low + part * step, high - (1 - part) * step)
    return found


def grouped(trials: pd.DataFrame, by: list[str]) -> tuple[pd.DataFrame, Groups]:
    """Put trials into groups by what stands in some columns.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.
    by : list of str
        The columns that name a group.

    Returns
    -------
    names : DataFrame
        The columns `by`, a row a group, sorted; text as such, also where trials hold categories.
    groups : Groups
        The group of each trial, by the row of its names.
    """
    grouping = trials.groupby(by, sort=True, observed=True)
    of = grouping.ngroup().to_numpy()
    names = grouping.size().index.to_frame(index=False)
    return plain(names), Groups(of, len(names))


def plain(frame: pd.DataFrame) -> pd.DataFrame:
    """Give a frame whose categories are what they stand for."""
    kinds = frame.dtypes.items()
    held = {name: kind for name, kind in kinds if isinstance(kind, pd.CategoricalDtype)}
    return frame.astype({name: kind.categories.dtype for name, kind in held.items()})
