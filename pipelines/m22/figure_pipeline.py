"""M22 Figs 2 to 7: from the image to the graph, and the path that the planner took through it."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from gapath.history.graph import Graph
from gapath.pictures.board import LINE, draw_lines, draw_picture
from gapath.pipelines.m22.logs import First, read_first
from gapath.pipelines.page.figures import panels, render, style
from gapath.pipelines.page.section import Figure, Section
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.logs import read_logs
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "m22"
ORDER = 93


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw the stages of the first scene.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from, with their logs.

    Returns
    -------
    Section or None
        One figure; None if no run of the paper's planner has a log.
    """
    mine = [run for run in runs if run.known.method == "visibility_ga"]
    skipped: list[tuple[str, str]] = []
    for run in sorted(mine, key=lambda run: rank(run.known.map)):
        read, damaged = read_logs([run], read_first)
        skipped += damaged
        for _, first in read:
            if first.graph is not None:
                return Section(
                    title="M22's pipeline in pictures",
                    figures=(_figure(first, first.graph),),
                    skipped=tuple(skipped),
                )
    return Section("M22's pipeline in pictures", skipped=tuple(skipped)) if skipped else None


def _figure(first: First, graph: Graph) -> Figure:
    problem = first.start.problem
    grid, points = problem.map, graph.points
    everything = np.argwhere(np.triu(np.ones((len(points), len(points)), dtype=np.bool_), 1))
    titles = ("image (Fig. 2)", "dilated (Fig. 3)", "keypoints (Fig. 5)", "all lines (Fig. 6)",
              "free lines (Fig. 7)", "path found")  # fmt: skip
    none = np.empty((0, 2), dtype=np.int32)
    grown = graph.grown(grid.rows, grid.cols)
    with style():
        canvas, axes = panels(6, 1.75, same_axes=False)
        for i, (panel, title) in enumerate(zip(axes, titles, strict=True)):
            draw_picture(panel, grid.obstacles, grown if i in (1, 3, 4, 5) else None)
            panel.set_title(title)
        draw_lines(axes[2], points, none)
        draw_lines(axes[3], points, everything.astype(np.int32))
        draw_lines(axes[4], points, graph.edges)
        if len(first.way_points):
            axes[5].plot(*first.way_points.T, color=LINE, marker="o", markersize=2.5)
        svg, png = render(canvas)
    name = label(grid.name, grid.source)
    return Figure(
        "m22_pipeline",
        f"{name}: the image, obstacles grown by the robot's radius (orange), keypoints, all "
        "lines between them, those that meet no obstacle, and the first path that the genetic "
        "algorithm found. Start at the lower left, end at the right border.",
        f"Six pictures of {grid.cols} by {grid.rows} pixels: {len(points) - 2} keypoints, "
        f"{len(everything)} lines of which {len(graph.edges)} are free; the path has "
        f"{max(len(first.way_points) - 1, 0)} lines.",
        svg,
        png,
    )
