"""KG18 Table 1: known maps, the paper's three executions beside ours."""

from collections.abc import Callable, Sequence

import pandas as pd

from gapath.pipelines.numbers.grouped import Spread
from gapath.pipelines.numbers.summary import summarise_by
from gapath.pipelines.numbers.text import NOTHING, middle, number, percent, percent_range, span
from gapath.pipelines.page.section import RECONSTRUCTED, Section, Table
from gapath.pipelines.papers.kg18 import SECONDS, found_seconds, implied_epochs
from gapath.pipelines.papers.names import label
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "table1"
ORDER = 10

_EFFORT: dict[str, tuple[str, Callable[[float], float]]] = {
    "evaluations": ("Evaluations", lambda count: count),
    "seconds": ("Time, ms", lambda seconds: 1000 * seconds),
    "optimality_ratio": ("Above optimal, %", lambda ratio: 100 * (ratio - 1)),
}
"""The column of each quantity, and its number there."""


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Make the section of KG18 Table 1.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section or None
        Success and epochs beside the paper's, and what a path costs; None of other instances.
    """
    canonical = trials[trials["map_instance"] == 0]
    if canonical.empty:
        return None
    by = ["map", "map_source", "planner"]
    rows = summarise_by(canonical, by)
    tables = _beside_the_paper(rows), _effort(rows)
    return Section(
        title="KG18 Table 1: known maps",
        text=(
            "A genetic algorithm plans on a map it knows, from a start at the left to a target at "
            "the right. GA 1 has a population of 40 and 4 control points, GA 2 of 100 and 4, GA 3 "
            "of 100 and 5; each stops at its first feasible path, or after 500 epochs.",
            RECONSTRUCTED,
        ),
        tables=tuple(table.with_runs(canonical, by) for table in tables),
        remarks=_remarks(rows),
    )


def _names(row: pd.Series) -> dict[str, str]:
    return {"Map": label(row["map"], row["map_source"]), "Planner": label(row["planner"])}


def _beside_the_paper(rows: pd.DataFrame) -> Table:
    cells = [
        {
            **_names(row),
            "Trials": number(row["n"]),
            "Found, %": percent(row["success"]),
            "95 % interval": percent_range((row["success_low"], row["success_high"])),
            "Epochs": middle(row["epochs_median"], row["epochs_q1"], row["epochs_q3"]),
            "Epochs, if found": middle(
                row["found_epochs_median"], row["found_epochs_q1"], row["found_epochs_q3"]
            ),
            "Time, ms": number(1000 * row["seconds_median"]),
            "Paper: found": _paper_found(row["map"], row["planner"]),
            "Paper: epochs": _paper_epochs(row["map"], row["planner"]),
            "Paper: time, s": _paper_seconds(row["map"], row["planner"]),
        }
        for _, row in rows.iterrows()
    ]
    shown = pd.DataFrame(cells)
    paper = shown[["Paper: found", "Paper: epochs", "Paper: time, s"]]
    data = pd.concat(
        [rows, paper.set_axis(["paper_found", "paper_epochs", "paper_s"], axis=1)], axis=1
    )
    return Table(
        "table1",
        "KG18 Table 1, ours and the paper's. Found: share of trials with a feasible path, with "
        "its 95 % Wilson interval. Epochs: median (quartiles) of all trials, and of those that "
        "found a path, as the paper's are. Time: median of all trials. The paper gives three "
        "executions; N.F. is its 'not found', and its epochs are worked out from its seconds.",
        data,
        shown,
    )


def _effort(rows: pd.DataFrame) -> Table:
    shown = []
    for _, row in rows.iterrows():
        cells = _names(row)
        cells["Expected evaluations"] = number(row["ert_evaluations"])
        cells["Expected time, ms"] = number(1000 * row["ert_seconds"])
        for name, (title, unit) in _EFFORT.items():
            median, low, high, q1, q3 = (unit(row[f"{name}_{key}"]) for key in Spread._fields)
            cells[title] = middle(median, q1, q3)
            cells[f"{title}: 95 % of median"] = span(low, high)
        shown.append(cells)
    columns = ["map", "map_source", "planner", "n", "found"]
    columns += [f"{name}_{key}" for name in _EFFORT for key in Spread._fields]
    return Table(
        "table1_effort",
        "What a path costs on the maps of KG18 Table 1. Median (quartiles) over all trials, and "
        "the median's 95 % bootstrap interval; the cost above the optimal one over the trials that "
        "found a path. Expected: effort of all trials for each path found, as if a failed trial "
        "were started again; ∞ if none was found.",
        rows[[*columns, "ert_evaluations", "ert_seconds"]],
        pd.DataFrame(shown),
    )


def _paper_seconds(map_name: str, planner: str) -> str:
    times = SECONDS.get((map_name, planner), ())
    return ", ".join("N.F." if time is None else f"{time:.2f}" for time in times) or NOTHING


def _paper_epochs(map_name: str, planner: str) -> str:
    epochs = implied_epochs(map_name, planner)
    return span(min(epochs), max(epochs)) if epochs else NOTHING


def _paper_found(map_name: str, planner: str) -> str:
    n = len(SECONDS.get((map_name, planner), ()))
    found = len(found_seconds(map_name, planner))
    return f"{found} of {n}" if n else NOTHING


def _remarks(rows: pd.DataFrame) -> tuple[str, ...]:
    remarks = [
        "Three executions say little: 2 of 3 leaves anything from 21 % to 94 % possible (95 % "
        "Wilson interval), and 3 of 3 anything from 44 %.",
        "The paper's times are of Python 3.6 on its authors' machine and cannot be compared with "
        "ours. Its epochs can: on map 1 each execution took one epoch, so one epoch took it "
        "0.03 s with a population of 40 and 0.07 or 0.08 s with 100.",
        "The maps are reconstructed, so the numbers are of maps of the paper's classes, not of its "
        "maps: agreement shows that the method behaves as described, not that a figure was made "
        "again.",
        "A* and Dijkstra draw no random numbers: their trials differ in time only, so their "
        "success has no interval.",
    ]
    dijkstra = rows[rows["planner"] == "dijkstra"]
    if len(dijkstra):
        ours = dijkstra["seconds_median"]
        remarks.insert(
            2,
            "The paper's 40 s for Dijkstra on 5000 fields are a matter of its implementation: "
            f"compiled, it takes {span(1000 * ours.min(), 1000 * ours.max())} ms here.",
        )
    return tuple(remarks)
