"""Stills of a run, drawn from its log: the map, and paths over it."""

import base64
import io
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from gapath.errors import InputError
from gapath.events import Event, Evolved, Finished, Posed, RunStarted, Stepped, TrialFinished
from gapath.grid import Field, GridMap
from gapath.pipelines.reading.logs import events_of, has_log, run_start
from gapath.querying.told import posed_in
from gapath.recorders.mcap import FILE
from gapath.store.records import RunRecord

MOST_RUNS, MOST_BYTES = 100, 1 << 25
"""Only so many runs get stills, whose logs have so many bytes in all: the newest that fit."""

_TRIALS = 5
"""Trials whose paths are drawn: a log is read further only where these tell what found the path."""

_SIDE = 512
"""Longest side of a map's picture; a larger map is drawn smaller."""


class Asked(NamedTuple):
    """What was asked: letters and fields of starts and targets, points of best paths."""

    ends: list[tuple[str, int, int]]
    least: list[str]


class Still(NamedTuple):
    """A picture: lines, each as SVG writes its points, what they are, and what was asked."""

    caption: str
    lines: list[str]
    asked: Asked


class Stills(NamedTuple):
    """Pictures of one run on its map.

    Parameters
    ----------
    map : str
        Data URI of a PNG, see-through where a field costs little.
    cols, rows : int
        Size of the map.
    size : float
        Of the marks of starts and targets, in fields.
    stills : list of Still
        The pictures.
    shares : list of dict of str to float
        What found the path, of each trial that tells it (`Population.shares`): name -> cost.
    """

    map: str
    cols: int
    rows: int
    size: float
    stills: list[Still]
    shares: list[dict[str, float]]


def newest_logs(runs: Iterable[RunRecord]) -> set[str]:
    """Choose the runs that get stills, the same ones of the same runs each time.

    Parameters
    ----------
    runs : iterable of RunRecord
        Runs that can be used.

    Returns
    -------
    set of str
        Names of their folders.
    """
    logged = sorted(filter(has_log, runs), key=lambda run: (run.date, run.name), reverse=True)
    chosen: set[str] = set()
    room = MOST_BYTES
    for run in logged:
        size = run.known.files[FILE].bytes
        if len(chosen) < MOST_RUNS and size <= room:
            chosen.add(run.folder.name)
            room -= size
    return chosen


def stills_of(run: RunRecord) -> Stills | str:
    """Draw a run.

    Parameters
    ----------
    run : RunRecord
        A run with a log.

    Returns
    -------
    Stills or str
        The pictures: the first trial as it went on, and the ways of the first trials; why there
        are none where the log cannot be read.
    """
    try:
        events = events_of(run)
        start = run_start(events)
        grid = start.problem.map
        stills, shares = _stills(events, start)
    except InputError as error:
        return str(error)
    size = max(0.4, max(grid.cols, grid.rows) / 45)
    return Stills(_picture(grid), grid.cols, grid.rows, size, stills, shares)


def _asked(posed: Posed) -> Asked:
    least = _points(posed.optimal_path)
    return Asked([("S", *posed.start), ("T", *posed.target)], [least] if least else [])


def _stills(
    events: Iterator[Event], start: RunStarted
) -> tuple[list[Still], list[dict[str, float]]]:
    history: list[Still] = []
    shared = _asked(posed_in(start, ()))
    own: list[Asked] = []
    shares: list[dict[str, float]] = []
    ways: list[str] = []
    places: list[Field] = []
    ended = 0
    for event in events:
        if isinstance(event, Evolved):
            history = history or _epochs(event, own[-1] if own else shared)
            if population := event.evolution.population:
                shares.append(dict(zip(population.names, population.shares, strict=True)))
        elif isinstance(event, Posed):
            own.append(_asked(event))
        elif isinstance(event, Stepped):
            places.append(event.place)
        elif isinstance(event, Finished):
            ended += 1
            if places and not history:
                history = _steps(event, places, shared)
            if ended <= _TRIALS:
                way = _points(event.answer.path if isinstance(event, TrialFinished) else places)
                ways += [way] if way else []
            places = []
            if ended >= _TRIALS and not shares:
                break
    drawn = min(ended, _TRIALS)
    them = "The first trial" if drawn == 1 else f"The first {drawn} trials"
    own = own[:_TRIALS]
    both = Asked([end for one in own for end in one.ends], [a for one in own for a in one.least])
    last = Still(f"{them}: {len(ways)} with a way to show", ways, both if own else shared)
    return [*history, last], shares


def _epochs(event: Evolved, asked: Asked) -> list[Still]:
    evolution = event.evolution
    last = len(evolution.best)
    return [
        Still(
            f"Trial {event.trial}, epoch {epoch} of {last}: best fitness "
            f"{evolution.best[epoch - 1]:.6g}",
            [_points(evolution.way_points[epoch - 1])],
            asked,
        )
        for epoch in sorted({1, (last + 1) // 2, last})
    ]


def _steps(event: Finished, places: Sequence[Field], asked: Asked) -> list[Still]:
    last = len(places) - 1
    return [
        Still(f"Trial {event.trial}, step {step} of {last}", [_points(places[: step + 1])], asked)
        for step in sorted({last // 3, 2 * last // 3})
    ] + [Still(f"Trial {event.trial}, {event.ending} after {last} steps", [_points(places)], asked)]


def _points(path: NDArray[np.int32] | Sequence[Field]) -> str:
    """Write fields as SVG writes points; the one that repeats at the end once."""
    fields = [tuple(map(int, field)) for field in path]
    while len(fields) > 1 and fields[-1] == fields[-2]:
        del fields[-1]
    return " ".join(f"{x},{y}" for x, y in fields)


def _picture(grid: GridMap) -> str:
    alpha = np.where(grid.obstacles, 235, 12 + 80 * grid.weights).astype(np.uint8)
    picture = Image.merge(
        "LA", (Image.new("L", (grid.cols, grid.rows), 112), Image.fromarray(alpha))
    )
    picture.thumbnail((_SIDE, _SIDE), Image.Resampling.BOX)
    stream = io.BytesIO()
    picture.save(stream, "PNG", optimize=True)
    return f"data:image/png;base64,{base64.b64encode(stream.getvalue()).decode()}"
