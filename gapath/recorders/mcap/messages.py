"""Events as ROS 2 messages in CDR, and back; those of drives: `drive_messages`."""

import struct
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any

import numpy as np

from gapath.errors import InputError, require
from gapath.events import (
    Called,
    DriveFinished,
    DriveStarted,
    Event,
    Evolved,
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
from gapath.history.evolution import Evolution
from gapath.history.graph import Graph
from gapath.recorders.mcap import drive_messages
from gapath.recorders.mcap.cdr import (
    ENCAPSULATION,
    INFO,
    WARN,
    Record,
    answer_numbers,
    arrays_cdr,
    frames_record,
    in_metres,
    log_record,
    occupancy_grid_cdr,
    path_cdr,
    per_cent,
    pose_record,
    read_answer,
    record,
    strings_cdr,
)
from gapath.recorders.mcap.format import TOPICS, TYPES, Form
from gapath.recorders.mcap.memetic_message import TOPIC as MEMETIC_RUN
from gapath.recorders.mcap.memetic_message import memetic_run, read_memetic_run
from gapath.store.settings import text_of

# What every trial writes is packed by hand, three times faster than by rosbags.
_INT32, _FLOAT64 = np.dtype("<i4"), np.dtype("<f8")
_TRIAL = struct.Struct("<QQ")
_GA_RUN = struct.Struct("<QQII")
_QUERY = struct.Struct("<QdI4i")
_RESULT = struct.Struct("<QQQQQdddB?2x")  # padded for the count that follows


class Messages:
    """Turns the events of a run into messages.

    Parameters
    ----------
    run : RunStarted
        The run's first event, for its map and settings.
    form : Form
        The log's.
    """

    def __init__(self, run: RunStarted, form: Form) -> None:
        self._run, self._form = run, form
        self._settings = text_of(run.settings)

    @cached_property
    def _drive(self) -> drive_messages.DriveMessages:
        """Of drives alone: the known map takes four bytes a field."""
        return drive_messages.DriveMessages(self._run, self._form.step_ns)

    def records(self, event: Event) -> Iterator[Record]:
        """Turn an event into the messages that log it.

        Parameters
        ----------
        event : Event
            Any event of the run, in the order of the run.

        Yields
        ------
        Record
            Messages in the order of the log.
        """
        time = getattr(event, "step", 0) * self._form.step_ns
        match event:
            case RunStarted():
                yield from _run_started(event, self._form)
            case TrialStarted(_, trial, seed):
                texts = strings_cdr(self._run.method, self._settings)
                yield Record("/trial_start", time, ENCAPSULATION + _TRIAL.pack(trial, seed) + texts)
            case Posed():
                yield from _posed(event, time, self._run.problem.map)
            case Evolved():
                population = event.evolution.population
                yield memetic_run(event, population, time) if population else _ga_run(event, time)
            case Surveyed(_, trial, (obstacles, block, points, edges)):
                picture = np.packbits(obstacles)
                fields = (picture, points.ravel(), edges.ravel())
                yield record("/graph", time, trial, *obstacles.shape, block, *fields)
            case TrialFinished():
                yield from _trial_finished(event, time, self._run.problem.map)
            case DriveStarted():
                yield from self._drive.started(event)
            case Stepped():
                yield from self._drive.stepped(event)
            case Called():
                yield from self._drive.called(event)
            case PathsChanged():
                yield from self._drive.paths_changed(event)
            case DriveFinished():
                yield from self._drive.finished(event)
            case RunFinished(_, trials, found):
                yield log_record(time, INFO, f"run finished: {found} of {trials} trials succeeded")
                yield record("/run_end", time, trials, found)
            case _:
                kind = type(event).__name__
                raise InputError("recorder.mcap", f"an event {kind}", "one of gapath.events")


def count_first(run: RunStarted, form: Form) -> int:
    """Count the messages that a run's first event comes to, without making them."""
    return 4 + (len(run.optimal_path) > 0) + form.is_bag


def _run_started(run: RunStarted, form: Form) -> Iterator[Record]:
    problem, grid = run.problem, run.problem.map
    shown = np.empty(grid.weights.shape, dtype=np.int8)
    for row, entries in zip(shown, grid.table, strict=True):  # numbers between take 8 times as much
        row[:] = per_cent(entries)
    yield Record("/map", 0, occupancy_grid_cdr(grid, shown))
    yield pose_record("/start", 0, in_metres(grid, problem.start))
    yield pose_record("/target", 0, in_metres(grid, problem.target))
    if len(run.optimal_path):
        yield Record("/optimal_path", 0, path_cdr(0, grid.to_metres(run.optimal_path)))
    if form.is_bag:
        yield frames_record()
    text = (
        f"run started: {run.experiment}, {run.method} on {grid.name} "
        f"from {problem.told}, seed {run.seed}, {run.trials} trials"
    )
    yield log_record(0, INFO, text)


def _posed(event: Posed, time: int, grid: GridMap) -> Iterator[Record]:
    path = event.optimal_path
    yield pose_record("/start", time, in_metres(grid, event.start))
    yield pose_record("/target", time, in_metres(grid, event.target))
    yield Record("/optimal_path", time, path_cdr(time, grid.to_metres(path)))
    ends = (*event.start, *event.target)
    head = _QUERY.pack(event.trial, event.optimal_cost, event.number, *ends)
    yield Record("/query", time, arrays_cdr(head, np.asarray(path, _INT32)))


def _ga_run(event: Evolved, time: int) -> Record:
    best, mean, chromosomes, way_points, genotype, _ = event.evolution
    head = _GA_RUN.pack(event.trial, event.call, chromosomes.shape[1], way_points.shape[1])
    rows = (
        np.asarray(chromosomes, _INT32),
        np.asarray(way_points, _INT32),
        np.asarray(best, _FLOAT64),
        np.asarray(mean, _FLOAT64),
    )
    return Record("/ga_run", time, arrays_cdr(head, *rows) + strings_cdr(genotype))


def _trial_finished(event: TrialFinished, time: int, grid: GridMap) -> Iterator[Record]:
    answer = event.answer
    if len(answer.path):
        yield Record("/path", time, path_cdr(time, grid.to_metres(answer.path)))
    if not answer.feasible:
        yield log_record(time, WARN, f"trial {event.trial}: {answer.status.sentence}")
    numbers = answer_numbers(answer)
    head = _RESULT.pack(event.trial, *numbers, answer.status, answer.feasible)
    yield Record("/result", time, arrays_cdr(head, np.asarray(answer.path, _INT32)))


def event(topic: str, step: int, data: bytes) -> Event | None:
    """Turn a message back into the event that it logs.

    Parameters
    ----------
    topic : str
        One of `TOPICS`.
    step : int
        Its log time as a step.
    data : bytes
        CDR.

    Returns
    -------
    Event or None
        None for the messages that are made for viewers only.

    Raises
    ------
    Exception
        If the bytes are no such message: whatever `rosbags` or NumPy raise.
    """
    read = _READERS.get(topic)
    return read(step, TYPES.deserialize_cdr(data, TOPICS[topic])) if read else None


def _read_evolved(step: int, m: Any) -> Evolved:
    epochs = len(m.best)
    evolution = Evolution(
        best=np.array(m.best, dtype=np.float64),
        mean=np.array(m.mean, dtype=np.float64).reshape(epochs),
        chromosomes=np.array(m.chromosomes, dtype=np.int32).reshape(epochs, m.genes),
        way_points=np.array(m.way_points, dtype=np.int32).reshape(epochs, m.way_points_count, 2),
        genotype=m.genotype,
    )
    return Evolved(step, m.trial, m.call, evolution)


def _read_surveyed(step: int, m: Any) -> Surveyed:
    size, points = m.rows * m.cols, len(m.points) // 2
    require(len(m.obstacles) == -(-size // 8), "/graph", f"{len(m.obstacles)} bytes", "a picture")
    edges = np.array(m.edges, dtype=np.int32).reshape(-1, 2)
    inside = m.block >= 1 and bool(((edges >= 0) & (edges < points)).all())
    require(inside, "/graph", f"{points} points, blocks of {m.block}", "edges between them")
    blocks = np.unpackbits(np.array(m.obstacles, dtype=np.uint8), count=m.rows * m.cols)
    graph = Graph(
        obstacles=blocks.astype(np.bool_).reshape(m.rows, m.cols),
        block=m.block,
        points=np.array(m.points, dtype=np.int32).reshape(-1, 2),
        edges=edges,
    )
    return Surveyed(step, m.trial, graph)


def _read_posed(step: int, m: Any) -> Posed:
    start, target = (int(m.start_x), int(m.start_y)), (int(m.target_x), int(m.target_y))
    path = np.array(m.optimal_path, dtype=np.int32).reshape(-1, 2)
    return Posed(step, m.trial, m.number, start, target, path, m.optimal_cost)


def _read_finished(step: int, m: Any) -> TrialFinished:
    return TrialFinished(step, m.trial, read_answer(m))


_READERS: dict[str, Callable[[int, Any], Event]] = {
    "/trial_start": lambda step, m: TrialStarted(step, m.trial, m.seed),
    "/query": _read_posed,
    "/ga_run": _read_evolved,
    MEMETIC_RUN: read_memetic_run,
    "/graph": _read_surveyed,
    "/result": _read_finished,
    "/run_end": lambda step, m: RunFinished(step, m.trials, m.found),
    **drive_messages.READERS,
}
