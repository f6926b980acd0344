"""Many problems on a map, map by map: the same numbers, and what the paths are like."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.field.problems import FIELD, Column, asked, cells, named, summarised
from gapath.pipelines.page.section import Section, Table
from gapath.pipelines.papers.names import label
from gapath.store.records import RunRecord

TASK = "scenario"
EXPERIMENT = FIELD
ORDER = 99

_LIKE = (
    Column("Length / published", "length_ratio_median"),
    Column("AOL, rad / field", "angle_over_length_median"),
    Column("Curvature, rad / field", "curvature_median"),
    Column("Turns", "turns_median"),
    Column("Clearance, fields", "clearance_median"),
)


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Make the table of maps.

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
    by = ["family", "place"]
    rows = summarised(known, by)
    shown = [
        {
            "Maps": row["family"],
            "Map": label(row["place"]),
            "Planner": label(row["method"]),
            **cells(row, _LIKE),
        }
        for row in rows.to_dict("records")
    ]
    title, name = named(trials, "Many problems on a map, map by map", "maps")
    table = Table(
        name,
        "Map by map, as in the table by length; MovingAI's: Sturtevant 2012. What the paths are "
        "like, medians of those found: octile length over the published one; angle over length, "
        "the turns of a path's straight lines over their length (of its steps, where it is not "
        "made of lines); the same and the number of turns field by field; least distance to an "
        "obstacle.",
        rows,
        pd.DataFrame(shown),
        heads=3,
    ).with_runs(known, [*by, "method"])
    return Section(title=title, tables=(table,))
