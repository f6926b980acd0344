"""What groups are expected to spend until a success, and by how much that differs."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gapath.pipelines.numbers.comparing.groups import Table
from gapath.pipelines.numbers.comparing.pairwise import Difference
from gapath.pipelines.numbers.statistics import expected_running_time

FEWEST = 10
"""Successes of a group below which its resamples are too wild for an interval."""

_RESAMPLES, _PARTS = 1000, 2000

_TOO_FEW = "too few that spend anything"


@dataclass(frozen=True)
class Expected:
    """Expected amounts of groups, with those of resampled blocks.

    Parameters
    ----------
    values : (groups,) float64
        `expected_running_time` of each; infinite without a success.
    successes : (groups,) int64
        How many trials of each succeeded.
    logs : (resamples, groups) float64
        Logarithms of the same of blocks that were drawn with replacement, the same blocks for all
        groups, so that pairs stay pairs; NaN of groups with fewer than `FEWEST` successes, or
        with resamples that spend nothing.
    """

    values: NDArray[np.float64]
    successes: NDArray[np.int64]
    logs: NDArray[np.float64]

    def estimate(self, at: int) -> tuple[float | None, float | None, float | None, str]:
        """Give a group's expected amount, its 95 % bootstrap interval, and what is missing."""
        successes = int(self.successes[at])
        if not successes:
            return None, None, None, "no trial succeeded"
        value = float(self.values[at])
        if successes < FEWEST:
            return value, None, None, f"{successes} successes, too few for an interval"
        if self._unknown(at):
            return value, None, None, f"{_TOO_FEW} for an interval"
        low, high = np.exp(np.quantile(self.logs[:, at], (0.025, 0.975)))
        return value, float(low), float(high), ""

    def differences(
        self, pairs: Sequence[tuple[int, int]], shown: Sequence[bool]
    ) -> Iterator[Difference]:
        """Compare pairs of groups that have succeeded.

        Parameters
        ----------
        pairs : sequence of (int, int)
            The groups.
        shown : sequence of bool
            Of which pairs to give the interval, too.

        Yields
        ------
        Difference
            The ratio of both with its bootstrap interval, and a test: the logarithm of the ratio
            over its standard error among the resamples is normal (Efron and Tibshirani 1993).
        """
        from scipy.special import ndtr

        spread = np.atleast_2d(np.cov(self.logs, rowvar=False))
        for (i, j), sized in zip(pairs, shown, strict=True):
            known = min(self.values[i], self.values[j]) > 0
            effect = float(self.values[i] / self.values[j]) if known else None
            result = Difference("bootstrap", effect=effect)
            fewest = int(min(self.successes[i], self.successes[j]))
            if fewest < FEWEST:
                yield result._replace(why=f"{fewest} successes, too few for a test")
                continue
            if effect is None or self._unknown(i) or self._unknown(j):
                yield result._replace(why=f"{_TOO_FEW} for a test")
                continue
            if sized:
                ratios = self.logs[:, i] - self.logs[:, j]
                low, high = np.exp(np.quantile(ratios, (0.025, 0.975)))
                result = result._replace(low=float(low), high=float(high))
            square = float(spread[i, i] + spread[j, j] - 2 * spread[i, j])
            if square < 1e-20:  # the same in each resample
                yield result._replace(p=1.0 if math.isclose(effect, 1) else 0.0)
                continue
            z = abs(math.log(effect)) / math.sqrt(square)
            yield result._replace(p=2 * float(ndtr(-z)))

    def _unknown(self, at: int) -> bool:
        return bool(np.isnan(self.logs[:, at]).any())


def expected(spent: Table, success: Table) -> Expected:
    """Give expected amounts of groups, and those of resampled blocks.

    Parameters
    ----------
    spent : (blocks, groups) float64
        What each trial spent; NaN where there is none.
    success : (blocks, groups) float64
        1 where it succeeded, else 0; NaN where there is none.

    Returns
    -------
    Expected
        Of more than 2000 blocks, that many batches of blocks are drawn instead.
    """
    spent, success = np.nan_to_num(spent), np.nan_to_num(success)
    values = [
        expected_running_time(column, found)
        for column, found in zip(spent.T, success.T, strict=True)
    ]
    successes = success.sum(axis=0).astype(np.int64)
    random = np.random.Generator(np.random.SFC64(0))
    if len(spent) > _PARTS:
        batch = random.permutation(len(spent)) % _PARTS
        spent, success = (_batches(table, batch) for table in (spent, success))
    parts = len(spent)
    weights = random.multinomial(parts, np.full(parts, 1 / parts), size=_RESAMPLES).astype(float)
    sums, counts = weights @ spent, weights @ success
    logs = np.full_like(sums, np.nan)
    known = (successes >= FEWEST) & (sums > 0).all(axis=0)
    logs[:, known] = np.log(sums[:, known]) - np.log(np.maximum(counts[:, known], 1))
    return Expected(np.array(values), successes, logs)


def _batches(table: Table, batch: NDArray[np.int64]) -> Table:
    columns = [np.bincount(batch, column, _PARTS) for column in table.T]
    return np.stack(columns, axis=1)
