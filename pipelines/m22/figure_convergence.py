"""M22 Figs 8 and 10: best f by generation, with the limit and without."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gapath.events import Evolved
from gapath.pipelines.numbers.statistics import by_epoch
from gapath.pipelines.numbers.text import number
from gapath.pipelines.page.figures import looks, panels, render, style
from gapath.pipelines.page.section import Figure, Section
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.logs import events_of, read_logs
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "m22"
ORDER = 94

PLANNERS = ("visibility_ga", "visibility_ga_unlimited")

Curves = dict[tuple[str, str], list[NDArray[np.float64]]]
"""f by generation of each trial that found a path, by map and planner."""


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw how f falls on every scene.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from, with their logs.

    Returns
    -------
    Section or None
        One figure with a panel a planner; None if no run has a log.
    """
    found = set(trials.loc[trials["feasible"], ["key", "trial"]].itertuples(index=False, name=None))

    def read(run: RunRecord) -> list[NDArray[np.float64]]:
        return [
            event.evolution.best
            for event in events_of(run)
            if isinstance(event, Evolved) and (run.folder.name, event.trial) in found
        ]

    logs, skipped = read_logs([run for run in runs if run.known.method in PLANNERS], read)
    curves = {(run.known.map, run.known.method): sample for run, sample in logs if sample}
    if not curves and not skipped:
        return None
    figures = (_figure(curves),) if curves else ()
    return Section(title="M22: best f by generation", figures=figures, skipped=tuple(skipped))


def _figure(curves: Curves) -> Figure:
    planners = sorted({planner for _, planner in curves}, key=rank)
    color = looks(planners)[planners[0]].color
    sentences = []
    with style():
        canvas, axes = panels(len(planners), 2.6, same_axes=False)
        for panel, planner in zip(axes, planners, strict=True):
            scenes = sorted((name for name, other in curves if other == planner), key=rank)
            for name in scenes:
                _, median, _ = by_epoch(curves[name, planner])
                panel.plot(np.arange(1, len(median) + 1), median, color=color, linewidth=0.9)
                sentences.append(
                    f"{label(name)}, {label(planner)}: median {number(median[0])} in generation "
                    f"1, {number(median[-1])} in generation {len(median)}."
                )
            panel.set_title(label(planner))
            panel.set(xlabel="generation", xscale="log")
        axes[0].set_ylabel("best f, pixels")
        svg, png = render(canvas)
    return Figure(
        "m22_convergence",
        "Best f by generation, a line a scene (reconstructed): median over the trials that found "
        "a path; one that has ended keeps its last value. A chromosome without a free path counts "
        "as long as the picture's perimeter.",
        "Falling curves, one a scene. " + " ".join(sentences),
        svg,
        png,
    )
