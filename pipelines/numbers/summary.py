"""What groups of trials come to: rows of a table."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from gapath.pipelines.numbers.grouped import Groups, grouped
from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.papers.names import rank

Summary = Callable[[pd.DataFrame, Groups], Mapping[str, Any]]
"""Sums up trials: gives columns with a value a group."""


def summarise(trials: pd.DataFrame, groups: Groups) -> dict[str, Any]:
    """Summarise trials of some settings, failures included.

    Epochs, evaluations and seconds are those of all trials: a failed one counts with what
    it spent. The ratios exist only where a path does; epochs, evaluations and the
    interval of success only for a planner that draws random numbers. Else they are missing.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.
    groups : Groups
        The setting of each.

    Returns
    -------
    dict
        n, found, success and its interval; for epochs, found_epochs (those of trials that found
        a path), evaluations, seconds, optimality_ratio and length_ratio the fields of `Spread`;
        expected evaluations and seconds to a path. A value a group each.
    """
    feasible = trials["feasible"].to_numpy(dtype=np.bool_)
    n, found = groups.sizes, groups.counts(feasible)
    spent = {name: trials[name].to_numpy(dtype=np.float64) for name in ("epochs", "evaluations")}
    # A graph search has no epochs, rather than none, and does the same in each trial.
    drawn = groups.counts((spent["epochs"] != 0) | (spent["evaluations"] != 0)) > 0
    known = drawn[groups.of]
    spent = {name: np.where(known, values, np.nan) for name, values in spent.items()}
    spent["seconds"] = trials["plan_time_s"].to_numpy()
    spent["found_epochs"] = np.where(feasible, spent["epochs"], np.nan)
    row: dict[str, Any] = {"n": n, "found": found, **rates("success", found, n)}
    row["success_low"], row["success_high"] = (
        np.where(drawn, row[name], np.nan) for name in ("success_low", "success_high")
    )
    ratios = {name: trials[name] for name in ("optimality_ratio", "length_ratio")}
    for name, values in (spent | ratios).items():
        row |= {f"{name}_{key}": each for key, each in groups.spreads(values)._asdict().items()}
    for name in ("evaluations", "seconds"):
        row[f"ert_{name}"] = expected(groups.sums(spent[name]), found)
    return row


def expected(spent: Any, successes: Any) -> Any:
    """Give `statistics.expected_running_time` of groups: what each spent, for each success."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(successes > 0, spent / successes, np.inf)


def rates(name: str, successes: Any, n: Any, units: Any = None) -> dict[str, Any]:
    """Give rates of groups with the 95 % Wilson interval.

    Parameters
    ----------
    name : str
        What the rate is called.
    successes, n : (groups,) float
        How many there were, of how many.
    units : (groups,) int, optional
        How many of them are independent, `n` by default.

    Returns
    -------
    dict
        The rate under its name, and with _low and _high.
    """
    rate = successes / n
    units = n if units is None else units
    ends = [wilson(each, int(count)) for each, count in zip(rate, units, strict=True)]
    low, high = np.array(ends).reshape(-1, 2).T
    return {name: rate, f"{name}_low": low, f"{name}_high": high}


def summarise_by(trials: pd.DataFrame, by: list[str], summary: Summary = summarise) -> pd.DataFrame:
    """Summarise each group of trials, in the papers' order.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.
    by : list of str
        The columns that name a group.
    summary : callable
        Summarises groups.

    Returns
    -------
    DataFrame
        The columns of `by`, then those of the summary.
    """
    names, groups = grouped(trials, by)
    ranks = [[rank(str(cell)) for cell in row] for row in names.itertuples(index=False)]
    order = sorted(range(len(names)), key=ranks.__getitem__)
    rows = names.assign(**summary(trials, groups))
    return rows.iloc[order].reset_index(drop=True)


def over_instances(trials: pd.DataFrame, groups: Groups, success: str, name: str) -> dict[str, Any]:
    """Summarise the success of methods over the instances of a class of maps.

    Parameters
    ----------
    trials : DataFrame
        The trials of methods on the instances of classes.
    groups : Groups
        The method and class of each.
    success : str
        The column that says whether a trial succeeded.
    name : str
        What the rate is called.

    Returns
    -------
    dict
        instances, n (trials), the rate, which is the mean of the instances' rates, and its
        interval, Wilson's counting instances; always and never, how many instances succeeded in
        all trials or in none. A value a group each.
    """
    of, rate = rates_within(trials[success], groups, trials["map_instance"])
    instances = of.sizes
    return {
        "instances": instances,
        "n": groups.sizes,
        **rates(name, of.sums(rate), instances),
        "always": of.counts(rate == 1),
        "never": of.counts(rate == 0),
    }


def rates_within(flags: pd.Series, groups: Groups, unit: pd.Series) -> tuple[Groups, Any]:
    """Give the rate of each unit within each group, such as an instance of a class.

    Parameters
    ----------
    flags : Series of bool
        Whether a trial succeeded.
    groups : Groups
        The group of each trial.
    unit : Series
        Its unit.

    Returns
    -------
    groups : Groups
        The group of each unit.
    rates : (units,) float64
        The share of its trials that succeeded.
    """
    rate = flags.groupby([groups.of, unit], observed=True).mean()
    of = rate.index.get_level_values(0).to_numpy()
    return Groups(of, groups.count), rate.to_numpy(dtype=np.float64)
