"""The library: load a map, plan on it, drive through it."""

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

from gapath.components import build
from gapath.discovery import reader_of, yaml_values
from gapath.driving.known_map import KNOWN, read_known_map
from gapath.driving.navigation import Navigator
from gapath.driving.retold import Drive
from gapath.driving.told import drive_events
from gapath.errors import InputError, one_of, require
from gapath.grid import Field, GridMap
from gapath.planning.acceleration import AUTO, with_kernels
from gapath.planning.planner import Particular, Planner
from gapath.planning.simulation import plan_once
from gapath.problem import CornerCutting, Plan, Problem
from gapath.running.naming import usual_values
from gapath.store.inputs import watched
from gapath.store.settings import flatten
from gapath.tasks.drive import Task


def load_map(path: str | Path, /, **settings: Any) -> GridMap:
    """Load a map from a file, or one of gapath's own by its name.

    Parameters
    ----------
    path : str or Path
        A ROS ``map_server`` YAML, a MovingAI ``.map``, an image; or a name in ``conf/map``,
        for example "kg18_test3", or "image" with ``path`` among the settings.
    **settings
        Settings that replace those in ``conf/map``, for example ``unknown="free"`` or
        ``instance=4``.

    Returns
    -------
    GridMap
        The map.

    Raises
    ------
    InputError
        If the file cannot be used, or a setting is unknown or out of range.
    """
    name = str(path)
    if Path(path).suffix:  # a file
        settings["path"], name = name, reader_of(name, "path")
    values = yaml_values("map", name)
    grid: GridMap = build("map", values | settings, "map").read()
    return grid


def plan(
    map: GridMap,
    start: Field | None = None,
    target: Field | None = None,
    planner: str | Planner = "ga3",
    seed: int = 0,
    corner_cutting: str = "allow",
    kernels: str = AUTO,
    **settings: Any,
) -> Plan:
    """Plan a path.

    Many calls cost little more than their plans: a named planner is made once for its settings,
    and kept; a YAML is read once a process. So is what a map needs besides its weights: make a
    `GridMap` of an array once, not for each call.

    Parameters
    ----------
    map : GridMap
        The map.
    start, target : (x, y), optional
        Fields; by default those that the map's author meant.
    planner : str or Planner
        A name in ``conf/planner``, or a planner (`gapath.planning.planner.Planner`).
    seed : int
        Key of the random stream: the same seed gives the same plan.
    corner_cutting : str
        "allow", "one_side", "forbid" or "no_diagonals".
    kernels : str
        "auto", or a name that the planner knows, such as "scalar"; they change no plan.
    **settings
        Settings that replace those in ``conf/planner``, for example ``population=200``.

    Returns
    -------
    Plan
        The answer; look at its status.

    Raises
    ------
    InputError
        If the map is none, start or target cannot be used, a setting is unknown or out of range, or
        the planner does not take such a map.

    Examples
    --------
    >>> import gapath
    >>> grid = gapath.load_map("kg18_test1")
    >>> gapath.plan(grid, planner="astar").cost
    48.5
    """
    problem = _problem(map, start, target, corner_cutting)
    if isinstance(planner, str):
        chosen = _named(planner, kernels, settings)
    else:
        require(_plans(type(planner)), "planner", planner, "a name in conf/planner, or a planner")
        require(not settings, "settings", [*settings], "none: the planner is given ready made")
        chosen = with_kernels(planner, kernels)
    if _is_particular(type(chosen)):
        cast(Particular, chosen).check(problem)
    found = plan_once(problem, chosen, seed)
    object.__setattr__(found, "problem", problem)  # a copy would cost as much as the call
    return found


def drive(
    map: GridMap,
    start: Field | None = None,
    target: Field | None = None,
    navigator: str | Navigator = "kg18",
    seed: int = 0,
    corner_cutting: str = "allow",
    kernels: str = AUTO,
    known_map: str | Path | GridMap | None = None,
    **settings: Any,
) -> Drive:
    """Drive once through a map that the robot does not know.

    It is the first drive of ``gapath task=drive`` with the same settings and seed.

    Parameters
    ----------
    map : GridMap
        The true map.
    start, target : (x, y), optional
        Fields; by default those that the map's author meant.
    navigator : str or Navigator
        A name in ``conf/navigator``, or a navigator (`gapath.driving.navigation.Navigator`).
    seed : int
        Key of the random streams: the same seed gives the same drive.
    corner_cutting : str
        "allow", "one_side", "forbid" or "no_diagonals".
    kernels : str
        "auto", or a name that one of the navigator's planners knows; they change no drive.
    known_map : str, Path or GridMap, optional
        What the robot knows before it starts: the obstacles of a map of the same size, or of a
        file.
    **settings
        Settings that replace those of ``drive`` in ``conf/config.yaml``: ``sensor_range``,
        ``sensor_occlusion``, ``changes_every``, ``changes_lifetime``, ``changes_side``,
        ``step_limit``, ``unknown_weight``; and those that replace the navigator's in
        ``conf/navigator``.

    Returns
    -------
    Drive
        What happened; look at its outcome.

    Raises
    ------
    InputError
        If a map is none, start or target cannot be used, a setting is unknown or out of range, or
        the navigator does not take such a map.

    Examples
    --------
    >>> import gapath
    >>> grid = gapath.load_map("kg18_map1")
    >>> gapath.drive(grid, navigator="replan_astar", sensor_range=8).outcome.name
    'REACHED'
    """
    maps = {}
    if isinstance(known_map, GridMap):
        maps[KNOWN] = known_map
    elif known_map is not None:
        maps[KNOWN] = read_known_map(str(known_map))
    problem = _problem(map, start, target, corner_cutting, maps)
    own, others = _drive_settings(settings)
    if isinstance(navigator, str):
        values = yaml_values("navigator", navigator)
        usual = _drive_names(usual_values()["drive"])
        known = [name for name in (*usual, *values) if name != "kind"]
        for name in others:
            require(name in values, f"navigator.{name}", "an unknown name", one_of(name, known))
        navigator = cast(Navigator, build("navigator", values | others, "navigator"))
    else:
        good = all(hasattr(type(navigator), name) for name in ("complete", "begin", "step"))
        require(good, "navigator", navigator, "a name in conf/navigator, or a navigator")
        require(not others, "settings", [*others], "none: the navigator is given ready made")
    task = with_kernels(Task.of(navigator, own), kernels)
    task.check(problem)
    events = drive_events(task.once(problem, seed), map.cols, seed, 0, 0)
    return Drive(problem, tuple(events))


def _drive_settings(given: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Split settings into those of ``drive``, all of them and nested, and a navigator's."""
    values, others = usual_values()["drive"], {}
    names = _drive_names(values)
    for name, value in given.items():
        if name not in names:
            others[name] = value
            continue
        place = values
        *groups, last = names[name].split(".")
        for group in groups:
            place = place[group]
        place[last] = value
    return values, others


def _drive_names(values: dict[str, Any]) -> dict[str, str]:
    """Give what each setting of ``drive`` is called in Python: sensor_range for sensor.range."""
    names = {name.replace(".", "_"): name for name in flatten(values)}
    del names["known_map"]  # an argument of its own
    return names


def _problem(
    map: GridMap,
    start: Field | None,
    target: Field | None,
    corner_cutting: str,
    maps: Mapping[str, GridMap] = MappingProxyType({}),
) -> Problem:
    """Pose a problem; a start or target that is not given is the map's own."""
    require(isinstance(map, GridMap), "map", type(map).__name__, "a gapath.GridMap")
    start = map.start if start is None else start
    target = map.target if target is None else target
    if start is None or target is None:
        missing = "map.start" if start is None else "map.target"
        raise InputError(missing, None, "a field (x, y)")
    return Problem(map, start, target, CornerCutting.named(corner_cutting), maps)


def _named(name: str, kernels: str, settings: dict[str, Any]) -> Planner:
    """Make a planner of a YAML, or give the one that was made of the same settings."""
    key = (name, kernels, repr(sorted(settings.items())) if settings else "")
    planner = _made.get(key)
    if planner is None:
        with watched() as inputs:
            made: Planner = build("planner", yaml_values("planner", name) | settings, "planner")
        planner = with_kernels(made, kernels)
        if len(_made) >= _MOST_MADE:
            _made.clear()
        if not inputs:  # else it may be another one the next time
            _made[key] = planner
    return planner


_made: dict[tuple[str, str, str], Planner] = {}
_MOST_MADE = 64


@lru_cache
def _plans(kind: type) -> bool:
    return all(hasattr(kind, name) for name in ("exact", "minimises", "plan"))


@lru_cache
def _is_particular(kind: type) -> bool:
    return issubclass(kind, Particular)
