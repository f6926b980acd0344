"""M22 Sec. IV: concave obstacles, on which its keypoints fail, and corners, which repair it."""

from collections.abc import Sequence

import pandas as pd

from gapath.pictures.board import draw_lines, draw_picture
from gapath.pipelines.m22.logs import First, read_first
from gapath.pipelines.numbers.summary import summarise_by
from gapath.pipelines.numbers.text import number, percent, percent_range
from gapath.pipelines.page.figures import panels, render, style
from gapath.pipelines.page.section import Figure, Section, Table
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.logs import read_logs
from gapath.problem import PlanStatus
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "m22_concave"
ORDER = 96

DRAWN_WITH = ("visibility_ga", "visibility_ga_corners")


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section:
    """Make the section on concave obstacles.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from, with their logs.

    Returns
    -------
    Section
        How often each planner found a path, and the graphs of both kinds of keypoints.
    """
    graphs: dict[str, First] = {}
    drawn = [run for run in runs if run.known.method in DRAWN_WITH]
    read, skipped = read_logs(drawn, read_first)
    for run, first in read:
        if first.graph is not None:
            graphs.setdefault(run.known.method, first)
    return Section(
        title="M22: a concave obstacle",
        text=(
            "The paper names concave obstacles as a weakness of its keypoints: the ends of the "
            "main axes of a U lie where they help nobody out of it. Outward corners of obstacles "
            "as keypoints (planner.keypoints=corners) lead around it.",
        ),
        tables=(_table(trials),),
        figures=(_figure(graphs),) if graphs else (),
        skipped=tuple(skipped),
    )


def _table(trials: pd.DataFrame) -> Table:
    rows = summarise_by(trials, ["map", "map_source", "planner"])
    lengths = trials.groupby(["map", "planner"])["line_length"].mean()
    rows["f"] = [lengths[row["map"], row["planner"]] for _, row in rows.iterrows()]
    ends = trials.groupby(["map", "planner"])["status"].agg(
        lambda s: (s == PlanStatus.INFEASIBLE.name.lower()).mean()
    )
    rows["infeasible"] = [ends[row["map"], row["planner"]] for _, row in rows.iterrows()]
    shown = [
        {
            "Map": label(row["map"], row["map_source"]),
            "Method": label(row["planner"]),
            "Trials": number(row["n"]),
            "Found, %": percent(row["success"]),
            "95 %": percent_range((row["success_low"], row["success_high"])),
            "No path in the graph, %": percent(row["infeasible"]),
            "f": number(row["f"]),
            "Time, ms": number(1000 * row["seconds_median"]),
        }
        for _, row in rows.iterrows()
    ]
    return Table(
        "m22_concave",
        "A U with the start in it. Found: with the 95 % Wilson interval; f: mean length of paths "
        "found, in fields; time: median.",
        rows,
        pd.DataFrame(shown),
    )


def _figure(graphs: dict[str, First]) -> Figure:
    names = sorted(graphs, key=rank)
    sentences = []
    with style():
        canvas, axes = panels(len(names), 1.75, same_axes=False)
        for panel, name in zip(axes, names, strict=True):
            first = graphs[name]
            graph = first.graph
            assert graph is not None
            grid = first.start.problem.map
            draw_picture(panel, grid.obstacles, graph.grown(grid.rows, grid.cols))
            draw_lines(panel, graph.points, graph.edges)
            if len(first.way_points):
                panel.plot(*first.way_points.T, color="#F0E442", linewidth=1.2)
            panel.set_title(label(name))
            sentences.append(
                f"{label(name)}: {len(graph.points) - 2} keypoints, {len(graph.edges)} free lines, "
                f"{'a path' if len(first.way_points) else 'no path'}."
            )
        svg, png = render(canvas)
    return Figure(
        "m22_concave",
        "Keypoints and free lines around a U, obstacles grown (orange), with the first path found "
        "(yellow), if any: M22's keypoints are ends of main axes, corners those of the outline.",
        " ".join(sentences),
        svg,
        png,
    )
