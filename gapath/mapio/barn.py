"""Worlds of the BARN challenge (Perille et al. 2020, Daffan/the-barn-challenge).

Its own ``world_N.world`` files of the simulator Gazebo, or the same as JSON.

A world is cylinders of radius 0.075 m on a lattice of 30 x 64 cells of 0.15 m, of which x
runs from -4.5 m to 0, y from 0 to 9.6 m, up. A cylinder fills a cell, so a cell is a field.
The robot starts inside; its goal lies beyond the lattice, so the map goes on, free, up to
the goal's row. Start and goal lie on corners of cells: theirs is the field to the upper right.
"""

import io
import json
import math
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks, InputError, require
from gapath.grid import Field, GridMap
from gapath.mapio._input import as_field, read_bytes, read_text

SUFFIXES: tuple[str, ...] = (".json", ".world")

RESOLUTION, RADIUS = 0.15, 0.075  # metres
ORIGIN = (-4.5, 0.0, 0.0)
COLS, ROWS = 30, 64
START, GOAL = [-2.25, 3.0], [-2.25, 13.0]
"""Where the challenge's robot starts in every world, and its goal, in metres."""
PATH_ORIGIN = (-4.575, 5.075)
"""Where the cell (0, 0) of a ``path_N.npy`` has its centre, in metres."""
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
        A ``.world`` file: SDF, whose models are cylinders or planes. Or a JSON file:
        ``cylinders_xyr``, a list of [x, y, radius], ``start``, [x, y] or [x, y, heading], and
        ``goal``, [x, y], in metres; other keys are passed over.
    start, target : [x, y], optional
        Fields to go from and to, instead of the scenario's or the world's own.
    free_weight : float
        Weight of free fields, in [0, 1).
    inflation : int
        Fields by which obstacles grow to all sides, for a robot that is no point.
    scenario : str, optional
        The world's ``path_N.npy``: start and target are the first and the last cell of this path
        through the world, instead of places before and behind it.
    """

    path: str
    start: list[int] | None
    target: list[int] | None
    free_weight: float
    inflation: int
    scenario: str | None

    def __post_init__(self) -> None:
        check = Checks(self, "map")
        check("free_weight", 0 <= self.free_weight < 1, "a number in [0, 1)")
        check.whole("inflation", 0, COLS)

    def read(self) -> GridMap:
        """Read the map.

        Returns
        -------
        GridMap
            30 columns, 64 rows or as many as the goal needs, of 0.15 m, named after the file.

        Raises
        ------
        InputError
            If a file cannot be read, is no JSON, SDF or path, lacks a key, has a value of a
            wrong type or range, a cylinder of another radius or off the lattice, another
            obstacle, or if its start or goal lies outside the map or on an obstacle.
        """
        sdf = self.path.lower().endswith(".world")
        world = _read_sdf(self.path) if sdf else _read_json(self.path)
        if self.scenario is not None:
            world |= _read_path(self.scenario)
        named = self.scenario or self.path
        start = _cell(f"{named}, start", _numbers(named, world, "start", (2, 3)), MAX_ROWS)
        goal = _cell(f"{named}, goal", _numbers(named, world, "goal", (2,)), MAX_ROWS)
        rows = max(ROWS, start[1] + 1, goal[1] + 1)
        blocked = np.zeros((rows, COLS), dtype=bool)
        for number, cylinder in enumerate(_list(self.path, world, "cylinders_xyr")):
            x, y = _cylinder(f"{self.path}, cylinders_xyr[{number}]", cylinder)
            blocked[y, x] = True
        blocked = inflated(blocked, self.inflation)
        for key, (x, y), setting in (("start", start, self.start), ("goal", goal, self.target)):
            require(
                setting is not None or not blocked[y, x],
                f"{named}, {key}",
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


def _read_sdf(path: str) -> dict[str, Any]:
    """Read a world of Gazebo as what a JSON file holds; what its state repeats is passed over."""
    text = read_text(path, MAX_WORLD_BYTES)
    expected = "a BARN world: SDF with cylinders"
    require("<!" not in text.replace("<!--", ""), path, "a declaration of XML", expected)
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise InputError(path, f"text that is no XML ({error})", expected) from error
    require(root.tag == "sdf" and root.find("world") is not None, path, f"<{root.tag}>", expected)
    require(root.find("world/include") is None, path, "<include>", expected)
    cylinders = []
    for number, model in enumerate(root.iterfind("world/model")):
        where = f"{path}, model {model.get('name', number)}"
        shapes = [
            shape for geometry in model.iterfind(".//collision/geometry") for shape in geometry
        ]
        kinds = {shape.tag for shape in shapes}
        require(kinds <= {"cylinder", "plane"}, where, ", ".join(sorted(kinds)), expected)
        own, *inner = [_floats(where, pose.text) for pose in model.iter("pose")] or [[0.0] * 6]
        require(not any(map(any, inner)), where, "a pose within the model", "one of the model only")
        cylinders += [
            [*own[:2], *_floats(where, shape.findtext("radius"))]
            for shape in shapes
            if shape.tag == "cylinder"
        ]
    return {"cylinders_xyr": cylinders, "start": START, "goal": GOAL}


def _floats(where: str, text: str | None) -> list[float]:
    try:
        return [float(word) for word in (text or "").split()]
    except ValueError as error:
        raise InputError(where, repr(text)[:80], "numbers in metres") from error


def _read_path(path: str) -> dict[str, list[float]]:
    """Read the ends of a ``path_N.npy``: (n, 2) cells, of which (0, 0) is at `PATH_ORIGIN`."""
    try:
        with warnings.catch_warnings(action="ignore"):  # of Python's, and of old headers
            cells = np.load(io.BytesIO(read_bytes(path, MAX_WORLD_BYTES)), allow_pickle=False)
    except InputError:
        raise
    except Exception as error:  # NumPy lets a tokenizer's, and memory's, through
        raise InputError(path, "no array of numbers", "a path_N.npy of the challenge") from error
    found = f"an array of {getattr(cells, 'dtype', type(cells).__name__)}, {np.shape(cells)}"
    good = isinstance(cells, np.ndarray) and cells.dtype.kind in "iuf"
    good = good and cells.ndim == 2 and cells.shape[1] == 2 and len(cells) > 0
    require(good and bool(np.isfinite(cells).all()), path, found, "cells, a finite (n, 2)")
    ends = cells[[0, -1]] * RESOLUTION + PATH_ORIGIN
    return {"start": ends[0].tolist(), "goal": ends[1].tolist()}


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
