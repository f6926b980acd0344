"""M22 Figs 8 and 10: best f by generation, with the limit and without."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gapath.errors import InputError
from gapath.events import Evolved
from gapath.pipelines.numbers.statistics import by_epoch
from gapath.pipelines.numbers.text import number
from gapath.pipelines.page.figures import looks, panels, render, style
from gapath.pipelines.page.section import Figure, Section
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.runs import Run
from gapath.recorders.mcap import FILE, read_events

TASK = "plan"
EXPERIMENT = "m22"
ORDER = 94

PLANNERS = ("visibility_ga", "visibility_ga_unlimited")

Curves = dict[tuple[str, str], list[NDArray[np.float64]]]
"""f by generation of each trial that found a path, by map and planner."""


def section(trials: pd.DataFrame, runs: Sequence[Run]) -> Section | None:
    """Draw how f falls on every scene.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of Run
        The runs they come from, with their logs.

    Returns
    -------
    Section or None
        One figure with a panel a planner; None if no run has a log.
    """
    found = set(trials.loc[trials["feasible"], ["key", "trial"]].itertuples(index=False, name=None))
    curves: Curves = {}
    skipped = []
    for run in runs:
        planner = run.manifest["planner"]
        if planner not in PLANNERS or FILE not in run.manifest["files"]:
            continue
        try:
            curves[run.manifest["map"], planner] = [
                event.evolution.best
                for event in read_events(run.folder / FILE)
                if isinstance(event, Evolved) and (run.folder.name, event.trial) in found
            ]
        except InputError as error:
            skipped.append((run.name, str(error)))
    curves = {key: sample for key, sample in curves.items() if sample}
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
