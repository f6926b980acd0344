"""Seeded generators for the map classes of the papers, whose figures are lost.

KG18 shows four known maps of increasing complexity (Figs 2-5) and says nothing else about
them but how many epochs its three settings took. What is drawn here are *classes* of maps
on which the settings behave like that: any number of instances, the canonical one, number
0, also kept as text under ``maps``. No instance reproduces a figure.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from gapath.errors import require
from gapath.grid import OBSTACLE, Field, GridMap
from gapath.kernels.fitness import ALLOW, ONE_OBSTACLE, line_key
from gapath.kernels.visibility import link_distances
from gapath.mapio import movingai
from gapath.rng import fill, high, stream

SUFFIXES: tuple[str, ...] = ()

ROWS, COLS = 50, 100  # KG18 Sec. 2
START, TARGET = (0, 24), (98, 24)  # KG18 Sec. 5
BASE_WEIGHT = 0.5  # KG18 Sec. 2

MAX_DRAWS = 1000

Obstacles = NDArray[np.bool_]


class Draw:
    """Integers from the stream of one instance."""

    def __init__(self, seed: int, instance: int) -> None:
        self._stream = stream(seed, instance)
        self._word = np.empty(1, dtype=np.uint64)

    def integer(self, lowest: int, highest: int) -> int:
        """Draw an integer, both ends included."""
        fill(self._stream, self._word)
        return lowest + int(high(self._word[0], highest - lowest + 1))


def _pieces(table: NDArray[np.int32]) -> int:
    """Count the straight pieces that start and target need: 1, 2, or 3 for more."""
    if line_key(table, *START, *TARGET, ALLOW) < ONE_OBSTACLE:
        return 1
    ahead = link_distances(table, START, 1) >= 0
    behind = link_distances(table, TARGET, 1) >= 0
    return 2 if (ahead & behind).any() else 3


def _rectangle(draw: Draw, widths: Field, heights: Field) -> tuple[int, int]:
    return draw.integer(*widths), draw.integer(*heights)


def one_obstacle(draw: Draw) -> Obstacles:
    """Class 1: one rectangle across the straight line to the target."""
    blocked = np.zeros((ROWS, COLS), dtype=bool)
    width, height = _rectangle(draw, (4, 12), (8, 16))
    x = draw.integer(30, 69 - width)
    y = START[1] - draw.integer(2, height - 3)
    blocked[y : y + height, x : x + width] = True
    return blocked


def scattered_obstacles(draw: Draw) -> Obstacles:
    """Class 2: eight rectangles anywhere; redrawn until two straight pieces are needed."""
    for _ in range(MAX_DRAWS):
        blocked = np.zeros((ROWS, COLS), dtype=bool)
        for _ in range(8):
            width, height = _rectangle(draw, (3, 8), (6, 16))
            x = draw.integer(6, COLS - 9 - width)
            y = draw.integer(0, ROWS - height)
            blocked[y : y + height, x : x + width] = True
        if _pieces(np.where(blocked, OBSTACLE, 1).astype(np.int32)) == 2:
            return blocked
    raise AssertionError("no scattered obstacles of this class in 1000 draws")


def _walls(draw: Draw, columns: list[int], jitter: int, gaps: Field) -> Obstacles:
    """Build walls from the upper and the lower border in turn, each with a gap at its end."""
    blocked = np.zeros((ROWS, COLS), dtype=bool)
    upper = draw.integer(0, 1)
    for number, column in enumerate(columns):
        x = column + draw.integer(-jitter, jitter)
        gap = draw.integer(*gaps)
        thickness = draw.integer(2, 3)
        rows = slice(gap, ROWS) if (number + upper) % 2 else slice(0, ROWS - gap)
        blocked[rows, x : x + thickness] = True
    return blocked


def two_walls(draw: Draw) -> Obstacles:
    """Class 3: two walls from opposite borders, far apart; an S with two narrow bends."""
    return _walls(draw, [15, 85], 5, (16, 21))


def maze(draw: Draw) -> Obstacles:
    """Class 4: five walls in turn, which no polyline of four pieces passes."""
    return _walls(draw, [14, 31, 48, 65, 82], 3, (6, 12))


CLASSES: dict[str, tuple[Callable[[Draw], Obstacles], int]] = {
    # Seeds chosen so that instance 0 shows the epochs and failures of KG18's Table 1.
    "kg18_test1": (one_obstacle, 1),
    "kg18_test2": (scattered_obstacles, 2),
    "kg18_test3": (two_walls, 15),
    "kg18_test4": (maze, 1),
}


def generate(map_class: str, instance: int) -> GridMap:
    """Draw one instance of a class.

    Parameters
    ----------
    map_class : str
        A key of `CLASSES`.
    instance : int
        Number of the instance, not negative.

    Returns
    -------
    GridMap
        The map, marked as reconstructed; start and target fields weigh 0 (KG18 Sec. 2).
    """
    draw_obstacles, seed = CLASSES[map_class]
    blocked = draw_obstacles(Draw(seed, instance))
    return _with_ends(map_class, np.where(blocked, 1.0, BASE_WEIGHT), instance)


def _with_ends(map_class: str, weights: NDArray[np.float64], instance: int) -> GridMap:
    weights[START[1], START[0]] = weights[TARGET[1], TARGET[0]] = 0.0
    return GridMap(map_class, weights, START, TARGET, instance, source="reconstructed")


@dataclass(frozen=True)
class Reader:
    """Reads the canonical instance of a class from ``maps``, and draws the others.

    Parameters
    ----------
    map_class : str
        A class: kg18_test1 to kg18_test4.
    instance : int
        0 for the canonical instance, or the number of another one.
    """

    map_class: str
    instance: int

    def __post_init__(self) -> None:
        require(self.map_class in CLASSES, "map.map_class", self.map_class, f"one of {[*CLASSES]}")
        require(0 <= self.instance < 2**32, "map.instance", self.instance, "an integer from 0 on")

    def read(self) -> GridMap:
        """Give the map.

        Returns
        -------
        GridMap
            100 x 50 fields with start (0, 24) and target (98, 24).
        """
        if self.instance:
            return generate(self.map_class, self.instance)
        path = str(files("gapath.maps") / f"{self.map_class}.map")
        text = movingai.Reader(path, None, None, BASE_WEIGHT, None, 0).read()
        return replace(_with_ends(self.map_class, text.weights.copy(), 0), name=self.map_class)
