"""Trials of experiments that no other section is about, at a glance."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.numbers.summary import summarise_by
from gapath.pipelines.numbers.text import number, percent, percent_range
from gapath.pipelines.page.section import Section, Table
from gapath.pipelines.papers.names import label
from gapath.pipelines.reading.runs import Run

TASK = "plan"
EXPERIMENT = None
ORDER = 90


def section(trials: pd.DataFrame, runs: Sequence[Run]) -> Section:
    """Make the section that lists trials by experiment, map, its start and target, and planner.

    Parameters
    ----------
    trials : DataFrame
        The trials that no other section wants.
    runs : sequence of Run
        The runs they come from.

    Returns
    -------
    Section
        A row for each experiment, map and planner.
    """
    by = ["experiment", "map", "map_source", "start", "target", "planner"]
    rows = summarise_by(trials, by)
    instances = trials.groupby(by)["map_instance"].nunique()
    rows.insert(len(by), "instances", [instances[tuple(row)] for row in rows[by].to_numpy()])
    shown = [
        {
            "Experiment": row["experiment"],
            "Map": label(row["map"], row["map_source"]),
            "Planner": label(row["planner"]),
            "From, to": f"{row['start']} {row['target']}",
            "Instances": number(row["instances"]),
            "Trials": number(row["n"]),
            "Found, %": percent(row["success"]),
            "95 % interval": percent_range((row["success_low"], row["success_high"])),
            "Epochs": number(row["epochs_median"]),
            "Time, ms": number(1000 * row["seconds_median"]),
            "Cost above optimal, %": number(100 * (row["optimality_ratio_median"] - 1)),
        }
        for _, row in rows.iterrows()
    ]
    table = Table(
        "overview",
        "Found: with the 95 % Wilson interval over trials; epochs, time and cost "
        "against the optimal one are medians.",
        rows,
        pd.DataFrame(shown),
        heads=3,
    )
    return Section(title="Other trials", tables=(table,))
