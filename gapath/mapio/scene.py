"""Scenes of convex obstacles on an empty floor, like those of Martinez Santa et al. 2022 (M22).

The paper's ten pictures are lost; it says that each holds six obstacles, that the start is at
the lower left and the end at the right border. What is drawn here is such a class: ellipses,
diamonds and turned rectangles that keep apart, in exact integer arithmetic. No scene reproduces
a figure. The ten of the experiments are also kept as pictures under ``maps``.
"""

from dataclasses import dataclass
from math import isqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks, InputError
from gapath.grid import Field, GridMap
from gapath.kernels.lines import ONE_OBSTACLE, line_key
from gapath.kernels.units import ALLOW, OBSTACLE
from gapath.mapio._classes.drawing import MAX_DRAWS, Draw

SUFFIXES: tuple[str, ...] = ()

BASE_WEIGHT = 0.5  # as KG18 Sec. 2, so that costs can be compared

SEED = 2044

ROOM = 80000
"""Pixels of the picture for each obstacle at which sizes are as given below (800 x 600 for 6)."""
LONG, SHORT = (14, 30), (10, 22)
"""Half axes of an obstacle, in pixels."""
GAP, CLEAR = 34, 45
"""Least distance between the circles around two obstacles, and from one to an end, in pixels."""


class Obstacle(NamedTuple):
    """A convex obstacle: its kind, centre, half axes and the direction of the first axis."""

    kind: int
    x: int
    y: int
    long: int
    short: int
    p: int
    q: int

    @property
    def reach(self) -> int:
        """Radius of the circle around it, in pixels."""
        diagonal = self.long**2 + self.short**2 if self.kind == RECTANGLE else self.long**2
        return isqrt(diagonal) + 1


ELLIPSE, DIAMOND, RECTANGLE = range(3)


def draw(number: int, obstacles: int, cols: int, rows: int) -> GridMap:
    """Draw a scene.

    Parameters
    ----------
    number : int
        Number of the scene, from 1.
    obstacles : int
        How many there are; the more, the smaller they are.
    cols, rows : int
        Size of the picture.

    Returns
    -------
    GridMap
        The scene, marked as reconstructed; the straight line from start to end is blocked.

    Raises
    ------
    InputError
        If so many do not fit.
    """
    dice = Draw(SEED, number)
    size = isqrt(cols * rows * 10000 // (obstacles * ROOM))  # per cent
    for _ in range(MAX_DRAWS):
        start = (20 * size // 100, rows - 1 - 20 * size // 100)
        target = (cols - 1, dice.integer(rows // 8, rows // 2))
        blocked = _picture(_place(dice, obstacles, cols, rows, size, (start, target)), cols, rows)
        table = np.where(blocked, OBSTACLE, 1).astype(np.int32)
        if line_key(table, *start, *target, ALLOW) >= ONE_OBSTACLE:
            weights = np.where(blocked, 1.0, BASE_WEIGHT)
            name = f"m22_scene{number:02d}"
            return GridMap(name, weights, start, target, source="reconstructed")
    raise _crowded(obstacles, cols, rows)


def _place(
    dice: Draw, count: int, cols: int, rows: int, size: int, ends: tuple[Field, Field]
) -> list[Obstacle]:
    """Draw obstacles that keep apart from one another, from the border and from the ends."""
    placed: list[Obstacle] = []
    in_vain = 0
    while in_vain < MAX_DRAWS:
        in_vain += 1
        one = _obstacle(dice, cols, rows, size)
        gap, clear = GAP * size // 100, CLEAR * size // 100
        reach = one.reach + gap // 2
        inside = reach <= one.x < cols - reach and reach <= one.y < rows - reach
        apart = all(
            (one.x - other.x) ** 2 + (one.y - other.y) ** 2 >= (one.reach + other.reach + gap) ** 2
            for other in placed
        )
        free = all((one.x - x) ** 2 + (one.y - y) ** 2 >= (one.reach + clear) ** 2 for x, y in ends)
        if inside and apart and free:
            placed.append(one)
            in_vain = 0
            if len(placed) == count:
                return placed
    raise _crowded(count, cols, rows)


def _obstacle(dice: Draw, cols: int, rows: int, size: int) -> Obstacle:
    kind, x, y = dice.integer(0, 2), dice.integer(0, cols - 1), dice.integer(0, rows - 1)
    long, short = (max(2, dice.integer(*axis) * size // 100) for axis in (LONG, SHORT))
    while True:  # a direction, all of them with equal chances
        p, q = dice.integer(-100, 100), dice.integer(0, 100)
        if 2500 <= p * p + q * q <= 10000:
            return Obstacle(kind, x, y, long, min(long, short), p, q)


def _picture(obstacles: list[Obstacle], cols: int, rows: int) -> NDArray[np.bool_]:
    """Paint obstacles, (rows, cols)."""
    blocked = np.zeros((rows, cols), dtype=np.bool_)
    for one in obstacles:
        reach = one.reach
        top, left = max(one.y - reach, 0), max(one.x - reach, 0)
        y, x = np.ogrid[top : one.y + reach + 1, left : one.x + reach + 1]
        # along and across the first axis, both |(p, q)| times too long
        along = np.abs((x - one.x) * one.p + (y - one.y) * one.q)
        across = np.abs((y - one.y) * one.p - (x - one.x) * one.q)
        scale = one.p**2 + one.q**2
        a, b = one.long, one.short
        inside = {
            ELLIPSE: (along * b) ** 2 + (across * a) ** 2 <= (a * b) ** 2 * scale,
            DIAMOND: (along * b + across * a) ** 2 <= (a * b) ** 2 * scale,
            RECTANGLE: (along**2 <= a * a * scale) & (across**2 <= b * b * scale),
        }[one.kind]
        blocked[top : one.y + reach + 1, left : one.x + reach + 1] |= inside
    return blocked


def _crowded(obstacles: int, cols: int, rows: int) -> InputError:
    return InputError(
        "map.obstacles",
        obstacles,
        f"as many as fit on {cols} x {rows} pixels, between start and end",
    )


@dataclass(frozen=True)
class Reader:
    """Draws a scene.

    Parameters
    ----------
    number : int
        Number of the scene; 1 to 10 are those of the experiments.
    obstacles : int
        How many convex obstacles.
    width, height : int
        Size of the picture in pixels.
    """

    number: int
    obstacles: int
    width: int
    height: int

    def __post_init__(self) -> None:
        check = Checks(self, "map")
        check.whole("number", 1, 2**32 - 1)
        check.whole("obstacles", 1, 1000)
        for name in ("width", "height"):
            check.whole(name, 100, 8192)

    def read(self) -> GridMap:
        """Give the scene.

        Returns
        -------
        GridMap
            Start at the lower left, target at the right border.

        Raises
        ------
        InputError
            If so many obstacles do not fit.
        """
        return draw(self.number, self.obstacles, self.width, self.height)
