"""What a group of trials comes to: one row of a table."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pandas as pd

from gapath.pipelines.numbers.statistics import expected_running_time, median_interval, wilson
from gapath.pipelines.papers.names import rank


class Spread(NamedTuple):
    """Median, its 95 % bootstrap interval, and quartiles; NaN where there are no values."""

    median: float
    low: float
    high: float
    q1: float
    q3: float


def spread(values: pd.Series) -> Spread:
    """Describe how values spread.

    Parameters
    ----------
    values : Series of float
        In any unit; missing ones are left out.

    Returns
    -------
    Spread
        In the unit of the values.
    """
    known = values.dropna().to_numpy(dtype=float)
    if known.size == 0:
        return Spread(*[np.nan] * 5)
    q1, median, q3 = (float(value) for value in np.quantile(known, (0.25, 0.5, 0.75)))
    return Spread(median, *median_interval(known), q1, q3)


def summarise(trials: pd.DataFrame) -> dict[str, float]:
    """Summarise trials of one setting, failures included.

    Epochs, evaluations and seconds are those of all trials: a failed one counts with what
    it spent. The ratios exist only where a path does; epochs, evaluations and the
    interval of success only for a planner that draws random numbers. Else they are missing.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.

    Returns
    -------
    dict
        n, found, success and its interval; for epochs, found_epochs (those of trials that found
        a path), evaluations, seconds, optimality_ratio and length_ratio the fields of `Spread`;
        expected evaluations and seconds to a path.
    """
    n, found = len(trials), int(trials["feasible"].sum())
    rate = found / n if n else np.nan
    low, high = wilson(rate, n)
    spent = trials[["epochs", "evaluations"]].astype(float)
    if not spent.to_numpy().any():
        # A graph search has no epochs, rather than none, and does the same in each trial.
        spent[:] = low = high = np.nan
    row: dict[str, float] = {"n": n, "found": found}
    row |= {"success": rate, "success_low": low, "success_high": high}
    spent = spent.assign(seconds=trials["plan_time_s"])
    spent = spent.assign(found_epochs=spent["epochs"].where(trials["feasible"]))
    ratios = trials[["optimality_ratio", "length_ratio"]]
    for name, values in (*spent.items(), *ratios.items()):
        row |= {f"{name}_{key}": value for key, value in spread(values)._asdict().items()}
    for name in ("evaluations", "seconds"):
        row[f"ert_{name}"] = expected_running_time(spent[name].to_numpy(), trials["feasible"])
    return row


def summarise_by(
    trials: pd.DataFrame,
    by: list[str],
    summary: Callable[[pd.DataFrame], dict[str, float]] = summarise,
) -> pd.DataFrame:
    """Summarise each group of trials, in the papers' order.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.
    by : list of str
        The columns that name a group.
    summary : callable
        Summarises a group.

    Returns
    -------
    DataFrame
        The columns of `by`, then those of the summary.
    """
    rows = [
        {**dict(zip(by, key, strict=True)), **summary(group)}
        for key, group in trials.groupby(by, sort=True)
    ]
    rows.sort(key=lambda row: [rank(str(row[name])) for name in by])
    return pd.DataFrame(rows)


def over_instances(trials: pd.DataFrame, success: str, name: str) -> dict[str, float]:
    """Summarise the success of a method over the instances of a class of maps.

    Parameters
    ----------
    trials : DataFrame
        The trials of one method on the instances of one class.
    success : str
        The column that says whether a trial succeeded.
    name : str
        What the rate is called.

    Returns
    -------
    dict
        instances, n (trials), the rate, which is the mean of the instances' rates, and its
        interval, Wilson's counting instances; always and never, how many instances succeeded in
        all trials or in none.
    """
    rates = trials.groupby("map_instance")[success].mean()
    low, high = wilson(float(rates.mean()), len(rates))
    return {
        "instances": len(rates),
        "n": len(trials),
        name: float(rates.mean()),
        f"{name}_low": low,
        f"{name}_high": high,
        "always": int((rates == 1).sum()),
        "never": int((rates == 0).sum()),
    }
