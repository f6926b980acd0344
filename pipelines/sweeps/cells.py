"""What the trials of each map and method come to, all at once: a row a cell."""

from statistics import NormalDist
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from gapath.pipelines.numbers.grouped import Groups
from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.sweeps.measures import Effort, Measures, Values, chance

Index = NDArray[np.int64]

_Z = NormalDist().inv_cdf(0.975)


class Cells(NamedTuple):
    """Trials by cell."""

    table: pd.DataFrame
    """A row a cell, see `summarise_cells`."""
    trials: pd.DataFrame
    """The trials, with `cell`, the number of their row, and `problem`, a number too."""


def summarise_cells(trials: pd.DataFrame, cases: pd.DataFrame, measures: Measures) -> Cells:
    """Sum up the trials of each map and method, over its problems and seeds, failures included.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.
    cases : DataFrame
        As `varied.cases_of` gives them.
    measures : Measures
        What is measured.

    Returns
    -------
    Cells
        Columns of its table: place, method, runs (the keys), problems, once and always (how many
        of them were solved in some trial, and in all), n, succeeded, success with its interval;
        for each effort the quartiles, and what is expected until a success with its interval,
        see `expected`; quartiles of each middle, the rate of each share.
    """
    pairs = cases.groupby(["place", "method"], sort=False)
    table = pairs.size().index.to_frame(index=False)
    keys = pd.Series(cases.index, index=cases.index)
    table["runs"] = [tuple(sorted(mine)) for _, mine in keys.groupby(pairs.ngroup())]
    run = cases.index.get_indexer(pd.Index(trials["key"]))
    cell = pairs.ngroup().to_numpy()[run]
    place = pd.factorize(cases["place"])[0][run]
    problem = _numbered(place, *(trials[name] for name in ("map_instance", "start", "target")))
    trials = trials.assign(cell=cell, problem=problem)
    count = len(table)
    success = trials[measures.success].to_numpy(dtype=np.float64)
    table = table.join(_by_problem(cell, problem, success, count))
    table["n"] = np.bincount(cell, minlength=count)
    table["succeeded"] = np.bincount(cell, success, count).astype(np.int64)
    table["success"] = table["succeeded"] / table["n"]
    low, high = wilson_of(table["success"].to_numpy(), table["n"].to_numpy())
    known = _by_chance(trials, count)
    table["success_low"], table["success_high"] = np.where(known, (low, high), np.nan)
    columns: dict[str, Values] = {}
    groups = Groups(cell, count)
    for effort in measures.efforts:
        spent = effort.read(trials)
        columns |= _quartiles(effort.name, spent, groups)
        columns |= expected(effort, spent, success, (cell, count))
    for middle in measures.middles:
        columns |= _quartiles(middle.name, middle.read(trials), groups)
    for share in measures.shares:
        columns[share.name] = np.bincount(cell, share.read(trials), count) / table["n"].to_numpy()
    return Cells(table.assign(**columns), trials)


def _numbered(*columns: ArrayLike) -> Index:
    """Give rows that are equal in all columns one number."""
    number = np.zeros(len(np.asarray(columns[0])), dtype=np.int64)
    for column in columns:
        codes, levels = pd.factorize(column)
        number = pd.factorize(number * max(len(levels), 1) + codes)[0]
    return number


def _by_problem(cell: Index, problem: Index, success: Values, count: int) -> pd.DataFrame:
    pair, place = np.unique(cell * (problem.max() + 1) + problem, return_inverse=True)
    owner = pair // (problem.max() + 1)
    tried, solved = np.bincount(place), np.bincount(place, success)
    return pd.DataFrame(
        {
            "problems": np.bincount(owner, minlength=count),
            "once": np.bincount(owner[solved > 0], minlength=count),
            "always": np.bincount(owner[solved == tried], minlength=count),
        }
    )


def _by_chance(trials: pd.DataFrame, count: int) -> NDArray[np.bool_]:
    """Tell which cells' trials differ by chance: an exact method does the same in each."""
    drawn = chance(trials)
    known = np.bincount(trials["cell"], drawn, count) > 0
    others = trials[~known[trials["cell"].to_numpy()]]
    if len(others):
        costs = others.groupby(["cell", "problem"])["cost"].agg(["min", "max"])
        differ = costs.index.get_level_values("cell")[costs["min"] < costs["max"]]
        known[differ] = True
    return known


def wilson_of(rates: Values, n: Values) -> tuple[Values, Values]:
    """Give `statistics.wilson` of many rates at once."""
    ends = [wilson(*each) for each in zip(rates.tolist(), n.tolist(), strict=True)]
    low, high = np.array(ends, dtype=np.float64).reshape(-1, 2).T
    return low, high


def expected(
    effort: Effort, spent: Values, success: Values, groups: tuple[Index, int]
) -> dict[str, Values]:
    """Give what is expected to be spent until a success, if a failed trial is tried again.

    The sum of what all trials spent over the number of successes (Hansen et al., COCO). Its 95 %
    interval is by the delta method on its logarithm: that of a ratio of two means of the same
    trials. Without a success it is infinite, and the interval's lower end is the mean over the
    upper end of the success rate's Wilson interval.

    Parameters
    ----------
    effort : Effort
        What is spent.
    spent : (n,) float64
        By trial; NaN where nothing is known.
    success : (n,) float64
        1 or 0.
    groups : ((n,) int64, int)
        Each trial's group, and how many there are.

    Returns
    -------
    dict
        ``expected_<name>``, ``..._low`` and ``..._high``, and ``<name>_total``, what all trials
        spent, a value a group; NaN where nothing is known.
    """
    known = ~np.isnan(spent)
    s, x, group = spent[known], success[known], groups[0][known]

    def mean(values: Values) -> Values:
        return np.bincount(group, values, groups[1]) / n

    with np.errstate(divide="ignore", invalid="ignore"):
        n = np.bincount(group, minlength=groups[1]).astype(np.float64)
        amount, rate = mean(s), mean(x)
        ratio = amount / rate
        # The residual's square, written out, would lose its digits where success is rare.
        error = mean((s - ratio[group] * x) ** 2) / np.maximum(n - 1, 1)
        width = np.exp(_Z * np.sqrt(error) / amount)
        never = rate == 0
        least = amount / wilson_of(rate, n)[1]
    low, high = np.where(never, least, ratio / width), np.where(never, np.inf, ratio * width)
    one = n < 2
    low, high = (np.where(one & ~never, np.nan, end) for end in (low, high))
    values = np.where(never, np.inf, ratio), low, high
    name = f"expected_{effort.name}"
    ends = (name, f"{name}_low", f"{name}_high", f"{effort.name}_total")
    found = zip(ends, (*values, amount * n), strict=True)
    return {key: np.where(n > 0, each, np.nan) for key, each in found}


def _quartiles(name: str, values: Values, groups: Groups) -> dict[str, Values]:
    found = groups.quartiles(values)
    return {f"{name}_{key}": getattr(found, key) for key in ("median", "q1", "q3")}
