"""What groups of runs come to: their trials pooled, from the sums that each run keeps."""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gapath.pipelines.numbers.statistics import wilson
from gapath.store.results import EVALUATIONS, SECONDS, Results, exact_sum

SPENT = (EVALUATIONS, *SECONDS)
"""What a trial spends."""

FIGURES = ("runs", "trials", "success", "success_low", "success_high", "expected_evaluations",
           "expected_seconds")  # fmt: skip
"""Columns of every table of groups."""


def grouped(frame: pd.DataFrame, came: Sequence[Results], by: Sequence[str]) -> pd.DataFrame:
    """Pool the trials of runs that have something in common.

    Parameters
    ----------
    frame : DataFrame
        Runs that count, a row each.
    came : sequence of Results
        What each of them came to.
    by : sequence of str
        Columns of the frame.

    Returns
    -------
    DataFrame
        A row for each combination of values, in their order, with them; runs, trials; success,
        the share of trials that succeeded, and the ends of its 95 % interval (Wilson);
        and what `Results.figures` gives. A method that draws no random numbers has no interval.
    """
    number = frame.groupby(list(by), dropna=False, sort=True).ngroup().to_numpy()
    order = np.argsort(number, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(number[order])) + 1) if len(order) else []
    trials = np.array([each.trials for each in came])
    succeeded = np.array([each.succeeded for each in came])
    names, sums, counts = _tables(came, trials)
    rows = []
    for group in groups:
        total = {name: exact_sum(sums[group, i]) for i, name in enumerate(names)}
        count = dict(zip(names, counts[group].sum(axis=0).tolist(), strict=True))
        n, found = int(trials[group].sum()), int(succeeded[group].sum())
        pool = Results(n, found, total, count)
        low, high = wilson(found / n, n) if pool.drawn else (math.nan, math.nan)
        ends = {"success_low": low, "success_high": high}
        rows.append(pool.figures() | {"runs": len(group), "trials": n} | ends)
    keys = frame[list(by)].iloc[[group[0] for group in groups]].reset_index(drop=True)
    columns = dict.fromkeys([*FIGURES, *names])
    return keys.join(pd.DataFrame(rows, columns=[name for name in columns if name not in by]))


def _tables(
    came: Sequence[Results], trials: NDArray[np.int64]
) -> tuple[list[str], NDArray[np.float64], NDArray[np.int64]]:
    """Give the columns of trials, and of each run a row of sums and of how many are defined."""
    alike: dict[tuple[str, ...], list[int]] = {}
    for i, each in enumerate(came):
        alike.setdefault(tuple(each.sums), []).append(i)
    place = {name: i for i, name in enumerate(dict.fromkeys(name for key in alike for name in key))}
    sums = np.zeros((len(came), len(place)))
    counts = np.zeros(sums.shape, dtype=np.int64)
    for key, runs in alike.items():
        cells = np.ix_(runs, [place[name] for name in key])
        sums[cells] = [list(came[i].sums.values()) for i in runs]
        counts[cells] = trials[runs, None]
    for i, each in enumerate(came):
        for name, defined in each.counts.items():
            counts[i, place[name]] = defined
    return list(place), sums, counts
