"""M22 Figs 9 and 11: final paths, with the limit and without, beside the shortest ones."""

from collections.abc import Sequence

import pandas as pd
from matplotlib.lines import Line2D

from gapath.pictures.board import draw_picture
from gapath.pipelines.m22.logs import First, read_first
from gapath.pipelines.m22.table import SCENES
from gapath.pipelines.page.figures import Look, looks, panels, render, style
from gapath.pipelines.page.section import Figure, Section
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.logs import read_logs
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "m22"
ORDER = 95

PLANNERS = ("visibility_ga", "visibility_ga_unlimited", "visibility_dijkstra_corners",
            "inflated_ga3")  # fmt: skip
MAPS_SHOWN = 4


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw paths on the first scenes.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from, with their logs.

    Returns
    -------
    Section or None
        One figure with a panel a scene; None if no run has a log.
    """
    names = sorted(trials["map"].unique(), key=rank)[:MAPS_SHOWN]
    found: dict[str, dict[str, First]] = {name: {} for name in names}
    drawn = [run for run in runs if run.known.map in found and run.known.method in PLANNERS]
    read, skipped = read_logs(drawn, read_first)
    for run, first in read:
        found[run.known.map][run.known.method] = first
    found = {name: by_planner for name, by_planner in found.items() if by_planner}
    if not found and not skipped:
        return None
    look = looks(PLANNERS)
    return Section(
        title="M22: final paths",
        text=(SCENES,),
        figures=(_figure(found, look),) if found else (),
        skipped=tuple(skipped),
    )


def _figure(found: dict[str, dict[str, First]], look: dict[str, Look]) -> Figure:
    sentences = []
    drawn = [name for name in look if any(name in by_planner for by_planner in found.values())]
    with style():
        canvas, axes = panels(len(found), 2.0, same_axes=False)
        for panel, (name, by_planner) in zip(axes, found.items(), strict=True):
            grid = next(iter(by_planner.values())).start.problem.map
            graph = next((f.graph for f in by_planner.values() if f.graph is not None), None)
            grown = None if graph is None else graph.grown(grid.rows, grid.cols)
            draw_picture(panel, grid.obstacles, grown)
            panel.set_title(label(name))
            for planner in drawn:
                if planner not in by_planner or not len(by_planner[planner].way_points):
                    continue
                points = by_planner[planner].way_points
                color, dashes = _BRIGHT[drawn.index(planner)], look[planner].dashes
                width = 2.6 if planner == drawn[0] else 1.1  # equal paths lie on one another
                panel.plot(*points.T, color=color, linestyle=dashes, linewidth=width)
                kind = "lines" if len(by_planner[planner].best) else "steps"
                sentences.append(f"{label(name)}, {label(planner)}: {len(points) - 1} {kind}.")
        handles = [
            Line2D([], [], color=_BRIGHT[i], linestyle=look[planner].dashes, label=label(planner))
            for i, planner in enumerate(drawn)
        ]
        legend = canvas.legend(handles=handles, loc="outside lower center", ncols=2)
        legend.set(frame_on=True)
        legend.get_frame().set(facecolor="black", edgecolor="none")
        for text in legend.get_texts():
            text.set_color("white")
        svg, png = render(canvas)
    return Figure(
        "m22_paths",
        "The first path that each planner found, on the first of the reconstructed scenes: M22 "
        "with its limit of 20 generations and without, the shortest path over corners, and KG18's "
        "GA 3, whose way points lie anywhere. Orange: what the obstacles grew by.",
        f"{len(found)} scenes with paths. " + " ".join(sentences),
        svg,
        png,
    )


# Colours that show on black, as the paper's pictures are; otherwise those of all figures.
_BRIGHT = ("#56B4E9", "#009E73", "#F0E442", "#CC79A7")
