"""How often a single bend is enough: a section of the report."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.numbers.text import number, percent
from gapath.pipelines.page.section import Section, Table
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "bends"
ORDER = 99


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section:
    """Make the section: a row for each map and number of tries, which is a setting."""
    tries = {run.folder.name: run.settings["planner.tries"] for run in runs}
    rates = trials.assign(tries=trials["key"].map(tries)).groupby(["map", "tries"])["feasible"]
    rows = rates.agg(n="size", found="mean").reset_index()
    shown = pd.DataFrame({
        "Map": rows["map"],
        "Tries": rows["tries"].map(number),
        "Trials": rows["n"].map(number),
        "Found, %": rows["found"].map(percent),
    })  # fmt: skip
    return Section("One bend", tables=(Table("bends", "Share of paths found.", rows, shown),))
