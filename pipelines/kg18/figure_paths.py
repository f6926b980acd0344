"""One picture a map: the optimal path and paths that genetic algorithms found, from the logs."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.figure import Figure as Canvas
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from gapath.events import Event, RunStarted, TrialFinished
from gapath.pictures.board import draw_map, map_legend, mark_ends
from gapath.pipelines.numbers.text import number
from gapath.pipelines.page.figures import BETWEEN, WIDTH, Look, looks, render, style
from gapath.pipelines.page.section import RECONSTRUCTED, Figure, Section
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.logs import events_of, read_logs, run_start
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "table1"
ORDER = 50

EXAMPLES = 3
"""Paths drawn of each planner: those of its first trials that found one."""


@dataclass(frozen=True, eq=False)
class Found:
    """What a log says about one run: its problem, the optimal path, the first paths found."""

    start: RunStarted
    paths: list[NDArray[np.int32]]


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw each map with example paths.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from, with their logs.

    Returns
    -------
    Section or None
        A figure a map; None if no run has a log of a genetic algorithm.
    """
    examples: dict[str, dict[str, Found]] = defaultdict(dict)
    evolving = set(trials.loc[(trials["epochs"] > 0) & (trials["map_instance"] == 0), "key"])
    runs = [run for run in runs if run.folder.name in evolving]
    read, skipped = read_logs(runs, lambda run: read_found(events_of(run)))
    for run, example in read:
        examples[run.known.map].setdefault(run.known.method, example)
    look = looks(trials.loc[trials["epochs"] > 0, "planner"])
    figures = tuple(_figure(examples[name], look) for name in sorted(examples, key=rank))
    if not figures and not skipped:
        return None
    return Section(
        title="Maps and example paths",
        text=(
            "The brighter a field, the cheaper to pass; the darkest are obstacles. The paper draws "
            "them the other way round: preferred fields black, obstacles white.",
            RECONSTRUCTED,
        ),
        figures=figures,
        skipped=tuple(skipped),
    )


def read_found(events: Iterator[Event]) -> Found:
    """Read a log until enough paths were found.

    Parameters
    ----------
    events : iterator of Event
        A log's events.

    Returns
    -------
    Found
        The run's start, and the paths of its first trials that found one.

    Raises
    ------
    InputError
        If the log does not begin with the run's start, or cannot be read.
    """
    start = run_start(events)
    paths: list[NDArray[np.int32]] = []
    for event in events:
        if isinstance(event, TrialFinished) and event.answer.feasible:
            paths.append(event.answer.path)
            if len(paths) == EXAMPLES:
                break
    return Found(start, paths)


def _figure(examples: dict[str, Found], look: dict[str, Look]) -> Figure:
    start = next(iter(examples.values())).start
    grid = start.problem.map
    title = label(grid.name, grid.source)
    with style():
        canvas = Canvas(figsize=(WIDTH, WIDTH * grid.rows / grid.cols + 1.1), layout="constrained")
        axes = canvas.subplots()
        draw_map(axes, grid.weights)
        handles: list[Artist] = [*map_legend(grid.weights)]
        axes.plot(*start.optimal_path.T, color=BETWEEN, linestyle=":")
        handles.append(Line2D([], [], color=BETWEEN, linestyle=":", label="optimal"))
        for planner, (color, dashes) in look.items():
            paths = examples[planner].paths if planner in examples else []
            name = label(planner) if paths else f"{label(planner)}: none found"
            handles.append(Line2D([], [], color=color, linestyle=dashes, label=name))
            for path in paths:
                axes.plot(*path.T, color=color, linestyle=dashes, linewidth=1.5)
        mark_ends(axes, start.problem.start, start.problem.target)
        axes.set_title(title)
        canvas.legend(handles=handles, loc="outside lower center", ncols=2)
        svg, png = render(canvas)
    counts = ", ".join(f"{label(name)} {len(examples[name].paths)}" for name in examples)
    return Figure(
        f"paths_{grid.name}",
        f"{title}: an optimal path, and paths of the first trials that found one, at most "
        f"{EXAMPLES} of each planner; S is the start, T the target.",
        f"Map of {grid.cols} by {grid.rows} fields, {100 * grid.obstacles.mean():.0f} % of them "
        f"obstacles, start {start.problem.start}, target {start.problem.target}. Optimal cost "
        f"{number(start.optimal_cost)}. Paths drawn: {counts}.",
        svg,
        png,
    )
