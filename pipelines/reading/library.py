"""Runs for who works in Python: a table of them, and one run with all that it kept."""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gapath.driving.retold import Drive
from gapath.errors import InputError, require
from gapath.events import (
    DriveFinished,
    Event,
    Evolved,
    Finished,
    Posed,
    TrialFinished,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.kernels.raster import polyline
from gapath.pictures.shown import Shown
from gapath.pipelines.numbers.grouped import plain
from gapath.pipelines.reading.collect import read_trials
from gapath.pipelines.reading.frame import checked, run_frame
from gapath.pipelines.reading.logs import events_of, has_log, run_start
from gapath.pipelines.reading.results import results_of
from gapath.planning.path import without_stands
from gapath.problem import Plan, Problem, no_path
from gapath.recorders.mcap import FILE
from gapath.running.config import HOW, split
from gapath.running.naming import usual_values
from gapath.running.posing import read_problem
from gapath.running.shards import WHOLE
from gapath.store.records import RunRecord, find_run, find_runs, is_run, read_record
from gapath.store.settings import Value, nested, tabular
from gapath.store.status import Status
from gapath.task import Posing, find_task

if TYPE_CHECKING:
    from gapath.pictures.shown import Axes

_NAMED = 5
"""Runs that a warning names."""


def runs(outputs: str | Path = "outputs") -> pd.DataFrame:
    """Give the runs below a folder as a table.

    Parameters
    ----------
    outputs : str or Path
        The folder that holds ``<experiment>/<key>/``.

    Returns
    -------
    DataFrame
        One row a run, the oldest first; the index `key` is the name of its folder. Columns are
        what was run (experiment, task, map, method, seed, trials, ...), every setting under its
        full name (``planner.population``), the share of trials that succeeded (success), means of
        the other results, and `folder`, which `run` takes.

    Raises
    ------
    InputError
        If there is no such folder, or no run in it.

    Warns
    -----
    UserWarning
        Where runs are left out: those that cannot be used, and those of whose setting another run
        counts (`gapath.pipelines.reading.counted`).
    """
    found = sorted(find_runs(Path(outputs)), key=lambda run: (run.date, run.name))
    frame = run_frame(found).assign(folder=[str(run.folder) for run in found])
    frame = frame.astype({"folder": "str"})
    why = frame.pop("fault").fillna(frame.pop("superseded") + " counts, of the same setting")
    out = why.notna()
    if out.any():
        told = [f"{key}: {reason}" for key, reason in why[out].items()]
        more = [f"and {len(told) - _NAMED} more"] if len(told) > _NAMED else []
        text = "; ".join([*told[:_NAMED], *more])
        warnings.warn(f"{len(told)} of {len(frame)} runs left out: {text}", stacklevel=2)
    return frame[~out]


def run(folder: str | Path, key: str | None = None) -> "Run":
    """Give one run.

    Parameters
    ----------
    folder : str or Path
        The run's folder, as in the column `folder` of `runs`; with a key the folder that holds
        ``<experiment>/<key>/``.
    key : str, optional
        The run's key, or so much of its beginning that no other run's begins alike.

    Returns
    -------
    Run
        The run, also one that failed or is at work: what it lacks raises when it is asked for.

    Raises
    ------
    InputError
        If there is no such run, or more than one.
    """
    place = Path(folder)
    require(place.is_dir(), folder, "no such folder", "a folder")
    if key is None:
        right = "the folder of a run, or that of all runs and the beginning of a key"
        require(is_run(place), folder, "no run", right)
        return Run(checked(read_record(place)))
    return Run(checked(read_record(find_run(place, key))))


@dataclass(frozen=True, eq=False)
class Run(Shown):
    """A run: what was set, how it went, and what it kept.

    Parameters
    ----------
    record : RunRecord
        What its folder says.

    Raises
    ------
    InputError
        Of each attribute: if the run cannot be used, or did not keep that.
    """

    record: RunRecord

    def __repr__(self) -> str:
        return f"gapath.run({str(self.folder)!r})"

    @property
    def key(self) -> str:
        """Its key, the name of its folder."""
        return self.record.folder.name

    @property
    def folder(self) -> Path:
        """Its folder."""
        return self.record.folder

    @property
    def status(self) -> Status:
        """How far it is; that of every run can be asked for."""
        return self.record.status

    @property
    def settings(self) -> dict[str, Value]:
        """Its settings under their full names, ``planner.population``; lists as JSON."""
        return tabular(self.record.settings)

    @cached_property
    def trials(self) -> pd.DataFrame:
        """Its trials, a row each; what all of them were set to is in `settings`."""
        self._usable()
        collected = read_trials([self.record])
        for skipped in collected.skipped:
            raise InputError(skipped.run, skipped.reason, "a run that can be used")
        return plain(collected.trials[self.record.known.task])

    @property
    def log(self) -> Iterator[Event]:
        """The events of its log, from the first on, each time that it is asked for."""
        self._usable()
        right = "one, which recorder=mcap keeps"
        require(has_log(self.record), f"{self.record.name}, log", "none", right)
        return events_of(self.record)

    @cached_property
    def problem(self) -> Problem:
        """Map, start, target and rule: from the log, or read again where none was kept.

        Read again, the map must be what it was, and files are looked for where they were.
        """
        self._usable()
        if has_log(self.record):
            return run_start(self.log).problem
        usual, known = usual_values(), self.record.known
        how = {name: usual[name] for name in HOW}
        root, chosen = split(WHOLE | nested(self.record.settings) | how)
        task = find_task(root.task)
        made = task.make(chosen) if issubclass(task, Posing) else None
        problem = read_problem(root.map, root.corner_cutting, made, {})
        right = f"the map as it was, {known.map_digest[:12]}"
        require(problem.map.digest == known.map_digest, "map", problem.map.digest[:12], right)
        return problem

    @property
    def map(self) -> GridMap:
        """Its map: from the log, or read again where none was kept."""
        return self.problem.map

    def trial(self, number: int = 0) -> Plan | Drive:
        """Give a trial as it was, from the log.

        Parameters
        ----------
        number : int
            Its number, from 0.

        Returns
        -------
        Plan or Drive
            By what the run's trials are.

        Raises
        ------
        InputError
            If there is no such trial, no log, or it is neither a plan nor a drive.
        """
        self._usable()
        last = self.record.known.trials - 1
        require(0 <= number <= last, "trial", number, f"an integer from 0 to {last}")
        events = self._events(number)
        end = events[-1]
        if isinstance(end, TrialFinished):
            return _plan(self._asked(events), events, end)
        where, right = f"{self.record.name}, trial {number}", "a plan or a drive"
        require(isinstance(end, DriveFinished), where, type(end).__name__, right)
        return Drive(self.problem, events)

    def _asked(self, events: list[Event]) -> Problem:
        """Give the problem of a trial; raises InputError where start or target is blocked."""
        posed = next((event for event in events if isinstance(event, Posed)), None)
        if posed is None:
            return self.problem
        return replace(self.problem, start=posed.start, target=posed.target)

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw its first trial, without a log its map (`Shown.plot`)."""
        self._usable()
        return self.trial().plot(ax) if has_log(self.record) else self.problem.plot(ax)

    def _usable(self) -> None:
        require(not self.record.fault, self.record.name, self.record.fault, "a run that is whole")

    def _events(self, number: int) -> list[Event]:
        """Read the events of a trial, from its start to its end."""
        found: list[Event] = []
        for event in self.log:
            mine = isinstance(event, TrialStarted) and event.trial == number
            if found or mine:
                found.append(event)
            if found and isinstance(event, Finished):
                return found
        raise InputError(f"{self.record.name}, {FILE}", f"no trial {number}", "the run's trials")

    def _told(self) -> dict[str, object]:
        told: dict[str, object] = {"key": self.key, "state": self.record.state}
        if self.record.fault:
            return told | {"fault": self.record.fault}
        known, came = self.record.known, results_of(self.record)
        return told | {
            "experiment": known.experiment,
            "map": known.map,
            "method": known.method,
            "seed": known.seed,
            "trials": f"{came.succeeded} of {came.trials} succeeded",
        }


def _plan(problem: Problem, events: list[Event], end: TrialFinished) -> Plan:
    evolution = next((event.evolution for event in events if isinstance(event, Evolved)), None)
    points = no_path()
    if evolution is not None and end.answer.feasible:
        points = without_stands(evolution.way_points[-1])
        if not np.array_equal(polyline(points), end.answer.path):
            points = no_path()
    return Plan(**vars(end.answer), trace=lambda: evolution, lines=lambda: points, problem=problem)
