"""S04 Figs 9 and 10: the search spaces with resulting paths, from the logs."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from gapath.errors import InputError
from gapath.events import Evolved, RunStarted, TrialFinished
from gapath.kernels.raster import polyline
from gapath.recorders.mcap import FILE, read_events

from .figures import Look, looks, panels, render, style
from .map_picture import draw_map, mark_ends
from .names import label, rank
from .runs import Run
from .section import RECONSTRUCTED, Figure, Section

TASK = "plan"
EXPERIMENT = "s04_table1"
ORDER = 32

PER_FIGURE = 4


class Best:
    """The best path of a run: the feasible one of fewest turns, else the last fittest one."""

    def __init__(self, start: RunStarted) -> None:
        self.start = start
        self.path: NDArray[np.int32] | None = None
        self.feasible = False
        self._key = (2, 0, 0)

    def offer(self, path: NDArray[np.int32], feasible: bool) -> None:
        """Take a path if it is better: feasible, then of fewer turns, then shorter."""
        steps = np.diff(path, axis=0)
        turns = int((steps[1:] != steps[:-1]).any(axis=1).sum())
        key = (0 if feasible else 1, turns, len(path))
        if key < self._key:
            self._key, self.path, self.feasible = key, path, feasible


def section(trials: pd.DataFrame, runs: Sequence[Run]) -> Section | None:
    """Draw each search space with the best path of each planner.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of Run
        The runs they come from, with their logs.

    Returns
    -------
    Section or None
        The pictures; None if no run has a log.
    """
    found: dict[str, dict[str, Best]] = defaultdict(dict)
    skipped = []
    for run in runs:
        if FILE not in run.manifest["files"]:
            continue
        try:
            best = read_best(run)
        except InputError as error:
            skipped.append((run.name, str(error)))
        else:
            planner = run.manifest["planner"].partition("[")[0]
            found[run.manifest["map"]].setdefault(planner, best)
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
            "The best path of each planner's runs: of those without a collision the one with the "
            "fewest turns. Where a planner has none, its fittest path is drawn, with the obstacles "
            "that it runs into: as the paper's Fig. 9 shows Hermanu's planner on SPSet07 and "
            "SPSet08.",
            RECONSTRUCTED,
        ),
        figures=figures,
        skipped=tuple(skipped),
    )


def read_best(run: Run) -> Best:
    """Read a run's log for its best path.

    Parameters
    ----------
    run : Run
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
    events = read_events(run.folder / FILE)
    start = next(events, None)
    if not isinstance(start, RunStarted):
        raise InputError(FILE, type(start).__name__, "RunStarted as the first event")
    best, fittest = Best(start), None
    for event in events:
        if isinstance(event, Evolved):
            fittest = polyline(event.evolution.way_points[-1])
        elif isinstance(event, TrialFinished) and fittest is not None:
            feasible = len(event.path) > 0
            best.offer(event.path if feasible else fittest, feasible)
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
                x, y = best.path.T
                hit = best.path[grid.obstacles[y, x]]
                panel.plot(*hit.T, "x", color=color, markersize=4)
                kind = "free" if best.feasible else f"{len(hit)} fields in obstacles"
                sentences.append(f"{label(name)}, {label(planner)}: {kind}.")
            mark_ends(panel, start.problem)
            panel.set(xticks=[], yticks=[])
            panel.set_title(label(name))
        handles = [
            Line2D([], [], color=color, linestyle=dashes, label=label(planner))
            for planner, (color, dashes) in look.items()
        ]
        handles.append(Line2D([], [], color="black", marker="x", linestyle="", label="collision"))
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
