"""Seeded generators of map classes of any size, for measurements on large maps.

No paper has these maps, and none is reconstructed. Start and target lie in the largest part of the
map whose fields are joined by their sides: whatever the rule of corners, a path joins them.
"""

from dataclasses import dataclass

import numpy as np

from gapath.errors import Checks
from gapath.grid import Field, GridMap
from gapath.kernels.table import fill_parts
from gapath.mapio._classes.drawing import Draw, as_table
from gapath.mapio.generated.classes import CLASSES, Frame, Weights
from gapath.scenario.nearest import nearest_free

SUFFIXES: tuple[str, ...] = ()

MOST_SHARE = 0.4
"""Of obstacles. Of single fields more than 0.407 leave no way through a large map."""


def _ends(weights: Weights) -> tuple[Field, Field]:
    """Give the fields of the largest part nearest to the middles of the left and right border."""
    parts = np.zeros(weights.shape, dtype=np.int32)
    fill_parts(as_table(weights == 1.0), False, parts)
    sizes = np.bincount(parts.ravel())
    sizes[0] = 0  # obstacles
    others = parts != sizes.argmax()
    rows, cols = weights.shape
    start, target = (nearest_free(others, (x, rows // 2)) for x in (0, cols - 1))
    assert start is not None and target is not None
    return start, target


@dataclass(frozen=True)
class Reader:
    """Draws an instance of a class.

    Parameters
    ----------
    map_class : str
        A class: field_rooms, field_maze, field_clutter, field_noise, field_terrain, field_map4.
    instance : int
        Number of the instance.
    width, height : int
        Size of the map in fields.
    size : int, optional
        In fields: side of a room, width of a corridor, longest side of an obstacle, distance of
        the heights that are drawn; None for a class without.
    share : float, optional
        Share of obstacles among the fields, at most 0.4; None for a class without.
    """

    map_class: str
    instance: int
    width: int
    height: int
    size: int | None
    share: float | None

    def __post_init__(self) -> None:
        check = Checks(self, "map")
        check("map_class", self.map_class in CLASSES, f"one of {[*CLASSES]}")
        check.whole("instance", 0, 2**32 - 1)
        for name in ("width", "height"):
            check.whole(name, 20, 8192)
        of_class = CLASSES[self.map_class]
        if of_class.size is None:
            check("size", self.size is None, f"null: {self.map_class} has no such setting")
        else:
            least, most = of_class.size
            good = self.size is not None and least <= self.size <= most
            check("size", good, f"an integer from {least} to {most}")
        if not of_class.share:
            check("share", self.share is None, f"null: {self.map_class} has no such setting")
        else:
            good = self.share is not None and 0 <= self.share <= MOST_SHARE
            check("share", good, f"a number from 0 to {MOST_SHARE}")

    def read(self) -> GridMap:
        """Draw the map.

        Returns
        -------
        GridMap
            Start at the left border, target at the right one, about half way down, or as near as
            a field from which most others can be reached.
        """
        draw, seed, _, _ = CLASSES[self.map_class]
        frame = Frame(self.height, self.width, self.size or 0, self.share or 0.0)
        weights = draw(Draw(seed, self.instance), frame)
        start, target = _ends(weights)
        return GridMap(self.map_class, weights, start, target, self.instance, source="generated")
