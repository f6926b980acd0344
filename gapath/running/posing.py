"""Which problem a run poses: its ends in metres, or the one of several that stands for all."""

import dataclasses
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from gapath.components import build
from gapath.errors import InputError, require
from gapath.grid import GridMap
from gapath.problem import CornerCutting, Problem
from gapath.running.naming import map_name
from gapath.scenario.listed import Queries
from gapath.task import Listing, Posing, Task


def read_problem(
    chosen: dict[str, Any], rule_name: str, task: Task | None, maps: Mapping[str, GridMap]
) -> Problem:
    """Read the map and pose the problem that its start and target define.

    Parameters
    ----------
    chosen : dict
        ``kind`` and settings of the map.
    rule_name : str
        Name of a `CornerCutting` rule, in lower case.
    task : Task, optional
        One that poses several problems is asked which (`gapath.task.Posing`).
    maps : mapping of str to GridMap
        What else the task has read.

    Returns
    -------
    Problem
        Of several the first that can be solved, or else that can be asked.

    Raises
    ------
    InputError
        If the map cannot be read, or has no such start and target.
    """
    rule = CornerCutting.named(rule_name)
    reader = build("map", chosen, "map")
    grid: GridMap = reader.read()
    named = map_name(grid.name, chosen)
    if named != grid.name:
        grid = dataclasses.replace(grid, name=named)
    if isinstance(task, Posing):
        listed = reader.queries(grid) if isinstance(reader, Listing) else None
        return first_of(task.pose(grid, listed, rule), grid, rule, maps)
    for name in ("start", "target"):
        require(getattr(grid, name) is not None, f"map.{name}", "null", "a field [x, y]")
    assert grid.start is not None and grid.target is not None
    return Problem(grid, grid.start, grid.target, rule, maps, grid.published_length)


def first_of(
    queries: Queries, grid: GridMap, rule: CornerCutting, maps: Mapping[str, GridMap]
) -> Problem:
    """Pose the first query that can be solved, or else the first whose ends are free.

    Raises InputError if one of them lies outside the map.
    """
    ends = np.hstack([queries.starts, queries.targets])
    outside = (ends < 0) | (ends >= 2 * (grid.cols, grid.rows))
    for index in np.flatnonzero(outside.any(axis=1))[:1]:
        where = f"map {grid.name}, problem {queries.numbers[index]}"
        limits = f"fields [x, y] with 0 <= x < {grid.cols}, 0 <= y < {grid.rows}"
        raise InputError(where, f"{ends[index, :2].tolist()} to {ends[index, 2:].tolist()}", limits)
    parts = grid.parts(int(rule))
    start, target = (parts[at[:, 1], at[:, 0]] for at in (queries.starts, queries.targets))
    free = (start > 0) & (target > 0)
    joined = free & (start == target)
    first = int(np.argmax(joined if joined.any() else free))
    (x, y, u, v), length = ends[first].tolist(), float(queries.lengths[first])
    return Problem(grid, (x, y), (u, v), rule, maps, length, queries)


def in_fields(settings: Mapping[str, Any]) -> Mapping[str, Any]:
    """Give a map's settings with start and target in fields, where they stand in metres.

    Parameters
    ----------
    settings : mapping
        Of a map, loose. A point in metres has the unit behind both numbers, ``[1.05m, 3.95m]``, in
        the frame of `GridMap.to_metres`.

    Returns
    -------
    mapping
        The same, but for such points: a run is the same, however its ends were told.

    Raises
    ------
    InputError
        If a point lies beyond the map, a number of it has no unit, or the map cannot be read.
    """
    points = {
        name: settings[name]
        for name in ("start", "target")
        if any(isinstance(n, float | str) and not _is_whole(n) for n in _listed(settings.get(name)))
    }
    for name, point in points.items():
        good = len(point) == 2 and all(isinstance(n, str) and _METRES.fullmatch(n) for n in point)
        right = "a field, two integers [x,y], or a point in metres, [1.05m,3.95m]"
        require(good, f"map.{name}", f"[{','.join(map(str, point))}]", right)
    if not points:
        return settings
    grid: GridMap = build("map", {**settings, **dict.fromkeys(points)}, "map").read()
    low, high = grid.to_metres(np.array([(0, grid.rows - 1), (grid.cols - 1, 0)])).round(3).tolist()
    fields = {}
    for name, point in points.items():
        place = grid.to_fields([[float(n.removesuffix("m")) for n in point]])[0].tolist()
        right = (
            f"a point of the map, whose lower left field is at {low} m, its upper right at {high} m"
        )
        require(grid.contains(place), f"map.{name}", f"[{','.join(point)}]", right)
        fields[name] = place
    return {**settings, **fields}


_METRES = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d\d?)?m")


def _listed(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


def _is_whole(number: float | str) -> bool:
    try:
        return float(number).is_integer()
    except ValueError:
        return False
