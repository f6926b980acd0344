"""How many evaluations a genetic algorithm needs: the distribution over all trials."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.numbers.text import percent
from gapath.pipelines.page.figures import draw_shares, legend, looks, panels, render, style
from gapath.pipelines.page.section import Figure, Section
from gapath.pipelines.papers.names import label, rank
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "table1"
ORDER = 40


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw the distribution of evaluations to a feasible path.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section or None
        One figure with a panel a map; None if no planner counts evaluations.
    """
    counted = trials[trials["evaluations"] > 0]
    if counted.empty:
        return None
    return Section(title="Evaluations to a feasible path", figures=(_figure(counted),))


def _figure(trials: pd.DataFrame) -> Figure:
    maps = sorted(trials["map"].unique(), key=rank)
    look = looks(trials["planner"])
    limits = 0.8 * trials["evaluations"].min(), 1.25 * trials["evaluations"].max()
    with style():
        canvas, axes = panels(len(maps), height=2.0)
        for panel, name in zip(axes, maps, strict=True):
            here = trials[trials["map"] == name]
            panel.set_title(label(name, here["map_source"].iloc[0]))
            for planner, its_look in look.items():
                mine = here[here["planner"] == planner]
                draw_shares(panel, (mine["evaluations"], mine["feasible"]), limits, its_look)
            panel.set(xscale="log", xlim=limits, ylim=(-0.04, 1.06))
        canvas.supxlabel("evaluations", fontsize=10)
        canvas.supylabel("share of trials with a path", fontsize=10)
        legend(canvas, look)
        svg, png = render(canvas)
    ends_at = trials.groupby(["map", "planner"])["feasible"].mean().reset_index()
    return Figure(
        "evaluations",
        "Share of all trials that have a feasible path after so many evaluations of the fitness. A "
        "failed trial never counts: a curve that ends below 1 is a planner that failed.",
        "Distributions of evaluations, one panel a map. The curves end at: "
        + "; ".join(
            f"{label(name)}, {label(planner)} {percent(rate)} %"
            for name, planner, rate in ends_at.itertuples(index=False)
        )
        + ".",
        svg,
        png,
    )
