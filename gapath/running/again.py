"""A run done again from what its log says of it, and from nothing else.

What can be made of the settings is made of them, not taken over: maps that are drawn, start and
target, names, the optimum. What only a file of somebody's own could tell is taken from the log.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from gapath.components import checked, normalised
from gapath.discovery import load, reader_of, yaml_names, yaml_values
from gapath.errors import InputError, require
from gapath.events import Event, RunFinished, RunStarted
from gapath.grid import Field, GridMap
from gapath.planning.acceleration import AUTO, with_kernels
from gapath.planning.device import CPU
from gapath.problem import CornerCutting, Plan, Problem
from gapath.running.config import Root, settings_of, split
from gapath.running.naming import Method, changes_of, check_name, map_name, usual_values
from gapath.running.posing import first_of, read_problem
from gapath.running.shards import WHOLE, span
from gapath.store.settings import flatten, nested
from gapath.task import Batch, Posing, Task, find_task

_HOW = {"recorder": {}, "output": "-", "force": False, "threads": 1, "kernels": AUTO}
_HOW |= {"device": CPU, "provenance": False}
"""What a log does not say, since it changes nothing in it."""


class Again(NamedTuple):
    """A run as its settings make it.

    Parameters
    ----------
    started : RunStarted
        Its first event.
    task : Task
        Its task.
    optimum : Plan
        What its trials are held against.
    remarks : list of str
        What of the log's words nobody can prove.
    first : int
        The first trial.
    """

    started: RunStarted
    task: Task
    optimum: Plan
    remarks: list[str]
    first: int


def made_again(logged: RunStarted, kernels: str = AUTO) -> Again:
    """Make a run of its log's settings.

    Parameters
    ----------
    logged : RunStarted
        The first event of a log.
    kernels : str
        Which kernels compute (`gapath.planning.acceleration.with_kernels`).

    Returns
    -------
    Again
        The run; its first event equals the logged one if that says the truth.

    Raises
    ------
    InputError
        If the log's settings are not those of a run of this version.
    """
    try:
        given = nested(logged.settings)
        recorder = given.pop("recorder", None)  # what logs of version 5 and before said of that
        find_task(given.get("task"))
        root, chosen = split(WHOLE | given | _HOW)
        check_name(root.name)
        settings = settings_of(root, chosen)
        task = with_kernels(find_task(root.task).make(settings), kernels)
        require(1 <= root.trials <= 10**6, "trials", root.trials, "an integer from 1 to 10^6")
        part = span(root.trials, root.shard, root.shards, isinstance(task, Posing))
        problem, remarks = _problem(root, settings, task, logged.problem)
        task.check(problem)
    except InputError as error:
        where = f"settings of the log, {error.where}"
        raise InputError(where, error.value, error.expected) from error
    method, remark = _method(task, settings, logged.method)
    optimum = task.optimum(problem)
    trials = root.trials * (1 if problem.queries is None else len(problem.queries))
    if recorder is None:
        del settings["recorder"]
    else:
        settings["recorder"] = recorder
        remarks.append("the settings of its recorders are its author's")
    started = RunStarted(
        root.name,
        method,
        root.task,
        problem,
        root.seed,
        part.stop if root.shards > 1 else trials,
        flatten(settings),
        logged.versions,
        optimum.path,
        optimum.cost,
    )
    return Again(started, task, optimum, [*remarks, *remark], part.start)


def _problem(
    root: Root, settings: Mapping[str, Any], task: Task, logged: Problem
) -> tuple[Problem, list[str]]:
    """Pose the problem; a file of the user's is not read, its map is the log's."""
    own = settings["map"]
    _check_maps(settings, task, logged)
    maps, told = _known(settings, logged)
    if "path" not in own:
        size, there = (own.get("width"), own.get("height")), (logged.map.cols, logged.map.rows)
        fits = None in size or size == there
        require(fits, "map.width, map.height", size, f"{there}, as the log's map is")
        return read_problem(root.map, root.corner_cutting, task, maps), told
    rule = CornerCutting.named(root.corner_cutting)
    kind, path, grid = own["kind"], str(own["path"]), logged.map
    if load("map", kind).__module__.startswith("gapath.mapio."):
        kind = reader_of(path, "map.path") if kind == "file" else kind
        grid = replace(grid, name=map_name(Path(path).stem, own), source=kind, instance=0)
    start = _place(own, "start") or grid.start
    target = _place(own, "target") or grid.target
    grid = replace(grid, start=start, target=target)
    whole = "its start, target and problems"
    remarks = [f"the map {_said(grid.name)}, {whole}, is what the log has of {_said(path)}", *told]
    if isinstance(task, Posing):
        queries = logged.queries
        if queries is None or not len(queries):
            raise InputError("map", "no queries", "those that the task asks")
        return first_of(queries, grid, rule, maps), remarks
    if start is None or target is None:
        raise InputError("map", "no start or target", "both")
    return Problem(grid, start, target, rule, maps, grid.published_length), remarks


def _check_maps(settings: Mapping[str, Any], task: Task, logged: Problem) -> None:
    """Check that the log has a map for each setting of the task that names a file, and no other."""
    named = {
        name
        for group in task.groups
        if group in task.shapes
        for name, value in flatten(settings[group], group).items()
        if isinstance(value, str) and Path(value).suffix
    }
    require(named == {*logged.maps}, "maps", sorted(logged.maps), f"those of {sorted(named)}")


def _known(settings: Mapping[str, Any], logged: Problem) -> tuple[dict[str, GridMap], list[str]]:
    """Give what else the task read, under the names that its files have, and say what it is."""
    maps, told = {}, []
    for name, grid in logged.maps.items():
        group, _, rest = name.partition(".")
        path = str(flatten(settings[group])[rest])
        kind = reader_of(path, name)
        own = load("map", kind).__module__.startswith("gapath.mapio.")
        maps[name] = replace(grid, name=Path(path).stem, source=kind, instance=0) if own else grid
        told.append(f"{name} is what the log has of {_said(path)}")
    return maps, told


def _said(word: str) -> str:
    """Give a word of the log's author's such that none of it is taken for the verdict."""
    return word if re.fullmatch(r"[\w.,/=\[\]+-]+", word) else repr(word)


def _place(settings: Mapping[str, Any], name: str) -> Field | None:
    """Give the start or target that a map of somebody's own is set to have."""
    value = settings.get(name)
    if value is None:
        return None
    good = isinstance(value, list) and [*map(type, value)] == [int, int]
    require(good, f"map.{name}", value, "two integers [x, y]")
    return value[0], value[1]


def _method(task: Task, settings: Mapping[str, Any], logged: str) -> tuple[str, list[str]]:
    """Give a method's name, and say so if that is its author's alone."""
    group = task.groups[0]
    remark = [f"the name of its {group}, {_said(logged)}, is its author's"]
    fitting = (n for n in yaml_names(group) if logged == n or logged.startswith(f"{n}["))
    preset = next(fitting, None)
    if preset is None:
        return logged, remark
    plain = usual_values()
    usual = {"corner_cutting": plain["corner_cutting"]} | {
        each: checked(task.shapes[each], plain[each], each)
        if each in task.shapes
        else normalised(each, yaml_values(each, preset), each)
        for each in task.groups
    }
    changes = changes_of(flatten({name: settings[name] for name in usual}), flatten(usual))
    name = Method(preset, changes).name
    composed = any(key.count(".") > 1 and key.endswith(".kind") for key in flatten(usual))
    if name == logged or not composed or (changes and logged == preset):
        return name, []
    return logged, remark  # planners in it may have been told by the names of their YAMLs


def events_again(again: Again, left_out: tuple[int, ...] = ()) -> Iterator[Event]:
    """Do a run again.

    Parameters
    ----------
    again : Again
        The run.
    left_out : tuple of int
        Trials that are not told.

    Yields
    ------
    Event
        What the run would emit now, from the first event on.
    """
    run = again.started
    yield run
    named = (run.experiment, run.method, run.problem)
    batch = Batch(*named, run.seed, run.trials, first=again.first)
    step = found = 0
    for number, trial in enumerate(again.task.trials(batch, again.optimum), again.first):
        if number not in left_out:
            yield from trial.events(step)
        step += trial.steps
        found += trial.found
    yield RunFinished(step, run.trials, found)
