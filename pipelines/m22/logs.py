"""What M22's figures take from the log of a run."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gapath.events import Evolved, RunStarted, Surveyed, TrialFinished
from gapath.history.graph import Graph
from gapath.pipelines.reading.logs import events_of, run_start
from gapath.planning.path import without_stands
from gapath.store.records import RunRecord


@dataclass(frozen=True, eq=False)
class First:
    """A run's start, its graph, and its first trial that found a path.

    Parameters
    ----------
    start : RunStarted
        What the log says of the run.
    graph : Graph or None
        What the planner made of the map.
    way_points : (n, 2) int32
        Of the first path found, each once, for a search all its fields; empty if no trial found
        one.
    best : (E,) float64
        f by generation of that trial.
    """

    start: RunStarted
    graph: Graph | None
    way_points: NDArray[np.int32]
    best: NDArray[np.float64]


def read_first(run: RunRecord) -> First:
    """Read a run's log up to its first path.

    Parameters
    ----------
    run : RunRecord
        A run with a log.

    Returns
    -------
    First
        Its start, and of its trials the first that found one.

    Raises
    ------
    InputError
        If the log does not begin with the run's start, or cannot be read.
    """
    events = events_of(run)
    start, graph = run_start(events), None
    way_points, best = np.empty((0, 2), dtype=np.int32), np.empty(0)
    for event in events:
        if isinstance(event, Surveyed):
            graph = event.graph
        elif isinstance(event, Evolved):
            way_points, best = event.evolution.way_points[-1], event.evolution.best
        elif isinstance(event, TrialFinished) and event.answer.feasible:
            if not len(best):  # a search: its path is all there is
                way_points = event.answer.path
            return First(start, graph, without_stands(way_points), best)
    return First(start, graph, np.empty((0, 2), dtype=np.int32), np.empty(0))
