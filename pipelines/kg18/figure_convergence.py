"""How the genetic algorithms converge: best fitness by epoch, from the logs."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gapath.events import Evolved
from gapath.pipelines.numbers.statistics import by_epoch
from gapath.pipelines.numbers.text import number
from gapath.pipelines.page.figures import legend, looks, panels, render, style
from gapath.pipelines.page.section import Figure, Section
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.logs import events_of, has_log, read_logs
from gapath.recorders.mcap import FILE
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "table1"
ORDER = 30

Curves = dict[tuple[str, str], list[NDArray[np.float64]]]
"""For each map and planner the best fitness by epoch, an array a trial."""


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw the best fitness by epoch.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from, with their logs.

    Returns
    -------
    Section or None
        One figure with a panel a map; None if no run has a log of a genetic algorithm.
    """
    curves: Curves = defaultdict(list)
    # Logs without epochs are not opened: those of Dijkstra hold nothing to draw.
    evolving = set(trials.loc[trials["epochs"] > 0, "key"])
    runs = [run for run in runs if run.folder.name in evolving]
    read, damaged = read_logs(runs, read_curves)
    for run, best in read:
        curves[run.known.map, run.known.method] += best
    bare = [(run.name, f"no log {FILE}") for run in runs if not has_log(run)]
    sources = dict(trials[["map", "map_source"]].drop_duplicates("map").to_numpy())
    figures = (_figure(curves, sources),) if curves else ()
    return Section(title="Convergence", figures=figures, skipped=(*bare, *damaged))


def read_curves(run: RunRecord) -> list[NDArray[np.float64]]:
    """Read the best fitness by epoch of each trial from a run's log."""
    return [event.evolution.best for event in events_of(run) if isinstance(event, Evolved)]


def _figure(curves: Curves, sources: dict[str, str]) -> Figure:
    maps = sorted({name for name, _ in curves}, key=rank)
    look = looks(planner for _, planner in curves)
    sentences = []
    with style():
        canvas, axes = panels(len(maps), height=2.2)
        for panel, name in zip(axes, maps, strict=True):
            panel.set_title(label(name, sources[name]))
            for i, (planner, (color, dashes)) in enumerate(look.items()):
                if (name, planner) not in curves:
                    continue
                low, median, high = by_epoch(curves[name, planner])
                epochs = np.arange(1, len(median) + 1)
                # A single epoch is a point; of several sizes, lest one hide the others.
                point = "o" if len(epochs) == 1 else ""
                panel.fill_between(epochs, low, high, color=color, alpha=0.18, linewidth=0)
                panel.plot(
                    epochs,
                    median,
                    color=color,
                    linestyle=dashes,
                    marker=point,
                    markersize=max(3, 11 - 3 * i),
                )
                sentences.append(
                    f"{label(name)}, {label(planner)}: median {number(median[0])} in epoch 1, "
                    f"{number(median[-1])} in epoch {len(epochs)}."
                )
            panel.set(xscale="log", yscale="log")
        canvas.supxlabel("epoch", fontsize=10)
        canvas.supylabel("best fitness, eq. (5)", fontsize=10)
        legend(canvas, look)
        svg, png = render(canvas)
    return Figure(
        "convergence",
        "Best fitness by epoch, KG18 eq. (5): median over all trials, and quartiles as a band. "
        "Each obstacle field on a path counts 100 000 in the paper's settings, so a fitness below "
        "that is a feasible path. A trial that has ended keeps its last value.",
        "Convergence, one panel a map. " + " ".join(sentences),
        svg,
        png,
    )
