"""MovingAI maps and scenarios (Sturtevant 2012, https://movingai.com/benchmarks/formats.html).

A map is text: four header lines (``type octile``, ``height``, ``width``, ``map``), then a
character a field. A scenario lists problems on one map with their optimal lengths.
"""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from gapath.errors import InputError, require
from gapath.grid import Field, GridMap
from gapath.mapio._input import as_field, read_text

SUFFIXES: tuple[str, ...] = (".map",)

PASSABLE = ".GS"
"""Ground, ground and swamp."""
BLOCKED = "@OTW"
"""Out of bounds, out of bounds, trees and water."""
HEADER = re.compile(r"type octile *\nheight +(\d{1,9}) *\nwidth +(\d{1,9}) *\nmap *\n", re.ASCII)


class ScenarioProblem(NamedTuple):
    """One row of a scenario."""

    bucket: int
    """Class of difficulty: the optimal length divided by four."""
    map_name: str
    cols: int
    rows: int
    start: Field
    target: Field
    optimal_length: float
    """Octile length in fields, diagonals sqrt(2), without cutting corners."""


def read_scenario(path: str) -> list[ScenarioProblem]:
    """Read a ``.scen`` file.

    Parameters
    ----------
    path : str
        The file, relative to the current folder.

    Returns
    -------
    list of ScenarioProblem
        Its rows in order.

    Raises
    ------
    InputError
        If the file cannot be read or a line is not of version 1 of the format.
    """
    lines = read_text(path).rstrip().split("\n")
    require(
        re.fullmatch(r"version 1(\.0)?\s*", lines[0]) is not None,
        f"{path}, line 1",
        repr(lines[0][:40]),
        "version 1",
    )
    return [
        _scenario_problem(f"{path}, line {number}", line)
        for number, line in enumerate(lines[1:], start=2)
    ]


def _scenario_problem(where: str, line: str) -> ScenarioProblem:
    columns = line.split("\t")
    require(
        len(columns) == 9,
        where,
        f"{len(columns)} columns",
        "9 columns separated by tabs: bucket, map, width, height, start x, start y, "
        "goal x, goal y, optimal length",
    )
    try:
        bucket, cols, rows, x, y, goal_x, goal_y = (int(v) for v in columns[:1] + columns[2:8])
        length = float(columns[8])
    except ValueError as error:
        raise InputError(where, repr(line[:80]), "numbers in all columns but the second") from error
    require(math.isfinite(length) and length >= 0, where, length, "a finite optimal length >= 0")
    return ScenarioProblem(bucket, columns[1], cols, rows, (x, y), (goal_x, goal_y), length)


@dataclass(frozen=True)
class Reader:
    """Reads a ``.map`` file, with start and target from a ``.scen`` file if one is named.

    Parameters
    ----------
    path : str
        The map.
    start, target : [x, y], optional
        Fields to go from and to; they go before the scenario's.
    free_weight : float
        Weight of passable fields, in [0, 1).
    scenario : str, optional
        A ``.scen`` file of this map.
    problem : int
        Row of the scenario, from 0.
    """

    path: str
    start: list[int] | None
    target: list[int] | None
    free_weight: float
    scenario: str | None
    problem: int

    def __post_init__(self) -> None:
        require(self.problem >= 0, "map.problem", self.problem, "an integer >= 0")
        require(
            0 <= self.free_weight < 1, "map.free_weight", self.free_weight, "a number in [0, 1)"
        )

    def read(self) -> GridMap:
        """Read the map.

        Returns
        -------
        GridMap
            The map, named after the file.

        Raises
        ------
        InputError
            If a file cannot be read or is not of its format, header and rows of the map
            disagree, or the scenario has no such row or is of a map of another size.
        """
        passable = _read_passable(self.path)
        start, target = as_field("map.start", self.start), as_field("map.target", self.target)
        if self.scenario is not None:
            problem = self._scenario_row(self.scenario, *passable.shape)
            start, target = start or problem.start, target or problem.target
        return GridMap(
            name=Path(self.path).stem,
            weights=np.where(passable, self.free_weight, 1.0),
            start=start,
            target=target,
            source="movingai",
        )

    def _scenario_row(self, scenario: str, rows: int, cols: int) -> ScenarioProblem:
        problems = read_scenario(scenario)
        require(
            self.problem < len(problems),
            "map.problem",
            self.problem,
            f"a row of {scenario}, which has {len(problems)}",
        )
        problem = problems[self.problem]
        require(
            (problem.rows, problem.cols) == (rows, cols),
            f"{scenario}, row {self.problem}",
            f"a map of {problem.cols} x {problem.rows}",
            f"the {cols} x {rows} fields of {self.path}",
        )
        return problem


def _read_passable(path: str) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]]:
    text = read_text(path)
    header = HEADER.match(text)
    if header is None:
        raise InputError(
            path,
            repr(text[:40]),
            "the lines 'type octile', 'height <rows>', 'width <columns>', 'map'",
        )
    rows, cols = int(header.group(1)), int(header.group(2))
    lines = text[header.end() :].rstrip("\n").split("\n")
    require(rows > 0 and cols > 0, path, f"height {rows}, width {cols}", "at least 1 x 1 fields")
    require(len(lines) == rows, path, f"{len(lines)} rows", f"{rows}, the header's height")
    for number, line in enumerate(lines, start=5):
        require(
            len(line) == cols,
            f"{path}, line {number}",
            f"{len(line)} characters",
            f"{cols}, the header's width",
        )
    text = "".join(lines)  # other characters than ASCII become "?", which is not known either
    codes = np.frombuffer(text.encode("ascii", "replace"), dtype=np.uint8).reshape(rows, cols)
    passable = np.isin(codes, np.frombuffer(PASSABLE.encode(), dtype=np.uint8))
    known = passable | np.isin(codes, np.frombuffer(BLOCKED.encode(), dtype=np.uint8))
    if not known.all():
        y, x = np.argwhere(~known)[0]
        raise InputError(
            f"{path}, line {y + 5}, column {x + 1}",
            repr(lines[y][x]),
            f"one of {' '.join(PASSABLE)} (passable) {' '.join(BLOCKED)} (not)",
        )
    return passable
