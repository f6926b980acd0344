"""MovingAI maps and scenarios (Sturtevant 2012, https://movingai.com/benchmarks/formats.html).

A map is text: four header lines (``type octile``, ``height``, ``width``, ``map``), then a
character a field. A scenario lists problems on one map with their optimal lengths.

Who starts on the ground passes ground and swamp, who starts on water passes water only; nobody
passes trees or what is out of bounds.
"""

import math
import re
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks, InputError, require
from gapath.grid import Field, GridMap
from gapath.mapio._input import as_field, final, read_text
from gapath.scenario.listed import Queries

SUFFIXES: tuple[str, ...] = (".map",)

GROUND, WATER = ".GS", "W"
"""Ground, ground and swamp; water."""
BLOCKED = "@OT"
"""Out of bounds, out of bounds and trees."""
MAX_SCENARIO_BYTES = 1 << 24
"""Bytes of the largest scenario, ten times those that there are; a row takes twenty of them."""
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
    lines = read_text(path, MAX_SCENARIO_BYTES).rstrip().split("\n")
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
    columns = line.split("\t") if "\t" in line else line.split()
    require(
        len(columns) == 9,
        where,
        f"{len(columns)} columns",
        "9 columns separated by tabs or blanks: bucket, map, width, height, start x, start y, "
        "goal x, goal y, optimal length",
    )
    try:
        bucket, cols, rows, x, y, goal_x, goal_y = (int(v) for v in columns[:1] + columns[2:8])
        length = float(columns[8])
    except ValueError as error:
        raise InputError(where, repr(line[:80]), "numbers in all columns but the second") from error
    small = all(abs(v) < 2**31 for v in (bucket, cols, rows, x, y, goal_x, goal_y))
    require(small, where, repr(line[:80]), "whole numbers between -2^31 and 2^31")
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
        check = Checks(self, "map")
        check.whole("problem", 0, 10**6)
        check("free_weight", 0 <= self.free_weight < 1, "a number in [0, 1)")

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
            disagree, or the scenario has no such row or is of a map of another name or size.
        """
        codes = _read_codes(self.path)
        start, target = as_field("map.start", self.start), as_field("map.target", self.target)
        published = math.nan
        if self.scenario is not None:
            problem = self._scenario_row(self.scenario, *codes.shape)
            start, target = start or problem.start, target or problem.target
            if (start, target) == (problem.start, problem.target):
                published = problem.optimal_length
        return GridMap(
            name=Path(self.path).stem,
            weights=final(np.where(_passable(codes, start), self.free_weight, 1.0)),
            start=start,
            target=target,
            source="movingai",
            published_length=published,
        )

    def queries(self, grid: GridMap) -> Queries | None:
        """Read all rows of the scenario, if there is one.

        Parameters
        ----------
        grid : GridMap
            What `read` gave.

        Returns
        -------
        Queries or None
            In the order of the file.

        Raises
        ------
        InputError
            If a row of the scenario is of a map of another name or size.
        """
        if self.scenario is None:
            return None
        problems = read_scenario(self.scenario)
        for number, problem in enumerate(problems):
            self._check(problem, number, grid.rows, grid.cols)
        ends = np.array([(*p.start, *p.target) for p in problems], dtype=np.int32)
        return Queries(
            np.arange(len(problems), dtype=np.int32),
            np.array([problem.bucket for problem in problems], dtype=np.int32),
            ends[:, :2],
            ends[:, 2:],
            np.array([problem.optimal_length for problem in problems]),
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
        self._check(problem, self.problem, rows, cols)
        return problem

    def _check(self, problem: ScenarioProblem, number: int, rows: int, cols: int) -> None:
        """Raise InputError if a row of the scenario is not of this map."""
        where = f"{self.scenario}, row {number}"
        name = PureWindowsPath(problem.map_name).name  # after the last / or \\
        require(name == Path(self.path).name, where, f"a problem on {name}", f"one on {self.path}")
        require(
            (problem.rows, problem.cols) == (rows, cols),
            where,
            f"a map of {problem.cols} x {problem.rows}",
            f"the {cols} x {rows} fields of {self.path}",
        )


def _passable(codes: NDArray[np.uint8], start: Field | None) -> NDArray[np.bool_]:
    """Tell which fields can be passed from a start; without one, from the ground."""
    rows, cols = codes.shape
    on_map = start is not None and 0 <= start[0] < cols and 0 <= start[1] < rows
    afloat = start is not None and on_map and codes[start[1], start[0]] == ord(WATER)
    return np.isin(codes, _numbers(WATER if afloat else GROUND))


def _numbers(characters: str) -> NDArray[np.uint8]:
    return np.frombuffer(characters.encode(), dtype=np.uint8)


def _read_codes(path: str) -> NDArray[np.uint8]:
    """Read the characters of a map, (rows, cols)."""
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
        rest = line.lstrip(GROUND + WATER + BLOCKED)
        if rest:
            raise InputError(
                f"{path}, line {number}, column {cols - len(rest) + 1}",
                repr(rest[0]),
                f"one of {' '.join(GROUND)} (passable) {' '.join(BLOCKED)} (not) {WATER} (water)",
            )
    return np.frombuffer("".join(lines).encode(), dtype=np.uint8).reshape(rows, cols)
