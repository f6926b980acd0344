"""Worlds of the BARN challenge as JSON (Perille et al. 2020, Daffan/the-barn-challenge).

A world is cylinders of radius 0.075 m on a lattice of 30 x 64 cells of 0.15 m, of which x
runs from -4.5 m to 0, y from 0 to 9.6 m, up. A cylinder fills a cell, so a cell is a field.
The robot starts inside; its goal lies beyond the lattice, so the map goes on, free, up to
the goal's row. Start and goal lie on corners of cells: theirs is the field to the upper right.
"""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks, InputError, require
from gapath.grid import Field, GridMap
from gapath.mapio._input import as_field, read_text

SUFFIXES: tuple[str, ...] = (".json",)

RESOLUTION, RADIUS = 0.15, 0.075  # metres
ORIGIN = (-4.5, 0.0, 0.0)
COLS, ROWS = 30, 64
MAX_ROWS = 1000
"""Rows of the longest map: how far off a goal may lie."""
MAX_WORLD_BYTES = 1 << 20
"""Bytes of the largest file of a world."""
TOLERANCE = 1e-3
"""In fields, for numbers that were rounded when written."""


@dataclass(frozen=True)
class Reader:
    """Reads a world of the BARN challenge.

    Parameters
    ----------
    path : str
        The JSON file: ``cylinders_xyr``, a list of [x, y, radius], ``start``, [x, y] or
        [x, y, heading], and ``goal``, [x, y], in metres; other keys are passed over.
    start, target : [x, y], optional
        Fields to go from and to, instead of the world's own.
    free_weight : float
        Weight of free fields, in [0, 1).
    inflation : int
        Fields by which obstacles grow to all sides, for a robot that is no point.
    """

    path: str
    start: list[int] | None
    target: list[int] | None
    free_weight: float
    inflation: int

    def __post_init__(self) -> None:
        check = Checks(self, "map")
        check("free_weight", 0 <= self.free_weight < 1, "a number in [0, 1)")
        check("inflation", 0 <= self.inflation <= COLS, f"an integer, 0 to {COLS}")

    def read(self) -> GridMap:
        """Read the map.

        Returns
        -------
        GridMap
            30 columns, 64 rows or as many as the goal needs, of 0.15 m, named after the file.

        Raises
        ------
        InputError
            If the file cannot be read, is no JSON, lacks a key, has a value of a wrong type
            or range, a cylinder of another radius or off the lattice, or if its start or
            goal lies outside the map or on an obstacle.
        """
        world = _read_json(self.path)
        start = _cell(f"{self.path}, start", _numbers(self.path, world, "start", (2, 3)), MAX_ROWS)
        goal = _cell(f"{self.path}, goal", _numbers(self.path, world, "goal", (2,)), MAX_ROWS)
        rows = max(ROWS, start[1] + 1, goal[1] + 1)
        blocked = np.zeros((rows, COLS), dtype=bool)
        for number, cylinder in enumerate(_list(self.path, world, "cylinders_xyr")):
            x, y = _cylinder(f"{self.path}, cylinders_xyr[{number}]", cylinder)
            blocked[y, x] = True
        blocked = inflated(blocked, self.inflation)
        for key, (x, y), setting in (("start", start, self.start), ("goal", goal, self.target)):
            require(
                setting is not None or not blocked[y, x],
                f"{self.path}, {key}",
                f"{world[key]}, on an obstacle",
                "a free place; name another field by map.start or map.target",
            )
        return GridMap(
            name=Path(self.path).stem,
            weights=np.where(blocked[::-1], 1.0, self.free_weight),  # row 0 is the top
            start=as_field("map.start", self.start) or (start[0], rows - 1 - start[1]),
            target=as_field("map.target", self.target) or (goal[0], rows - 1 - goal[1]),
            source="barn",
            resolution=RESOLUTION,
            origin=ORIGIN,
        )


def inflated(blocked: NDArray[np.bool_], fields: int) -> NDArray[np.bool_]:
    """Grow obstacles to all eight sides.

    Parameters
    ----------
    blocked : (rows, cols) bool
        True where an obstacle is.
    fields : int
        By how many fields.

    Returns
    -------
    (rows, cols) bool
        True where an obstacle is so near, by the Chebyshev distance.
    """
    for _ in range(fields):
        padded = np.pad(blocked, 1)
        wide = padded[:, :-2] | padded[:, 1:-1] | padded[:, 2:]
        blocked = wide[:-2] | wide[1:-1] | wide[2:]
    return blocked


def _read_json(path: str) -> dict[str, Any]:
    def refuse(constant: str) -> NoReturn:
        raise ValueError(f"{constant} is no number of JSON")

    expected = "a BARN world: a JSON object with cylinders_xyr, start and goal"
    try:
        world = json.loads(read_text(path, MAX_WORLD_BYTES), parse_constant=refuse)
    except InputError:
        raise
    except (ValueError, RecursionError) as error:
        reason = str(error)[:80]
        raise InputError(path, f"text that is no JSON ({reason})", expected) from error
    if not isinstance(world, dict):
        raise InputError(path, _shown(world), expected)
    return world


def _list(path: str, world: dict[str, Any], key: str) -> list[Any]:
    require(key in world, f"{path}, {key}", "nothing", "the keys cylinders_xyr, start, goal")
    value = world[key]
    if not isinstance(value, list):
        raise InputError(f"{path}, {key}", _shown(value), "a list")
    return value


def _numbers(path: str, world: dict[str, Any], key: str, lengths: tuple[int, ...]) -> list[float]:
    return _metres(f"{path}, {key}", _list(path, world, key), lengths)


def _metres(where: str, value: Any, lengths: tuple[int, ...]) -> list[float]:
    """Check a list of numbers; 1e9 m is as good as infinite, and no float overflows there."""
    numbers = isinstance(value, list) and all(
        isinstance(v, int | float) and not isinstance(v, bool) and -1e9 < v < 1e9 for v in value
    )
    expected = f"a list of {' or '.join(map(str, lengths))} finite numbers in metres"
    require(numbers and len(value) in lengths, where, _shown(value), expected)
    return [float(v) for v in value]


def _cell(where: str, metres: list[float], rows: int) -> Field:
    """Give the cell (column, row from the bottom) of a place; on a border the upper or right."""
    x, y = (
        math.floor((place - corner) / RESOLUTION + TOLERANCE)
        for place, corner in zip(metres[:2], ORIGIN[:2], strict=True)
    )
    require(
        0 <= x < COLS and 0 <= y < rows,
        where,
        metres,
        f"a place with {ORIGIN[0]} <= x < 0 and 0 <= y < {rows * RESOLUTION:g}, in metres",
    )
    return x, y


def _cylinder(where: str, value: Any) -> Field:
    metres = _metres(where, value, (3,))
    x, y = _cell(where, metres, ROWS)
    off = (
        metres[0] - ORIGIN[0] - (x + 0.5) * RESOLUTION,
        metres[1] - ORIGIN[1] - (y + 0.5) * RESOLUTION,
        metres[2] - RADIUS,
    )
    require(
        max(map(abs, off)) < TOLERANCE * RESOLUTION,
        where,
        metres,
        f"radius {RADIUS} and a centre on the lattice, {ORIGIN[0]} + {RESOLUTION} (i + 0.5), "
        f"{RESOLUTION} (j + 0.5)",
    )
    return x, y


def _shown(value: Any) -> str:
    # Whatever is long or nested is named by its type alone.
    if (
        isinstance(value, list)
        and len(value) <= 4
        and not any(isinstance(v, list | dict) for v in value)
    ):
        return f"[{', '.join(map(_shown, value))}]"
    return type(value).__name__ if isinstance(value, list | dict) else repr(value)[:80]
