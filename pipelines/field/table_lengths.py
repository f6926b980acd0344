"""Many problems on a map, by length: what each planner finds, at which cost, in which time."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.field.problems import (
    FIELD,
    asked,
    cells,
    named,
    summarised,
    without_a_way,
)
from gapath.pipelines.numbers.behind import keys_behind
from gapath.pipelines.numbers.text import number
from gapath.pipelines.page.section import Section, Table
from gapath.pipelines.papers.names import label
from gapath.store.records import RunRecord

TASK = "scenario"
EXPERIMENT = FIELD
ORDER = 97


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Make the table by length.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section or None
        None if no problem has a way.
    """
    known = asked(trials, runs)
    if known.empty:
        return None
    title, name = named(trials, "Many problems on a map, by length", "lengths")
    return Section(
        title=title,
        text=(
            "Whole scenarios, every problem once or several times: MovingAI's benchmarks "
            "(Sturtevant 2012, maps and scenarios ODC-BY) as their files list them, other maps "
            "with problems drawn from all pairs of fields that a path joins.",
        ),
        tables=(_table(known, name),),
        remarks=(
            f"{without_a_way(trials)} A trial without a path is a failure, and its time counts.",
            "The interval counts problems as if they were drawn by lot; those on one map are "
            "alike, so it errs on the narrow side.",
            "Planners that seek the shortest way by another measure than KG18's eq. (5) pay for it "
            "in cost, and are no worse by their own.",
        ),
    )


def _table(trials: pd.DataFrame, name: str) -> Table:
    by = ["family", "length_from", "length_to"]
    rows = summarised(trials, by)
    shown = [
        {
            "Maps": row["family"],
            "Length": f"{number(row['length_from'])} to {number(row['length_to'])}",
            "Planner": label(row["method"]),
            **cells(row),
        }
        for row in rows.to_dict("records")
    ]
    return Table(
        name,
        "By the length of the shortest path, in fields, as MovingAI's buckets have it (for drawn "
        "problems that of the cheapest path): found, of problems with a way, with the 95 % Wilson "
        "interval over trials; cost (KG18 eq. (5)) over the least, of paths found: mean, median, "
        "99th percentile, most; time of the planner's call alone: median, in all, failures "
        "included, and how many times it goes into A*'s; fields expanded, or chromosomes and "
        "paths evaluated, medians. The memetic planner's time to its first path, made short, is "
        "the row of memetic_first, which stops there.",
        rows,
        pd.DataFrame(shown),
        heads=3,
        runs=keys_behind(trials, ["family", "method"], rows),
    )
