"""S04 Table 1: eight search spaces, three genotypes, the paper's 15 runs beside ours."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.numbers.grouped import Spread, grouped
from gapath.pipelines.numbers.statistics import Interval, wilson
from gapath.pipelines.numbers.summary import summarise_by
from gapath.pipelines.numbers.text import NOTHING, middle, number, percent, percent_range, span
from gapath.pipelines.page.section import DRAWN, Section, Table
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.papers.s04 import RUNS, paper_successes
from gapath.pipelines.s04.runs import with_form
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "s04_table1"
ORDER = 86

_BY = ["map", "map_source", "planner"]


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section:
    """Make the section of S04 Table 1.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section
        Success beside the paper's, and what it takes.
    """
    trials = with_form(trials, runs)
    rows = summarise_cells(trials)
    return Section(
        title="S04 Table 1: three genotypes on eight search spaces",
        text=(
            "On a square grid a robot goes from the upper left to the lower right corner in "
            "horizontal and vertical moves. Geisler's chromosomes go row by row, Hermanu's row by "
            "row or column by column, Sedighi's may change between the two, twice at most. 15 runs "
            "as in the paper take every generation; a thousand seeds end at their first path.",
            DRAWN,
        ),
        tables=tuple(
            table.with_runs(trials, _BY) for table in (_beside_the_paper(rows), _effort(rows))
        ),
        remarks=_remarks(rows, lost(trials)),
    )


def lost(trials: pd.DataFrame) -> tuple[int, int]:
    """Count the runs that found a path, but whose last generation's fittest is none.

    Parameters
    ----------
    trials : DataFrame
        As `with_form` gives them; the same trial of a run of every generation and of one that
        ends at its first path are the same up to there.

    Returns
    -------
    lost, found : int
        Of the runs that are there in both forms.
    """
    by = ["map", "planner", "seed", "trial"]
    first, last = trials[trials["short"]], trials[~trials["short"]]
    both = first.merge(last, on=by, suffixes=("_first", "_last"))
    found = both["feasible_first"].astype(bool)
    return int((found & ~both["feasible_last"].astype(bool)).sum()), int(found.sum())


def summarise_cells(trials: pd.DataFrame) -> pd.DataFrame:
    """Summarise each cell of the table: its few long runs and its many short ones.

    Parameters
    ----------
    trials : DataFrame
        As `with_form` gives them.

    Returns
    -------
    DataFrame
        map, map_source, planner, preset; few_n and few_found, of the
        runs of every generation, with their interval; the columns of `summary.summarise`, of
        the runs that end at a path; paper (successes of `s04.RUNS`), paper_low, paper_high;
        inside: whether the latter runs' rate lies in the paper's interval, and paper_inside:
        the paper's in that of the former. Missing where there are no such runs.
    """
    short, every = trials[trials["short"]], trials[~trials["short"]]
    rows, _ = grouped(trials, [*_BY, "preset"])
    rows = rows.sort_values(_BY, key=lambda names: names.map(lambda name: rank(str(name))))
    names, groups = grouped(every, _BY)
    few = names.assign(few_n=groups.sizes, few_found=groups.counts(every["feasible"]))
    rows = rows.merge(few, on=_BY, how="left")
    seeds = summarise_by(short if len(short) else trials, _BY)
    rows = rows.merge(seeds if len(short) else seeds.iloc[:0], on=_BY, how="left")
    paper = [paper_successes(*pair) for pair in zip(rows["map"], rows["preset"], strict=True)]
    rows["paper"] = pd.array(paper, dtype="Int64")
    cells = [_compared(row) for _, row in rows.iterrows()]
    return pd.concat([rows, pd.DataFrame(cells, index=rows.index)], axis=1)


def _compared(row: pd.Series) -> dict[str, object]:
    missing = (float("nan"), float("nan"))
    paper, few = row["paper"], row["few_n"]
    ours: Interval = missing if pd.isna(few) else wilson(row["few_found"] / few, int(few))
    theirs: Interval = missing if pd.isna(paper) else wilson(paper / RUNS, RUNS)
    return {
        "few_low": ours[0],
        "few_high": ours[1],
        "paper_low": theirs[0],
        "paper_high": theirs[1],
        "inside": bool(theirs[0] <= row["success"] <= theirs[1]),
        "paper_inside": bool(not pd.isna(paper) and ours[0] <= paper / RUNS <= ours[1]),
    }


def _names(row: pd.Series) -> dict[str, str]:
    return {
        "Search space": label(row["map"], row["map_source"]),
        "Planner": label(row["planner"]),
    }


def _beside_the_paper(rows: pd.DataFrame) -> Table:
    shown = []
    for _, row in rows.iterrows():
        known, few = not pd.isna(row["paper"]), row["few_n"]
        both = known and not pd.isna(few)
        shown.append(
            {
                **_names(row),
                "Paper, %": percent(row["paper"] / RUNS) if known else NOTHING,
                "Paper: 95 %": percent_range((row["paper_low"], row["paper_high"])),
                "Runs": number(few),
                "Runs: at the end, %": NOTHING if pd.isna(few) else percent(row["few_found"] / few),
                "Runs: 95 %": percent_range((row["few_low"], row["few_high"])),
                "Paper in runs'": _say(row["paper_inside"]) if both else NOTHING,
                "Seeds": number(row["n"]),
                "Seeds: found, %": NOTHING if pd.isna(row["n"]) else percent(row["success"]),
                "Seeds: 95 %": percent_range((row["success_low"], row["success_high"])),
                "Seeds in paper's": _say(row["inside"])
                if known and not pd.isna(row["n"])
                else NOTHING,
            }
        )
    columns = [*_BY, "paper", "paper_low", "paper_high", "few_n", "few_found"]
    columns += ["few_low", "few_high", "paper_inside"]
    columns += ["n", "found", "success", "success_low", "success_high", "inside"]
    return Table(
        "s04_table1",
        "S04 Table 1, the paper's and ours. Intervals are Wilson's, 95 %. Paper: success of 15 "
        "runs. At the end: of our runs of every generation, those whose last fittest path is "
        "feasible, and whether the paper's rate lies in their interval. Found: of many seeds, each "
        "until its fittest path is feasible, and whether that rate lies in the paper's interval. "
        "The runs are the first of the seeds.",
        rows[columns],
        pd.DataFrame(shown),
    )


def _say(inside: object) -> str:
    return "yes" if inside else "no"


def _effort(rows: pd.DataFrame) -> Table:
    shown = [
        {
            **_names(row),
            "Generations, if found": middle(
                *(row[f"found_epochs_{key}"] for key in ("median", "q1", "q3"))
            ),
            "Evaluations": middle(*(row[f"evaluations_{key}"] for key in ("median", "q1", "q3"))),
            "95 % of median": span(row["evaluations_low"], row["evaluations_high"]),
            "Expected evaluations": number(row["ert_evaluations"]),
            "Expected time, ms": number(1000 * row["ert_seconds"]),
        }
        for _, row in rows.iterrows()
    ]
    columns = [*_BY, "n", "found"]
    columns += [
        f"{name}_{key}" for name in ("found_epochs", "evaluations") for key in Spread._fields
    ]
    return Table(
        "s04_effort",
        "What a path costs: generations to the first path, median (quartiles) of the seeds that "
        "found one; evaluations of all seeds, with the median's 95 % bootstrap interval. Expected: "
        "effort of all seeds for each path found, as if a failed run were started again; ∞ if none "
        "was found.",
        rows[[*columns, "ert_evaluations", "ert_seconds"]],
        pd.DataFrame(shown),
    )


def _remarks(rows: pd.DataFrame, lost_of_found: tuple[int, int]) -> tuple[str, ...]:
    compared = rows[rows["paper"].notna()]
    few = compared[compared["few_n"].notna()]
    remarks = [_inside(compared[compared["n"].notna()])] if compared["n"].notna().any() else []
    if len(few):
        remarks.append(
            f"In {int(few['paper_inside'].sum())} of {len(few)} cells the paper's rate lies in the "
            "interval of our runs of every generation."
        )
    remarks += [
        "Where the paper has 0 % no chromosome has a free path, which dynamic programming proves "
        "(gapath-genotype): these cells could not but agree.",
        f"Of {lost_of_found[1]} runs of every generation that found a path {lost_of_found[0]} lost "
        "it again: fitness is relative to the population, and there a path with a collision "
        "can be fitter than a free one that is the longest and has the most turns.",
        "Fifteen runs say little: 15 of 15 leaves anything from 79.6 % on possible, 8 of 15 "
        "anything from 30 % to 75 % (95 % Wilson interval).",
        "The grids were drawn for their classes, and among several drafts those were kept on which "
        "the planners do about as the paper says; that rates agree is partly by choice. The paper "
        "gives no population, rates or generations either.",
        "Many seeds run on two threads, so their times may hold a wait of one for the other.",
    ]
    return tuple(remarks)


def _inside(rows: pd.DataFrame) -> str:
    """Count the cells whose rate over many seeds lies in the paper's interval."""
    inside = rows["inside"].astype(bool)
    open_ones = rows["paper"] > 0
    names = ", ".join(
        f"{label(row['planner'])} on {label(row['map'])} ({percent(row['success'])} %)"
        for _, row in rows[~inside].iterrows()
    )
    return (
        f"Over many seeds {int(inside.sum())} of {len(rows)} cells lie in the paper's interval, "
        f"{int((inside & open_ones).sum())} of the {int(open_ones.sum())} in which the paper has "
        f"more than 0 %{f'; outside: {names}' if names else ''}."
    )
