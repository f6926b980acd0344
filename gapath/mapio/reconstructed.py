"""Seeded generators for the map classes of the papers, whose figures are lost.

KG18 shows four known maps of increasing complexity (Figs 2-5) and says nothing else about
them but how many epochs its three settings took. What is drawn here are *classes* of maps
on which the settings behave like that: any number of instances, the canonical one, number
0, also kept as text under ``maps``. No instance reproduces a figure.
"""

from dataclasses import dataclass, replace
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks
from gapath.grid import GridMap
from gapath.mapio import movingai
from gapath.mapio._classes import known, unknown
from gapath.mapio._classes.drawing import START, TARGET, Draw

SUFFIXES: tuple[str, ...] = ()

BASE_WEIGHT = 0.5  # KG18 Sec. 2

CLASSES = known.CLASSES
"""Classes of KG18's known maps: how to draw the obstacles, and the seed."""

UNKNOWN_CLASSES = unknown.CLASSES
"""Classes of the maps that a robot drives through without knowing them."""


def generate(map_class: str, instance: int) -> GridMap:
    """Draw one instance of a class.

    Parameters
    ----------
    map_class : str
        A key of `CLASSES` or `UNKNOWN_CLASSES`.
    instance : int
        Number of the instance, not negative.

    Returns
    -------
    GridMap
        The map, marked as reconstructed; start and target fields weigh 0 (KG18 Sec. 2).
    """
    draw_obstacles, seed = (CLASSES | UNKNOWN_CLASSES)[map_class]
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
        A class: kg18_test1 to kg18_test4, kg18_map1 to kg18_map4, kg18_enclosed.
    instance : int
        0 for the canonical instance, or the number of another one.
    """

    map_class: str
    instance: int

    def __post_init__(self) -> None:
        check, names = Checks(self, "map"), [*CLASSES, *UNKNOWN_CLASSES]
        check("map_class", self.map_class in names, f"one of {names}")
        check.whole("instance", 0, 2**32 - 1)

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
