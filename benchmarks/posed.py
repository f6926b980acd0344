"""Problems: of real maps, which are not part of the project, and between random fields."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gapath.grid import Field, GridMap
from gapath.kernels.rng import fill, high, stream
from gapath.mapio import movingai
from gapath.problem import CornerCutting, Problem

FREE_WEIGHT = 0.5  # of conf/map/movingai.yaml
NO_DATA = "skipped: no real maps: set GAPATH_DATA or put them into ../shared/data"


def real_maps() -> Path | None:
    """Give the folder of real maps, which is not part of the project; None where there is none."""
    place = Path(os.environ.get("GAPATH_DATA", Path(__file__).parents[2] / "shared" / "data"))
    return place if place.is_dir() else None


def scenarios(folder: Path) -> list[tuple[Path, list[movingai.ScenarioProblem]]]:
    """Find MovingAI maps below a folder, each with all problems of its ``.scen`` file."""
    found = []
    for path in sorted(folder.rglob("*.scen")):
        rows = movingai.read_scenario(str(path))
        found.append((path.parent / Path(rows[0].map_name).name, rows))
    return found


def evenly(rows: Sequence[Any], most: int) -> list[Any]:
    """Choose at most so many rows, each from the middle of its share."""
    most = min(len(rows), most)
    return [rows[(2 * i + 1) * len(rows) // (2 * most)] for i in range(most)]


class Ground:
    """A MovingAI map, read once for all problems that pass the same fields."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._read = [self._reader(None).read()]

    def _reader(self, start: list[int] | None) -> movingai.Reader:
        return movingai.Reader(str(self._path), start, None, FREE_WEIGHT, None, 0)

    def problem(self, start: Field, target: Field, rule: CornerCutting) -> Problem:
        """Pose a problem on what can be passed from its start: ground, or water."""
        for grid in self._read:
            if not grid.obstacles[start[1], start[0]]:
                return Problem(grid, start, target, rule)
        self._read.append(self._reader(list(start)).read())
        return Problem(self._read[-1], start, target, rule)


def scenario_problems(
    path: Path, rows: Sequence[movingai.ScenarioProblem], rule: CornerCutting
) -> list[Problem]:
    """Pose those problems of a MovingAI map that can be solved; a map is read once for all."""
    ground = Ground(path)
    posed = [ground.problem(row.start, row.target, rule) for row in rows]
    return [problem for problem in posed if solvable(problem)]


def solvable(problem: Problem) -> bool:
    """Tell whether a path joins the ends, by a flood of the map."""
    return problem.map.joined(problem.start, problem.target, int(problem.corner_cutting))


def random_problems(grid: GridMap, count: int, seed: int, rule: CornerCutting) -> list[Problem]:
    """Pose problems between free fields drawn at random, joined or not."""
    free = np.argwhere(~grid.obstacles)[:, ::-1]
    words = np.empty((count, 2), dtype=np.uint64)
    fill(stream(seed), words.ravel())
    ends = free[[[high(word, len(free)) for word in pair] for pair in words]]
    return [Problem(grid, tuple(start), tuple(target), rule) for start, target in ends.tolist()]
