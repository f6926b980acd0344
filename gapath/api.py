"""The library's three lines: load a map, plan on it, look at the plan."""

from functools import lru_cache
from pathlib import Path
from typing import Any, cast

from gapath.components import build
from gapath.discovery import reader_of, yaml_values
from gapath.errors import InputError, require
from gapath.grid import Field, GridMap
from gapath.planning.acceleration import AUTO, with_kernels
from gapath.planning.planner import Particular, Planner
from gapath.planning.simulation import plan_once
from gapath.problem import CornerCutting, Plan, Problem
from gapath.store.inputs import watched


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
    require(isinstance(map, GridMap), "map", type(map).__name__, "a gapath.GridMap")
    rule = CornerCutting.named(corner_cutting)
    start = map.start if start is None else start
    target = map.target if target is None else target
    if start is None or target is None:
        missing = "map.start" if start is None else "map.target"
        raise InputError(missing, None, "a field (x, y)")
    if isinstance(planner, str):
        chosen = _named(planner, kernels, settings)
    else:
        require(_plans(type(planner)), "planner", planner, "a name in conf/planner, or a planner")
        require(not settings, "settings", [*settings], "none: the planner is given ready made")
        chosen = with_kernels(planner, kernels)
    problem = Problem(map, start, target, rule)
    if _is_particular(type(chosen)):
        cast(Particular, chosen).check(problem)
    found = plan_once(problem, chosen, seed)
    object.__setattr__(found, "problem", problem)  # a copy would cost as much as the call
    return found


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
