"""How S04's success depends on what the paper does not give: population, mutation, crossover."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.numbers.text import number, percent
from gapath.pipelines.page.figures import legend as draw_legend
from gapath.pipelines.page.figures import looks, panels, render, style
from gapath.pipelines.page.section import DRAWN, Figure, Section, Table
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.papers.s04 import PLANNERS, RUNS, paper_successes
from gapath.pipelines.s04.runs import other_changes
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "s04_sweep"
ORDER = 88

SWEPT = {
    "population": "Population",
    "mutation_probability": "Mutation probability",
    "crossover_probability": "Crossover probability",
}
"""The settings of the sweep."""


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Make the section on the sweep.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section or None
        A table with a row a setting, and a figure a swept setting; None without a cell of the
        paper's.
    """
    cells = rate_cells(trials, runs)
    if cells.empty:
        return None
    others = sorted({run.known.method for run in runs if swept_settings(run) is None})
    rows = rate_settings(cells)
    return Section(
        title="S04: how success depends on population, mutation and crossover",
        text=(
            "The paper gives none of them. Swept is the range of neighbouring work of its group; "
            "each run ends at its first feasible path.",
            DRAWN,
        ),
        tables=(_table(rows).with_runs(cells, list(SWEPT)),),
        figures=tuple(_figure(cells, name) for name in SWEPT if len(set(cells[name])) > 1),
        remarks=(
            _nearest(rows, cells),
            f"A rate of {number(cells['n'].median())} runs is itself uncertain by up to "
            f"{number(100 * _half_width(int(cells['n'].median())))} percentage points (95 % Wilson "
            "interval), so settings next to one another in the table differ by chance as well.",
        ),
        skipped=tuple((name, "differs in a setting that is not swept") for name in others),
    )


def swept_settings(run: RunRecord) -> dict[str, float] | None:
    """Give a run's values of what is swept.

    Parameters
    ----------
    run : RunRecord
        A run.

    Returns
    -------
    dict or None
        The values of `SWEPT`; None if its planner is none of the paper's, or differs from its
        YAML in something else as well.
    """
    swept = {f"planner.{name}" for name in SWEPT}
    if run.known.preset not in PLANNERS or not set(other_changes(run)) <= swept:
        return None
    return {name: float(str(run.settings[f"planner.{name}"])) for name in SWEPT}


def rate_cells(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> pd.DataFrame:
    """Give the success of each search space, planner and setting.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    DataFrame
        map, planner, the run's key, the columns of `SWEPT`, n, success, paper, paper_low,
        paper_high, inside (whether the rate lies in the paper's interval).
    """
    by_key = {run.folder.name: run for run in runs}
    rows = []
    for (name, _), group in trials.groupby(["map", "planner"]):
        run = by_key[group["key"].iloc[0]]
        paper, settings = paper_successes(name, run.known.preset), swept_settings(run)
        if paper is None or settings is None:
            continue
        low, high = wilson(paper / RUNS, RUNS)
        success = group["feasible"].mean()
        rows.append(
            {
                "map": name,
                "planner": run.known.preset,
                "key": run.folder.name,
                **settings,
                "n": len(group),
                "success": success,
                "paper": paper,
                "paper_low": low,
                "paper_high": high,
                "inside": low <= success <= high,
            }
        )
    return pd.DataFrame(rows)


def rate_settings(cells: pd.DataFrame) -> pd.DataFrame:
    """Count for each setting how many cells lie in the paper's intervals.

    Parameters
    ----------
    cells : DataFrame
        As `rate_cells` gives them.

    Returns
    -------
    DataFrame
        The columns of `SWEPT`, cells, inside, off: by how much rates miss their intervals, summed
        up; the nearest setting first.
    """
    miss = (cells["paper_low"] - cells["success"]).clip(lower=0)
    miss += (cells["success"] - cells["paper_high"]).clip(lower=0)
    groups = cells.assign(off=miss).groupby(list(SWEPT))
    rows = groups.agg(cells=("inside", "size"), inside=("inside", "sum"), off=("off", "sum"))
    return rows.reset_index().sort_values(["inside", "off"], ascending=[False, True])


def _half_width(n: int) -> float:
    low, high = wilson(0.5, n)
    return (high - low) / 2


def _table(rows: pd.DataFrame) -> Table:
    shown = [
        {
            **{title: f"{row[name]:g}" for name, title in SWEPT.items()},
            "Cells": number(row["cells"]),
            "Inside": number(row["inside"]),
            "Outside by, points": number(100 * row["off"]),
        }
        for _, row in rows.iterrows()
    ]
    return Table(
        "s04_sweep",
        "Cells of S04 Table 1 whose rate lies in the 95 % Wilson interval of the paper's 15 runs, "
        "and by how many percentage points the others miss theirs, summed up; the nearest setting "
        "first.",
        rows,
        pd.DataFrame(shown),
        heads=len(SWEPT),
    )


def _nearest(rows: pd.DataFrame, cells: pd.DataFrame) -> str:
    best = rows.iloc[0]
    chosen = cells[(cells[list(SWEPT)] == best[list(SWEPT)]).all(axis=1) & ~cells["inside"]]
    names = ", ".join(
        f"{label(row['planner'])} on {label(row['map'])} ({percent(row['success'])} %, paper "
        f"{percent(row['paper'] / RUNS)} %)"
        for _, row in chosen.iterrows()
    )
    setting = ", ".join(f"{title.lower()} {best[name]:g}" for name, title in SWEPT.items())
    return (
        f"Nearest to Table 1: {setting}, {number(best['inside'])} of {number(best['cells'])} cells "
        f"inside{f'; outside: {names}' if names else ''}."
    )


def _figure(cells: pd.DataFrame, setting: str) -> Figure:
    names = sorted(set(cells["map"]), key=rank)
    look = looks(cells["planner"])
    sentences = []
    with style():
        canvas, axes = panels(len(names), 1.7)
        for name, panel in zip(names, axes, strict=True):
            here = cells[cells["map"] == name]
            for planner, (color, dashes) in look.items():
                mine = here[here["planner"] == planner]
                if mine.empty:
                    continue
                spread = mine.groupby(setting)["success"].agg(["min", "mean", "max"]) * 100
                panel.plot(spread.index, spread["mean"], color=color, linestyle=dashes)
                panel.fill_between(
                    spread.index, spread["min"], spread["max"], color=color, alpha=0.15, linewidth=0
                )
                sentences.append(
                    f"{label(name)}, {label(planner)}: {spread['mean'].iloc[0]:.0f} % to "
                    f"{spread['mean'].iloc[-1]:.0f} %."
                )
            panel.set_title(label(name))
            panel.set(ylim=(-4, 104))
        draw_legend(canvas, look)
        canvas.supxlabel(SWEPT[setting].lower())
        canvas.supylabel("found, %")
        svg, png = render(canvas)
    return Figure(
        f"s04_sweep_{setting}",
        f"Success by {SWEPT[setting].lower()} on the search spaces (reconstructed): the mean over "
        "the other two settings swept, shaded from the least to the greatest.",
        f"Panels, one a search space, with a curve for each planner from the least "
        f"{SWEPT[setting].lower()} to the greatest. " + " ".join(sentences),
        svg,
        png,
    )
