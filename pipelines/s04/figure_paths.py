"""S04 Figs 9 and 10: the search spaces with resulting paths, from the logs."""

import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from gapath.events import Evolved, RunStarted
from gapath.kernels.raster import polyline
from gapath.pictures.board import draw_map, mark_ends
from gapath.pipelines.page.figures import INK, Look, looks, panels, render, style
from gapath.pipelines.page.section import DRAWN, Figure, Section
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.logs import events_of, read_logs, run_start
from gapath.pipelines.s04.runs import planner_of
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "s04_table1"
ORDER = 87

PER_FIGURE = 4


class Best:
    """The best of a run's last paths: of fewest collisions, then turns, then steps."""

    def __init__(self, start: RunStarted) -> None:
        self.start = start
        self.path: NDArray[np.int32] | None = None
        self._key = (math.inf, 0, 0)

    def offer(self, path: NDArray[np.int32]) -> None:
        """Take a path if it is better."""
        steps = np.diff(path, axis=0)
        turns = int((steps[1:] != steps[:-1]).any(axis=1).sum())
        key = (len(collisions(self.start, path)), turns, len(path))
        if key < self._key:
            self._key, self.path = key, path


def collisions(start: RunStarted, path: NDArray[np.int32]) -> NDArray[np.int32]:
    """Give the fields of a path that are obstacles or outside the map, (n, 2)."""
    grid = start.problem.map
    x, y = path.T
    inside = (x >= 0) & (x < grid.cols) & (y >= 0) & (y < grid.rows)
    hit = ~inside
    hit[inside] = grid.obstacles[y[inside], x[inside]]
    return np.asarray(path[hit])


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw each search space with the best path of each planner.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from, with their logs.

    Returns
    -------
    Section or None
        The pictures; None if no run has a log.
    """
    found: dict[str, dict[str, Best]] = defaultdict(dict)
    read, skipped = read_logs(runs, read_best)
    for run, best in read:
        found[run.known.map].setdefault(planner_of(run), best)
    names = sorted(found, key=rank)
    if not names and not skipped:
        return None
    look = looks(planner for by_planner in found.values() for planner in by_planner)
    figures = tuple(
        _figure(names[at : at + PER_FIGURE], found, look, at // PER_FIGURE + 1)
        for at in range(0, len(names), PER_FIGURE)
    )
    return Section(
        title="S04's search spaces and resulting paths",
        text=(
            "The best of the paths with which each planner's runs ended: the one with the fewest "
            "collisions, then turns, then steps. Where a planner has none without a collision, the "
            "obstacles that it runs into are marked: as in the paper's Fig. 9, where Hermanu's "
            "planner stands beside the proposed one on SPSet07 and SPSet08.",
            DRAWN,
        ),
        figures=figures,
        skipped=tuple(skipped),
    )


def read_best(run: RunRecord) -> Best:
    """Read a run's log for its best path.

    Parameters
    ----------
    run : RunRecord
        A run with a log.

    Returns
    -------
    Best
        Over its trials.

    Raises
    ------
    InputError
        If the log does not begin with the run's start, or cannot be read.
    """
    events = events_of(run)
    start = run_start(events)
    best = Best(start)
    for event in events:
        if isinstance(event, Evolved):
            best.offer(polyline(event.evolution.way_points[-1]))
    return best


def _figure(
    names: list[str], found: dict[str, dict[str, Best]], look: dict[str, Look], number: int
) -> Figure:
    sentences = []
    with style():
        canvas, axes = panels(len(names), 2.45, same_axes=False)
        for name, panel in zip(names, axes, strict=True):
            start = next(iter(found[name].values())).start
            grid = start.problem.map
            draw_map(panel, grid.weights)
            shift = 0.16 * grid.cols / 10  # side by side, or one would hide the other
            for planner, (color, dashes) in look.items():
                best = found[name].get(planner)
                if best is None or best.path is None:
                    continue
                aside = shift * (list(look).index(planner) - (len(look) - 1) / 2)
                panel.plot(*(best.path + aside).T, color=color, linestyle=dashes, linewidth=1.3)
                hit = collisions(start, best.path)
                panel.plot(*(hit + aside).T, "x", color=color, markersize=4)
                kind = f"{len(hit)} fields in obstacles" if len(hit) else "free"
                sentences.append(f"{label(name)}, {label(planner)}: {kind}.")
            mark_ends(panel, start.problem.start, start.problem.target)
            panel.set(xticks=[], yticks=[])
            panel.set_title(label(name, grid.source))
        handles = [
            Line2D([], [], color=color, linestyle=dashes, label=label(planner))
            for planner, (color, dashes) in look.items()
        ]
        handles.append(Line2D([], [], color=INK, marker="x", linestyle="", label="collision"))
        canvas.legend(handles=handles, loc="outside lower center", ncols=2)
        svg, png = render(canvas)
    return Figure(
        f"s04_paths_{number}",
        f"{label(names[0])} to {label(names[-1])} (reconstructed): the best path of each planner; "
        "S is the start, T the target. Crosses are fields of a path that are obstacles.",
        f"{len(names)} square grids with paths. " + " ".join(sentences),
        svg,
        png,
    )
