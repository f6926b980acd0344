"""KG18 Sec. 6: drives through unknown maps, beside exact rivals in the same loop."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.numbers.drive_summary import rate, summarise_drives
from gapath.pipelines.numbers.summary import summarise_by
from gapath.pipelines.numbers.text import NOTHING, middle, number
from gapath.pipelines.page.section import RECONSTRUCTED, Section, Table
from gapath.pipelines.papers.kg18 import DRIVE_SECONDS
from gapath.pipelines.papers.names import label
from gapath.store.records import RunRecord

TASK = "drive"
EXPERIMENT = "drives"
ORDER = 60


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Make the section on drives through KG18's unknown maps.

    Parameters
    ----------
    trials : DataFrame
        The drives of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section or None
        How the drives ended and what they took, for each map and navigator; None of other
        instances.
    """
    trials = trials[trials["map_instance"] == 0]
    if trials.empty:
        return None
    by = ["map", "map_source", "navigator"]
    rows = summarise_by(trials, by, summarise_drives)
    tables = _outcomes(rows), _effort(rows)
    return Section(
        title="KG18 Sec. 6: drives through unknown maps",
        text=(
            "A robot knows nothing of the map but what it has seen, and takes the rest for free. "
            "KG18 is the paper's obstacle avoidance: it follows its path and now and then looks "
            "for a better one (part B), plans thoroughly where the path has met an obstacle (part "
            "C), and goes back in its footsteps where no path is found (part A). The others stand "
            "in the same loop with the same sensor: three exact ones, and KG18 with fewer epochs "
            "in part C or with A* as its last resort.",
            RECONSTRUCTED,
        ),
        tables=tuple(table.with_runs(trials, by) for table in tables),
        remarks=_remarks(rows),
    )


def _names(row: pd.Series) -> dict[str, str]:
    return {"Map": label(row["map"], row["map_source"]), "Navigator": label(row["navigator"])}


def _outcomes(rows: pd.DataFrame) -> Table:
    shown = [
        {
            **_names(row),
            "Drives": number(row["n"]),
            "Reached, %": rate(row, "reached"),
            "Returned, %": rate(row, "returned"),
            "Overran, %": rate(row, "overran"),
            "Steps": middle(row["steps_median"], row["steps_q1"], row["steps_q3"]),
            "Steps / shortest": middle(
                row["steps_ratio_median"], row["steps_ratio_q1"], row["steps_ratio_q3"]
            ),
        }
        for _, row in rows.iterrows()
    ]
    return Table(
        "drives",
        "How the drives ended: at the target, back at the start (KG18's failure), or at the "
        "limit of 2000 steps, each with its 95 % Wilson interval. Steps: median (quartiles) of all "
        "drives; shortest is the fewest steps possible for who knows the map, and the ratio is of "
        "the drives that reached the target. The paper: 'almost all' reach it, and on map 4 none "
        "of 100 overran.",
        rows,
        pd.DataFrame(shown),
    )


def _effort(rows: pd.DataFrame) -> Table:
    shown = [
        {
            **_names(row),
            **{f"Calls in {part.upper()}": number(row[f"calls_{part}"]) for part in "abc"},
            "Replans": middle(row["replans_median"], row["replans_q1"], row["replans_q3"]),
            "Time, ms": middle(*(1000 * row[f"seconds_{key}"] for key in ("median", "q1", "q3"))),
            "Paper: time, s": _paper(row),
        }
        for _, row in rows.iterrows()
    ]
    columns = [name for name in rows if name.startswith(("calls_", "replans_", "seconds_"))]
    data = rows[["map", "map_source", "navigator", "n", *columns]]
    return Table(
        "drives_effort",
        "What the drives took: planner calls by part of KG18's step, means (the exact rivals' "
        "searches stand under C, on the way back under A); steps in which the path had met an "
        "obstacle, and computing time of a whole drive, sensing included, medians "
        "(quartiles) of all drives. The paper's times are what survives of the axes of its "
        "histograms: Python, on another machine.",
        data.assign(paper_s=[_paper(row) for _, row in rows.iterrows()]),
        pd.DataFrame(shown),
    )


def _paper(row: pd.Series) -> str:
    return DRIVE_SECONDS.get(row["map"], NOTHING) if row["navigator"] == "kg18" else NOTHING


def _remarks(rows: pd.DataFrame) -> tuple[str, ...]:
    remarks = [text for name in rows["map"].unique() for text in _winners(rows, name)]
    if "sedighi" in set(rows["navigator"]):
        remarks.append(
            "Sedighi 2004 is the local planning of another paper: straight on, and around what is "
            "in the way on a square subsection. Its robot moves horizontally and vertically only, "
            "while the shortest path here may go diagonally."
        )
    remarks += [
        "The rivals are compiled with the same care as the genetic algorithm, use the same sensor, "
        "the same map updates and the same count of steps; only the decisions differ. Who draws no "
        "random numbers drives the same way each time, so its rates have no interval.",
        "Where the target can be reached an exact planner finds a path on every known map, as "
        "unknown fields count as free: each return on such a map, KG18's or Sedighi's, is a miss "
        "of a genetic algorithm.",
        "The paper's seconds and ours cannot be compared as machines go; its maps are lost, and "
        "those here are others of the same classes.",
    ]
    return tuple(remarks)


def _winners(rows: pd.DataFrame, name: str) -> list[str]:
    """Say who needed the fewest steps and the least time on a map, of those that always arrived."""
    here = rows[rows["map"] == name].set_index("navigator")
    whole = here[here["reached_rate"] == 1]
    if "kg18" not in here.index or len(here) == 1 or whole.empty:
        return []
    kg18 = here.loc["kg18"]
    steps, ratio = whole["steps_median"], whole["steps_ratio_median"]
    fewest = ", ".join(label(who) for who in steps.index[steps == steps.min()])
    quickest = whole["seconds_median"].idxmin()
    times = kg18["seconds_median"] / whole["seconds_median"].min()
    ours = (
        ""
        if "KG18" in fewest.split(", ")
        else (f", KG18 {number(kg18['steps_median'])} (ratio {number(kg18['steps_ratio_median'])})")
    )
    pace = (
        "KG18 is also the quickest"
        if quickest == "kg18"
        else f"the quickest is {label(quickest)}, {number(times)} times as quick as KG18"
    )
    return [
        f"{label(name)}, of those that always arrived: fewest steps by {fewest}, median "
        f"{number(steps.min())} (ratio {number(ratio[steps.idxmin()])}){ours}; {pace}."
    ]
