"""Drives through unknown maps: who arrives, by how many steps, and how long deciding takes.

KG18's four unknown maps: 30 instances of each class, four drives each, with a sensor of range 4;
and generated maps of 1000 x 500 fields with ranges 4, 8 and 40. Navigators drive in turn, with the
same streams. "steps / shortest" is the mean of the drives that reached the target, over the
fewest steps on the map, were it known. Times are a thread's own, of whole drives, looking
included, the least of two (of one on generated maps). "time / ..." and "steps / ..." are ratios
of totals; "a drive" is the median of the drives' own ratios.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

import gapath
from benchmarks.field import least_times
from benchmarks.measure import Calls, Row, quartiles, ratios
from benchmarks.questions.kg18.drives import MAPS, drive_once, make_drive_run, task_of
from gapath.discovery import yaml_names
from gapath.driving.drive import Driven, Sensor
from gapath.events import Outcome
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem
from gapath.tasks.drive import Task

REPEATED, INCREMENTAL = "replan_astar", "dstar_lite"
NAVIGATORS = ("memetic", "kg18", REPEATED, INCREMENTAL)
INSTANCES, TRIALS, RANGE = 30, 4, 4
LARGE = ("field_rooms", "field_clutter", "field_map4")
LARGE_SIZE = {"width": 1000, "height": 500}
LARGE_NAVIGATORS = ("memetic", REPEATED, INCREMENTAL)
LARGE_INSTANCES = 3
LARGE_RANGES = (4, 8, 40)


class Trip(NamedTuple):
    """A drive, and the microseconds that it took."""

    driven: Driven
    microseconds: float

    @property
    def steps(self) -> int:
        """Steps that the robot took."""
        return len(self.driven.frames) - 1


def navigating(name: str, sensor_range: int) -> Task:
    """Make the task of a navigator, all else as in ``conf/config.yaml``."""
    task = task_of(make_drive_run(MAPS[0], name, 1))
    return replace(task, sensor=Sensor(sensor_range, task.sensor.occlusion))


def drives(
    problems: Sequence[Problem], tasks: dict[str, Task], trials: int, takes: int
) -> dict[str, list[Trip]]:
    """Drive in turn with every navigator, so often on each map."""
    for task in tasks.values():  # compiles the kernels before a clock runs
        drive_once(task, make_drive_run(MAPS[0], REPEATED, 1).problem, 0)
    trips: dict[str, list[Trip]] = {name: [] for name in tasks}
    for problem in problems:
        for trial in range(trials):
            calls: Calls = {
                name: partial(drive_once, task, problem, trial) for name, task in tasks.items()
            }
            times, driven = least_times(lambda calls=calls: calls, takes)  # type: ignore[misc]
            for name, found in driven.items():
                trips[name].append(Trip(found, times[name]))
    return trips


def of_map(
    head: Row, names: Sequence[str], problems: list[Problem], trials: int, takes: int
) -> list[Row]:
    known = [name for name in names if name in yaml_names("navigator")]
    tasks = {name: navigating(name, head["range"]) for name in known}
    trips = drives(problems, tasks, trials, takes)
    shortest = [len(shortest_path(p).path) - 1 for p in problems for _ in range(trials)]
    rows = []
    for name in names:
        row: Row = head | {"navigator": name}
        if name in trips:
            rows.append(row | _summary(trips, name, shortest))
        else:
            rows.append(row | {"drives": f"skipped: there is no navigator {name}"})
    return rows


def _summary(trips: dict[str, list[Trip]], name: str, shortest: list[int]) -> Row:
    own = trips[name]
    reached = [trip.driven.outcome is Outcome.REACHED for trip in own]
    over = [trip.steps / least for trip, least in zip(own, shortest, strict=True)]
    times = [trip.microseconds for trip in own]
    row: Row = {"drives": len(own), "reached %": 100 * float(np.mean(reached))}
    if any(reached):
        row["steps / shortest"] = float(np.mean(over, where=reached))
    row["drive ms"] = quartiles([t / 1e3 for t in times])
    for rival in (REPEATED, INCREMENTAL):
        if rival != name:
            theirs = [trip.microseconds for trip in trips[rival]]
            row[f"time / {rival}"] = sum(times) / sum(theirs)
            row[f"time / {rival}, a drive"] = ratios(times, theirs)
    steps = {n: sum(trip.steps for trip in trips[n]) for n in (name, REPEATED, INCREMENTAL)}
    row[f"steps / {REPEATED}"] = steps[name] / steps[REPEATED]
    row["steps / the better"] = steps[name] / min(steps[REPEATED], steps[INCREMENTAL])
    return row


def measure(quick: bool) -> list[Row]:
    instances, trials = (1, 1) if quick else (INSTANCES, TRIALS)
    rows: list[Row] = []
    for name in MAPS:
        problems = [_posed(name, instance=i) for i in range(instances)]
        head: Row = {"map": name, "fields": "100 x 50", "range": RANGE}
        rows += of_map(head, NAVIGATORS, problems, trials, 1 if quick else 2)
    size = {"width": 100, "height": 50} if quick else LARGE_SIZE
    for name in LARGE:
        problems = [
            _posed(name, instance=i, **size) for i in range(1 if quick else LARGE_INSTANCES)
        ]
        head = {"map": name, "fields": f"{size['width']} x {size['height']}"}
        for seen in LARGE_RANGES:
            rows += of_map(head | {"range": seen}, LARGE_NAVIGATORS, problems, 1, 1)
    return rows


def _posed(name: str, **settings: int) -> Problem:
    grid = gapath.load_map(name, **settings)
    assert grid.start is not None and grid.target is not None
    return Problem(grid, grid.start, grid.target)
