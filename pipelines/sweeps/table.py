"""Trials of experiments that no other section is about, at a glance."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import pandas as pd

from gapath.driving.row import DriveRow
from gapath.pipelines.numbers.drive_summary import rate, summarise_drives
from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.numbers.summary import summarise, summarise_by
from gapath.pipelines.numbers.text import middle, number, percent, percent_range
from gapath.pipelines.page.section import ALL, Section, Table
from gapath.pipelines.papers.names import label
from gapath.store.records import RunRecord
from gapath.task import Row, Task, find_task
from gapath.tasks.plan import PlanRow

TASK = ALL
EXPERIMENT = None
ORDER = 90


class Overview(NamedTuple):
    """What a glance at the trials of a task shows."""

    name: str
    """Of its files."""
    title: str
    caption: str
    summarise: Callable[[pd.DataFrame], dict[str, float]]
    """Sums up the trials of a setting."""
    cells: Callable[[pd.Series], dict[str, str]]
    """Writes such a sum for people."""


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section:
    """Make the section that lists trials by experiment, map, its start and target, and method.

    Parameters
    ----------
    trials : DataFrame
        The trials of a task that no other section wants.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section
        A row for each experiment, map and method.
    """
    task = find_task(runs[0].known.task)
    method = task.groups[0]
    rich = (_OVERVIEWS[kind] for kind in task.row.__mro__ if kind in _OVERVIEWS)
    overview = next(rich, None) or plain_overview(task)
    by = ["experiment", "map", "map_source", "start", "target", method]
    rows = summarise_by(trials, by, overview.summarise)
    instances = trials.groupby(by)["map_instance"].nunique()
    rows.insert(len(by), "instances", [instances[tuple(row)] for row in rows[by].to_numpy()])
    shown = [
        {
            "Experiment": row["experiment"],
            "Map": label(row["map"], row["map_source"]),
            method.capitalize(): label(row[method]),
            "From, to": f"{row['start']} {row['target']}",
            "Instances": number(row["instances"]),
            **overview.cells(row),
        }
        for _, row in rows.iterrows()
    ]
    table = Table(overview.name, overview.caption, rows, pd.DataFrame(shown), heads=3)
    return Section(title=overview.title, tables=(table.with_runs(trials, by),))


def plain_overview(task: type[Task]) -> Overview:
    """Make the overview of a task of which nothing is known but that a trial succeeds or not.

    Parameters
    ----------
    task : type
        The task.

    Returns
    -------
    Overview
        How many trials succeeded.
    """

    def count(trials: pd.DataFrame) -> dict[str, float]:
        n, succeeded = len(trials), int(trials[task.success].sum())
        low, high = wilson(succeeded / n, n)
        named = {"success": succeeded / n, "success_low": low, "success_high": high}
        return {"n": n, "succeeded": succeeded, **named}

    return Overview(
        f"{task.name}_overview",
        f"Other trials: {task.name}",
        f"{task.success.capitalize()}: with the 95 % Wilson interval over trials.",
        count,
        lambda row: {
            "Trials": number(row["n"]),
            f"{task.success.capitalize()}, %": percent(row["success"]),
            "95 % interval": percent_range((row["success_low"], row["success_high"])),
        },
    )


def _plan_cells(row: pd.Series) -> dict[str, str]:
    return {
        "Trials": number(row["n"]),
        "Found, %": percent(row["success"]),
        "95 % interval": percent_range((row["success_low"], row["success_high"])),
        "Epochs": number(row["epochs_median"]),
        "Epochs, if found": number(row["found_epochs_median"]),
        "Time, ms": number(1000 * row["seconds_median"]),
        "Above optimal, %": number(100 * (row["optimality_ratio_median"] - 1)),
        # what authors print is rounded
        "Length above published, %": number(round(100 * (row["length_ratio_median"] - 1), 2) + 0),
    }


def _drive_cells(row: pd.Series) -> dict[str, str]:
    return {
        "Drives": number(row["n"]),
        "Reached, %": rate(row, "reached"),
        "Returned, %": rate(row, "returned"),
        "Overran, %": rate(row, "overran"),
        "Steps / shortest": middle(*(row[f"steps_ratio_{key}"] for key in ("median", "q1", "q3"))),
        "Time, ms": number(1000 * row["seconds_median"]),
    }


_OVERVIEWS: dict[type[Row], Overview] = {
    PlanRow: Overview(
        "overview",
        "Other trials",
        "Found: with the 95 % Wilson interval over trials; epochs of all trials and of those that "
        "found a path, time, and what the planner minimises (weights or octile length) above the "
        "least there is are medians, as is the octile length above what the map's author gives.",
        summarise,
        _plan_cells,
    ),
    DriveRow: Overview(
        "drives_overview",
        "Other drives",
        "How drives ended, with the 95 % Wilson interval over drives; median (quartiles) of "
        "steps / shortest where the target was reached, median computing time of all drives.",
        summarise_drives,
        _drive_cells,
    ),
}
"""Rows, and what is derived from them, of which more can be said than how many succeeded."""
