"""What planners do on the problems of scenarios, by map and by length: trials and their sums."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from gapath.pipelines.numbers.grouped import Groups, grouped
from gapath.pipelines.numbers.summary import rates
from gapath.pipelines.numbers.text import NOTHING, number, percent, percent_range
from gapath.pipelines.papers.names import rank
from gapath.pipelines.reading.of_run import of_run
from gapath.running.naming import Method
from gapath.store.records import RunRecord
from gapath.task import metrics

FAMILIES = {
    "movingai": "MovingAI",
    "rosmap": "floors of robots",
    "barn": "BARN",
    "generated": "generated",
    "reconstructed": "KG18's classes (reconstructed)",
}
"""By the maps' source, what they are called."""

FIELD = "field"
"""The experiment of this room."""

SIZED = "generated"
"""The source of maps of any size, of which each is a family of its own."""

BUCKET = 4
"""Fields of length that a bucket stands for."""

EXACT = "astar"
"""YAML of the planner whose time the others' is held against."""

_PROBLEM = ["map", "map_instance", "start", "target"]

_CHOSEN = ("scenario.", "corner_cutting")
"""Beginnings of settings that say which problems are asked, not of whom."""


def asked(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> pd.DataFrame:
    """Give the trials that have a way, and what tells them apart.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, of a scenario.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    DataFrame
        Without problems that no planner can solve, with the columns `family`; `place`, the map and
        its instance; `method`, the planner without what says which problems it was asked;
        `problem`; `cost_ratio`, the cost of what was found over the least; `length_from` and
        `length_to`, the band of lengths in fields, each twice as wide as the one before.
    """
    method = of_run(trials, runs, _method)
    instance = trials["map_instance"].astype("str").radd(" #").where(trials["map_instance"] > 0, "")
    least = trials["optimal_cost"].to_numpy()
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(trials["feasible"] & (least > 0), trials["cost"] / least, np.nan)
    bucket = np.maximum(trials["bucket"].to_numpy(), 0)
    band = np.ceil(np.log2(bucket + 1)).astype(np.int64)  # 0, 1, 2 to 3, 4 to 7, ...
    begin, end = 2**band // 2, 2**band
    source = trials["map_source"].astype("str")
    size = ", " + trials["width"].astype("str") + " x " + trials["height"].astype("str")
    table = trials.assign(
        family=source.replace(FAMILIES) + size.where(source == SIZED, ""),
        place=trials["map"].astype("str") + instance,
        method=method,
        problem=trials.groupby(_PROBLEM, observed=True).ngroup(),
        cost_ratio=ratio,
        length_from=BUCKET * begin,
        length_to=BUCKET * end,
    )
    return table[np.isfinite(least)]


def named(trials: pd.DataFrame, title: str, file: str) -> tuple[str, str]:
    """Give a title and the beginning of files' names that no other experiment has."""
    experiment = trials["experiment"].iloc[0]
    if experiment == FIELD:
        return title, f"field_{file}"
    return f"{title}: {experiment}", f"field_{experiment}_{file}"


def without_a_way(trials: pd.DataFrame) -> str:
    """Say how many problems no planner can solve, and that they are left out."""
    none = trials[~np.isfinite(trials["optimal_cost"])]
    count = len(none[_PROBLEM].drop_duplicates())
    if not count:
        return "All problems have a way."
    return f"Problems without any way: {number(count)}; they are left out."


def _method(run: RunRecord) -> str:
    changes = {k: v for k, v in run.known.changes.items() if not k.startswith(_CHOSEN)}
    return Method(run.known.preset, changes).name


def summarised(trials: pd.DataFrame, by: list[str]) -> pd.DataFrame:
    """Sum up each planner's trials within groups, failures included.

    Parameters
    ----------
    trials : DataFrame
        As `asked` gives them.
    by : list of str
        Columns that name a group.

    Returns
    -------
    DataFrame
        A row a group and planner: `by`, method; problems, n; success with its 95 % Wilson interval;
        mean, median, 99th percentile and maximum of cost_ratio, of paths found; median and total of
        seconds, of all trials; times_exact, how many times their mean goes into A*'s on the same
        group; medians of expansions and evaluations, of the metrics of paths found,
        and of length_ratio.
    """
    names, groups = grouped(trials, [*by, "method"])
    rows = names.assign(**_sums(trials, groups))
    rows["times_exact"] = _times_exact(rows, by)
    places = [rank(name) for name in rows["method"]]
    numeric = {name: rows[name] if rows[name].dtype != object else rows[name].astype(str)
               for name in by}  # fmt: skip
    order = rows.assign(**numeric, _rank=places).sort_values([*by, "_rank"], kind="stable").index
    return rows.loc[order].reset_index(drop=True)


def _sums(trials: pd.DataFrame, groups: Groups) -> dict[str, Any]:
    def of(name: str) -> Any:
        values = pd.Series(trials[name].to_numpy(dtype=np.float64))
        return values.groupby(groups.of)

    ratio, seconds = of("cost_ratio"), of("plan_time_s")
    medians = ("length_ratio", "expansions", "evaluations", *metrics())
    return {
        "problems": groups.distinct(trials["problem"]),
        "n": groups.sizes,
        **rates("success", groups.counts(trials["feasible"]), groups.sizes),
        "ratio_mean": ratio.mean(),
        "ratio_median": ratio.median(),
        "ratio_p99": ratio.quantile(0.99),
        "ratio_max": ratio.max(),
        "seconds_median": seconds.median(),
        "seconds_mean": seconds.mean(),
        "seconds_total": seconds.sum(),
        **{f"{name}_median": of(name).median() for name in medians},
    }


def _times_exact(rows: pd.DataFrame, by: list[str]) -> list[float]:
    exact = rows[rows["method"] == EXACT]
    taken = dict(
        zip(exact[by].itertuples(index=False, name=None), exact["seconds_mean"], strict=True)
    )
    keys = rows[by].itertuples(index=False, name=None)
    return [
        taken.get(key, np.nan) / mean for key, mean in zip(keys, rows["seconds_mean"], strict=True)
    ]


class Column(NamedTuple):
    """A column for people."""

    title: str
    name: str
    scale: float = 1.0


EFFORT = (
    Column("Time, ms", "seconds_median", 1000.0),
    Column("Time in all, s", "seconds_total"),
    Column("A*'s / its", "times_exact"),
    Column("Expansions", "expansions_median"),
    Column("Evaluations", "evaluations_median"),
)


def cells(row: Mapping[Any, Any], more: Sequence[Column] = ()) -> dict[str, str]:
    """Write what a row of `summarised` comes to."""
    shown = {
        "Problems": number(row["problems"]),
        "Trials": number(row["n"]),
        "Found, %": percent(row["success"]),
        "95 % interval": percent_range((row["success_low"], row["success_high"])),
    }
    ratios = {"mean": "mean", "median": "median", "99 %": "p99", "most": "max"}
    for title, name in ratios.items():
        shown[f"Cost / least: {title}"] = ratio_text(row[f"ratio_{name}"])
    for column in (*EFFORT, *more):
        value = row[column.name] * column.scale
        # a graph search evaluates nothing, a genetic algorithm expands nothing
        none = column.name in ("expansions_median", "evaluations_median") and value == 0
        shown[column.title] = NOTHING if none or np.isnan(value) else number(value)
    return shown


def ratio_text(value: float) -> str:
    """Write a ratio that is nearly 1 with four digits behind the point."""
    return NOTHING if np.isnan(value) else f"{value:.4f}"
