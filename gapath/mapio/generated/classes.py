"""How maps of each generated class are drawn, in exact integer arithmetic."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.drawing.mazes import carve
from gapath.kernels.rng import probability_threshold
from gapath.kernels.units import SCALE
from gapath.mapio._classes.drawing import Draw, Obstacles

Weights: TypeAlias = NDArray[np.float64]

BASE_WEIGHT = 0.5  # as KG18 Sec. 2, so that costs can be compared

LOWEST, HIGHEST = 6554, 58982
"""Weights of the deepest valley and of the highest hill in units of 1 / `SCALE`: 0.1 and 0.9."""


class Frame(NamedTuple):
    """What is asked for: the map's size, and the settings of its class, 0 where it has none."""

    rows: int
    cols: int
    size: int
    share: float

    @property
    def empty(self) -> Obstacles:
        """A map without obstacles, (rows, cols)."""
        return np.zeros((self.rows, self.cols), dtype=np.bool_)


def _bounded(words: NDArray[np.uint64], most: int | NDArray[np.uint64]) -> NDArray[np.int64]:
    """Draw integers in [0, most), as `gapath.kernels.rng.high` does."""
    half = np.uint64(32)
    return ((words >> half) * np.asarray(most, dtype=np.uint64) >> half).astype(np.int64)


def _walls(frame: Frame) -> tuple[Obstacles, int, int]:
    """Divide a map into square cells by walls of one field; the last ones take what remains.

    Returns
    -------
    blocked : (rows, cols) bool
        The walls.
    down, across : int
        Cells from top to bottom and from left to right.
    """
    blocked, pitch = frame.empty, frame.size + 1
    down, across = (max(1, (side + 1) // pitch) for side in (frame.rows, frame.cols))
    blocked[:, frame.size : across * pitch - 1 : pitch] = True
    blocked[frame.size : down * pitch - 1 : pitch] = True
    return blocked, down, across


def _open(blocked: Obstacles, size: int, begin: NDArray[np.int64], end: NDArray[np.int64]) -> None:
    """Open the walls to the right of cells; a view of the map turned opens those below.

    Parameters
    ----------
    blocked : (rows, cols) bool
        The map, changed in place.
    size : int
        Side of a cell.
    begin, end : (down, across - 1) int64
        Fields of each wall, from its cell's uppermost on, between which it is opened.
    """
    down, walls = begin.shape
    y = np.arange(len(blocked))
    cell = np.minimum(y // (size + 1), down - 1)
    place = (y - cell * (size + 1))[:, np.newaxis]
    free = (begin[cell] <= place) & (place < end[cell])
    free[size : down * (size + 1) - 1 : size + 1] = False  # where walls cross
    blocked[:, size : walls * (size + 1) : size + 1] &= ~free


def _passages(draw: Draw, down: int, across: int) -> tuple[Obstacles, Obstacles]:
    """Join cells by a perfect maze: passages to the right and downwards, as `_open` takes them."""
    right, below = np.zeros((2, down, across), dtype=np.bool_)
    carve(draw.words(down * across - 1), right, below)
    return right[:, :-1], below[:-1].T


def rooms(draw: Draw, frame: Frame) -> Weights:
    """Draw square rooms behind doors of one to three fields.

    A perfect maze joins them all; half of the other walls between two rooms have a door as well.
    """
    blocked, down, across = _walls(frame)
    passages = _passages(draw, down, across)
    for turned, joined in zip((blocked, blocked.T), passages, strict=True):
        also, wide, where = draw.words(3 * joined.size).reshape(3, *joined.shape)
        width = 1 + _bounded(wide, min(3, frame.size))
        begin = _bounded(where, (frame.size - width + 1).astype(np.uint64))
        has = joined | (_bounded(also, 2) > 0)
        _open(turned, frame.size, begin, np.where(has, begin + width, begin))
    return _uniform(blocked)


def maze(draw: Draw, frame: Frame) -> Weights:
    """Draw a perfect maze; corridors are as wide as a cell."""
    blocked, down, across = _walls(frame)
    passages = _passages(draw, down, across)
    for turned, joined in zip((blocked, blocked.T), passages, strict=True):
        _open(turned, frame.size, np.zeros(joined.shape, np.int64), joined * turned.shape[0])
    return _uniform(blocked)


def clutter(draw: Draw, frame: Frame) -> Weights:
    """Draw rectangles and discs anywhere, one over another, until so many fields are obstacles."""
    return _uniform(_scattered(draw, frame))


def _scattered(draw: Draw, frame: Frame) -> Obstacles:
    blocked, (rows, cols, size, share) = frame.empty, frame
    missing, sides = int(share * blocked.size), (max(1, size // 4), size)
    while missing > 0:
        disc, (width, height) = draw.integer(0, 1), draw.rectangle(sides, sides)
        if disc:
            height = width
        x, y = draw.integer(1 - width, cols - 1), draw.integer(1 - height, rows - 1)
        left, top = max(x, 0), max(y, 0)
        place = blocked[top : y + height, left : x + width]
        if disc:  # distances from its centre in half fields
            v, u = np.ogrid[top : top + place.shape[0], left : left + place.shape[1]]
            inside = (2 * (v - y) + 1 - width) ** 2 + (2 * (u - x) + 1 - width) ** 2 <= width**2
        else:
            inside = np.ones(place.shape, dtype=np.bool_)
        missing -= int(np.count_nonzero(inside & ~place))
        place |= inside
    return blocked


def noise(draw: Draw, frame: Frame) -> Weights:
    """Draw each field by itself, an obstacle or not."""
    blocked, threshold = frame.empty, probability_threshold(frame.share)
    for row in blocked:
        row[:] = draw.words(frame.cols) >> np.uint64(32) < threshold
    return _uniform(blocked)


def terrain(draw: Draw, frame: Frame) -> Weights:
    """Draw hills and valleys, weights 0.1 to 0.9, and clutter a quarter as large.

    Every `size` fields both ways a height is drawn; between four of them it is interpolated along
    x, then y, with Perlin's fade 3 t^2 - 2 t^3. The weight rises linearly with the height.
    """
    down, across = ((side - 1) // frame.size + 2 for side in frame[:2])
    heights = _bounded(draw.words(down * across), SCALE).reshape(down, across).astype(np.uint32)
    for side in (frame.cols, frame.rows):
        heights = _between(heights, side, frame.size).T
    units = LOWEST + (heights.astype(np.int64) * (HIGHEST - LOWEST) >> 16)
    obstacles = _scattered(draw, frame._replace(size=max(1, frame.size // 4)))
    return np.where(obstacles, 1.0, units / SCALE)


def _between(heights: NDArray[np.uint32], cols: int, size: int) -> NDArray[np.uint32]:
    """Interpolate heights, in [0, `SCALE`), along x: (n, m) of them to (n, cols)."""
    x = np.arange(cols)
    number, t = x // size, x % size
    faded = ((3 * size - 2 * t) * t * t * SCALE // size**3).astype(np.uint32)
    left, right = heights[:, number], heights[:, number + 1]
    return np.asarray(left * (SCALE - faded) + right * faded >> np.uint32(16))


def map4(draw: Draw, frame: Frame) -> Weights:
    """Draw five walls from the upper and the lower border in turn, each with a gap at its end.

    The class ``kg18_test4`` in its proportions to 100 x 50 fields: at so large a scale a wall's
    place, thickness and gap take any value between those that they have there.
    """
    blocked, (rows, cols, _, _) = frame.empty, frame
    upper = draw.integer(0, 1)
    for number, column in enumerate((14, 31, 48, 65, 82)):
        x = draw.integer((column - 3) * cols // 100, (column + 3) * cols // 100)
        gap = draw.integer(max(1, 6 * rows // 50), 12 * rows // 50)
        thickness = draw.integer(max(1, 2 * cols // 100), max(1, 3 * cols // 100))
        wall = slice(gap, rows) if (number + upper) % 2 else slice(0, rows - gap)
        blocked[wall, x : x + thickness] = True
    return _uniform(blocked)


def _uniform(blocked: Obstacles) -> Weights:
    return np.where(blocked, 1.0, BASE_WEIGHT)


class Class(NamedTuple):
    """A class of maps."""

    draw: Callable[[Draw, Frame], Weights]
    seed: int
    size: tuple[int, int] | None = None
    """Least and most of the setting; None if the class has no such setting."""
    share: bool = False
    """Whether it has a share of obstacles."""


CLASSES: dict[str, Class] = {
    "field_rooms": Class(rooms, 101, (2, 1024)),
    "field_maze": Class(maze, 102, (1, 1024)),
    "field_clutter": Class(clutter, 103, (8, 1024), share=True),
    "field_noise": Class(noise, 104, share=True),
    "field_terrain": Class(terrain, 105, (32, 4096), share=True),
    "field_map4": Class(map4, 106),
}
