"""Drives of experiments that no other section is about, at a glance."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.numbers.drive_summary import rate, summarise_drives_by
from gapath.pipelines.numbers.text import middle, number
from gapath.pipelines.page.section import Section, Table
from gapath.pipelines.papers.names import label
from gapath.pipelines.reading.runs import Run

TASK = "drive"
EXPERIMENT = None
ORDER = 91


def section(trials: pd.DataFrame, runs: Sequence[Run]) -> Section:
    """Make the section that lists drives by experiment, map and navigator.

    Parameters
    ----------
    trials : DataFrame
        The drives that no other section wants.
    runs : sequence of Run
        The runs they come from.

    Returns
    -------
    Section
        A row for each experiment, map and navigator.
    """
    by = ["experiment", "map", "map_source", "start", "target", "navigator"]
    rows = summarise_drives_by(trials, by)
    instances = trials.groupby(by)["map_instance"].nunique()
    rows.insert(len(by), "instances", [instances[tuple(row)] for row in rows[by].to_numpy()])
    shown = [
        {
            "Experiment": row["experiment"],
            "Map": label(row["map"], row["map_source"]),
            "Navigator": label(row["navigator"]),
            "From, to": f"{row['start']} {row['target']}",
            "Instances": number(row["instances"]),
            "Drives": number(row["n"]),
            "Reached, %": rate(row, "reached"),
            "Returned, %": rate(row, "returned"),
            "Overran, %": rate(row, "overran"),
            "Steps / shortest": middle(
                row["steps_ratio_median"], row["steps_ratio_q1"], row["steps_ratio_q3"]
            ),
            "Time, ms": number(1000 * row["seconds_median"]),
        }
        for _, row in rows.iterrows()
    ]
    table = Table(
        "drives_overview",
        "How drives ended, with the 95 % Wilson interval over drives; median (quartiles) of "
        "steps / shortest where the target was reached, median computing time of all drives.",
        rows,
        pd.DataFrame(shown),
        heads=3,
    )
    return Section(title="Other drives", tables=(table,))
