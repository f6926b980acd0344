"""KG18 Figs 16, 18, 20 and 22: where robots went, on the true map, from the logs."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.figure import Figure as Canvas
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from gapath.events import DriveFinished, Event, Outcome, RunStarted, Stepped
from gapath.pictures.board import draw_map, map_legend, mark_ends
from gapath.pipelines.page.figures import BETWEEN, WIDTH, render, style
from gapath.pipelines.page.section import RECONSTRUCTED, Figure, Section
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.logs import events_of, read_logs, run_start
from gapath.store.records import RunRecord

TASK = "drive"
EXPERIMENT = "drives"
ORDER = 62

EXAMPLES = 2
"""Drives drawn of KG18, the first that reached the target; and the first that did not."""

_LOOKS: dict[tuple[str, bool], tuple[str, Any]] = {
    ("kg18", True): ("#0072B2", "-"),
    ("kg18", False): ("#D55E00", (0, (5, 1.5))),
    ("replan_astar", True): ("#009E73", (0, (1.5, 1))),
    ("replan_astar", False): ("#009E73", (0, (1.5, 1))),
}
"""Colour and dashes of a navigator's drives that reached the target, and of the others."""


@dataclass(frozen=True, eq=False)
class Trail:
    """A drive: the fields on which the robot was, and how it ended."""

    places: NDArray[np.int32]
    outcome: Outcome


@dataclass(frozen=True, eq=False)
class Driven:
    """What a log says about one run: its problem and some drives."""

    start: RunStarted
    trails: list[Trail]


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw each map with the trails of some drives.

    Parameters
    ----------
    trials : DataFrame
        The drives of the experiment.
    runs : sequence of RunRecord
        The runs they come from, with their logs.

    Returns
    -------
    Section or None
        A figure a map; None if no run has a log of a drive.
    """
    examples: dict[str, dict[str, Driven]] = defaultdict(dict)
    drawn = [
        run for run in runs if (run.known.method, True) in _LOOKS and not run.known.map_instance
    ]
    read, skipped = read_logs(drawn, lambda run: read_trails(events_of(run), _wanted(trials, run)))
    for run, driven in read:
        examples[run.known.map].setdefault(run.known.method, driven)
    figures = tuple(_figure(examples[name]) for name in sorted(examples, key=rank))
    if not figures and not skipped:
        return None
    return Section(
        title="Unknown maps and example drives",
        text=(
            "The robot started without knowing any obstacle; the map drawn is the true one.",
            RECONSTRUCTED,
        ),
        figures=figures,
        skipped=tuple(skipped),
    )


def _wanted(trials: pd.DataFrame, run: RunRecord) -> set[int]:
    """Choose which drives of a run to draw."""
    drives = trials[trials["key"] == run.folder.name].sort_values("trial")
    reached = drives.loc[drives["reached"], "trial"]
    failed = drives.loc[~drives["reached"], "trial"]
    return {*reached[: EXAMPLES if run.known.method == "kg18" else 1], *failed[:1]}


def read_trails(events: Iterator[Event], wanted: set[int]) -> Driven:
    """Read drives from a log, no further than the last wanted one.

    Parameters
    ----------
    events : iterator of Event
        A log's events.
    wanted : set of int
        Numbers of trials.

    Returns
    -------
    Driven
        The run's start and the wanted drives, in order.

    Raises
    ------
    InputError
        If the log does not begin with the run's start, or cannot be read.
    """
    start = run_start(events)
    places: list[tuple[int, int]] = []
    trails: list[Trail] = []
    for event in events:
        if len(trails) == len(wanted):
            break
        if isinstance(event, Stepped) and event.trial in wanted:
            places.append(event.place)
        elif isinstance(event, DriveFinished) and event.trial in wanted:
            trails.append(Trail(np.array(places, dtype=np.int32), event.outcome))
            places = []
    return Driven(start, trails)


def _figure(examples: dict[str, Driven]) -> Figure:
    start = next(iter(examples.values())).start
    grid = start.problem.map
    title = label(grid.name, grid.source)
    sentences = []
    with style():
        canvas = Canvas(figsize=(WIDTH, WIDTH * grid.rows / grid.cols + 1.1), layout="constrained")
        axes = canvas.subplots()
        draw_map(axes, grid.weights)
        handles: list[Artist] = [*map_legend(grid.weights)]
        if len(start.optimal_path):
            axes.plot(*start.optimal_path.T, color=BETWEEN, linestyle=":")
            handles.append(Line2D([], [], color=BETWEEN, linestyle=":", label="shortest"))
        for navigator in sorted(examples, key=rank):
            for trail in examples[navigator].trails:
                reached = trail.outcome is Outcome.REACHED
                color, dashes = _LOOKS[navigator, reached]
                ended = trail.outcome.name.lower()
                text = label(navigator) if reached else f"{label(navigator)}, {ended}"
                axes.plot(*trail.places.T, color=color, linestyle=dashes, linewidth=1.2)
                if text not in [handle.get_label() for handle in handles]:
                    handles.append(Line2D([], [], color=color, linestyle=dashes, label=text))
                sentences.append(f"{label(navigator)} {ended}, {len(trail.places) - 1} steps.")
        mark_ends(axes, start.problem.start, start.problem.target)
        axes.set_title(title)
        canvas.legend(handles=handles, loc="outside lower center", ncols=2)
        svg, png = render(canvas)
    return Figure(
        f"drive_paths_{grid.name}",
        f"{title}: the trails of the first {EXAMPLES} drives of KG18 that reached the target, of "
        "the first that did not if there is one, and of repeated A*; dotted, a path of fewest "
        "steps for who knows the map; S is the start, T the target.",
        f"Map of {grid.cols} by {grid.rows} fields, {100 * grid.obstacles.mean():.0f} % of them "
        f"obstacles, start {start.problem.start}, target {start.problem.target}. Drives drawn: "
        + " ".join(sentences),
        svg,
        png,
    )
