"""Whether the events of a log make sense, before anybody draws them: it may come from anywhere."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gapath.errors import InputError
from gapath.events import (
    Called,
    DriveFinished,
    DriveStarted,
    Event,
    Evolved,
    Finished,
    PathsChanged,
    Posed,
    RunFinished,
    RunStarted,
    Stepped,
    Surveyed,
    TrialFinished,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.kernels.units import OBSTACLE
from gapath.recorders.mcap.file.walk import LARGE, Limits
from gapath.recorders.mcap.reader import WHOLE, read_events, refusing

_FAR = 1 << 20  # control points may leave the map, but not for ever
_LAYERS, _STEPS, _TRIALS = 1000, 10**6, 10**6  # a sensor's, a drive's and a run's most
_LAST = 10**13  # steps of a run


def read_sound(path: str | Path, limits: Limits = LARGE) -> Iterator[Event]:
    """Read a whole log whose events can be drawn.

    Parameters
    ----------
    path : str or Path
        A log written by `Recorder`.
    limits : Limits
        What it may take.

    Yields
    ------
    Event
        As `gapath.recorders.mcap.reader.read_events`.

    Raises
    ------
    InputError
        As there; or where an event's numbers fit neither the run's map nor the other events.
    """
    with refusing(path, WHOLE):
        sound: _Sound | None = None
        for event in read_events(path, limits):
            if isinstance(event, RunStarted):
                sound = _Sound(event)
            assert sound is not None, "the reader gives the run's first event first"
            if not sound.fits(event):
                what = f"{type(event).__name__} of step {getattr(event, 'step', 0)}"
                raise InputError("event", what, "one that fits the map and the events before it")
            yield event


class _Sound:
    """What the events so far were."""

    def __init__(self, run: RunStarted) -> None:
        self._run, self._grid = run, run.problem.map
        self._step, self._trial, self._last = 0, -1, -1
        self._drives = False

    def fits(self, event: Event) -> bool:
        """Tell whether an event makes sense after those before it."""
        if isinstance(event, RunStarted):
            return self._run.trials <= _TRIALS and self._on_map(event.optimal_path)
        if not self._step <= event.step <= _LAST:
            return False
        self._step = event.step
        if isinstance(event, RunFinished):
            return self._trial < 0
        if isinstance(event, TrialStarted):
            good = self._trial < 0 and self._last < event.trial < self._run.trials
            self._trial, self._drives = event.trial, False
            return good
        good = event.trial == self._trial and self._inside(event)
        if isinstance(event, Finished):
            self._last, self._trial = self._trial, -1
        return good

    def _inside(self, event: Event) -> bool:
        """Tell whether an event of a trial fits the map and the trial."""
        match event:
            case Posed():
                ends = np.array([event.start, event.target])
                return self._on_map(ends) and self._on_map(event.optimal_path)
            case Evolved(_, _, _, evolution):
                population = evolution.population
                parts = [evolution.way_points, *([population.vertices] if population else [])]
                return all(_near(part) for part in (evolution.chromosomes, *parts))
            case Surveyed(_, _, graph):
                rows, cols = graph.obstacles.shape
                fits = rows <= self._grid.rows and cols <= self._grid.cols
                return fits and graph.block <= _FAR and _near(graph.points)
            case TrialFinished():
                return not self._drives and self._on_map(event.answer.path)
            case DriveStarted():
                first, self._drives = not self._drives, True
                limits = event.sensor_range <= _LAYERS and event.step_limit <= _STEPS
                return first and limits and 0 <= event.unknown_weight <= 1
            case Called():
                named = len(event.part) == 1 and event.index < _LAYERS
                return named and self._on_map(event.answer.path)
            case PathsChanged():
                return self._on_map(event.path) and self._on_map(event.past)
            case Stepped():
                return self._seen(event)
            case DriveFinished():
                return event.stands <= event.steps <= _STEPS
        return True

    def _seen(self, event: Stepped) -> bool:
        entries = event.entries
        good = 0 <= event.heading < 8 and len(entries) == len(event.fields)
        known = ((entries >= 0) & (entries <= OBSTACLE)).all()
        places = np.array([event.place, *event.fields.tolist()])
        return bool(good and known) and self._on_map(places)

    def _on_map(self, fields: NDArray[np.int32]) -> bool:
        return _on_map(self._grid, fields)


def _on_map(grid: GridMap, fields: NDArray[np.int32]) -> bool:
    shaped = fields.ndim == 2 and fields.shape[1] == 2
    return shaped and bool(((fields >= 0) & (fields < (grid.cols, grid.rows))).all())


def _near(numbers: NDArray[np.int32]) -> bool:
    return bool(((numbers > -_FAR) & (numbers < _FAR)).all())
