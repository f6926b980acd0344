"""Classes of KG18's four unknown maps (Figs 6-9), and of one whose target is walled in.

The paper says of them: one simple obstacle; 22 simple obstacles placed randomly; rooms of a
building; obstacles of different shapes, very irregular, with blind alleys. Everything else
is assumed: sizes were chosen so that a robot that sees four fields ahead nearly always
reaches the target in the first three classes and sometimes fails in the fourth.
"""

from collections.abc import Callable

import numpy as np

from gapath.grid import Field, GridMap
from gapath.mapio._classes.drawing import (
    COLS,
    MAX_DRAWS,
    ROWS,
    START,
    TARGET,
    Draw,
    Obstacles,
    as_table,
    empty_map,
    straight_line_is_free,
)
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Problem

CLEAR = 5
"""Fields around start and target that stay free."""
SMALLEST_ROOM, LARGEST_ROOM = 11, 30
"""Shorter side at least, longer side at most, of a room, its walls included; mostly."""
BAR_SIDES = ((9, 18), (9, 18))
"""Widths and heights of shapes made of bars."""
ALLEY_SIDES = ((20, 40), (30, 44))
"""Widths and heights of a great blind alley; past it narrow ways are left."""


def _ends_are_clear(blocked: Obstacles) -> bool:
    return not any(
        blocked[y - CLEAR : y + CLEAR + 1, max(x - CLEAR, 0) : x + CLEAR + 1].any()
        for x, y in (START, TARGET)
    )


def _target_can_be_reached(blocked: Obstacles) -> bool:
    grid = GridMap("drawn", np.where(blocked, 1.0, 0.5))
    return shortest_path(Problem(grid, START, TARGET, CornerCutting.FORBID)).feasible


def _drawn_until_fit(draw: Draw, once: Callable[[Draw], Obstacles]) -> Obstacles:
    """Draw until both ends are clear, the straight line is blocked and another way is free."""
    for _ in range(MAX_DRAWS):
        blocked = once(draw)
        if (
            _ends_are_clear(blocked)
            and not straight_line_is_free(as_table(blocked))
            and _target_can_be_reached(blocked)
        ):
            return blocked
    raise AssertionError("no map of this class in 1000 draws")


def simple_obstacle(draw: Draw) -> Obstacles:
    """Class 1: one rectangle across the straight line, its ends unlike in distance."""
    blocked = empty_map()
    width, height = draw.rectangle((6, 16), (16, 30))
    x = draw.integer(25, 74 - width)
    y = START[1] - draw.integer(6, height - 7)
    blocked[y : y + height, x : x + width] = True
    return blocked


def _place(draw: Draw, blocked: Obstacles, shape: Obstacles, distance: int) -> bool:
    """Place a shape at random if its frame, widened by the distance, is free, and so are the ends.

    A negative distance lets shapes overlap by their margins.
    """
    rows, cols = shape.shape
    x, y = draw.integer(0, COLS - cols), draw.integer(0, ROWS - rows)
    left, top = max(x - distance, 0), max(y - distance, 0)
    around = blocked[top : y + rows + distance, left : x + cols + distance]
    wider = blocked.copy()
    wider[y : y + rows, x : x + cols] |= shape
    if around.any() or not _ends_are_clear(wider):
        return False
    blocked[:] = wider
    return True


def simple_obstacles(draw: Draw) -> Obstacles:
    """Class 2: 22 rectangles anywhere, three fields or more apart."""

    def once(draw: Draw) -> Obstacles:
        blocked = empty_map()
        placed = 0
        while placed < 22:
            width, height = draw.rectangle((3, 7), (4, 10))
            placed += _place(draw, blocked, np.ones((height, width), dtype=bool), 3)
        return blocked

    return _drawn_until_fit(draw, once)


def _divide(draw: Draw, room: Obstacles) -> None:
    """Divide a room, given with the walls around it, by a wall with a door; then both halves.

    A wall across the whole building gets two doors. Arrays are views, so all of them are cut
    out of the same building.
    """
    if room.shape[0] > room.shape[1]:
        room = room.T
    rows, cols = room.shape
    if cols <= LARGEST_ROOM:
        return
    for _ in range(MAX_DRAWS):
        x = draw.integer(SMALLEST_ROOM, cols - 1 - SMALLEST_ROOM)
        if room[0, x - 1 : x + 2].all() and room[-1, x - 1 : x + 2].all():
            break  # the wall ends at no door
    else:
        return
    room[:, x] = True
    for part in np.array_split(room[1:-1, x], 2 if rows > 40 else 1):
        door = draw.integer(3, 5)
        y = draw.integer(1, len(part) - 1 - door)
        part[y : y + door] = False
    _divide(draw, room[:, : x + 1])
    _divide(draw, room[:, x:])


def rooms(draw: Draw) -> Obstacles:
    """Class 3: a building; rooms behind walls with doors of three to five fields."""

    def once(draw: Draw) -> Obstacles:
        walled = np.ones((ROWS + 2, COLS + 2), dtype=bool)
        walled[1:-1, 1:-1] = False
        _divide(draw, walled)
        return walled[1:-1, 1:-1]

    return _drawn_until_fit(draw, once)


def _bars(draw: Draw, bars: tuple[str, ...], widths: Field, heights: Field) -> Obstacles:
    """Draw a shape of bars along named sides or middles of its frame."""
    width, height = draw.rectangle(widths, heights)
    thick = draw.integer(2, 3)
    shape = np.zeros((height, width), dtype=bool)
    x, y = (width - thick) // 2, (height - thick) // 2
    places = {
        "left": np.s_[:, :thick],
        "right": np.s_[:, -thick:],
        "top": np.s_[:thick, :],
        "bottom": np.s_[-thick:, :],
        "upright": np.s_[:, x : x + thick],
        "level": np.s_[y : y + thick, :],
    }
    for bar in bars:
        shape[places[bar]] = True
    return shape


def _turned(draw: Draw, shape: Obstacles) -> Obstacles:
    return np.rot90(shape, draw.integer(0, 3))


def block(draw: Draw) -> Obstacles:
    """Draw a rectangle."""
    width, height = draw.rectangle((4, 12), (4, 12))
    return np.ones((height, width), dtype=bool)


def angle(draw: Draw) -> Obstacles:
    """Draw an L, turned any way."""
    return _turned(draw, _bars(draw, ("left", "bottom"), *BAR_SIDES))


def cross(draw: Draw) -> Obstacles:
    """Draw a cross."""
    return _bars(draw, ("upright", "level"), *BAR_SIDES)


def pocket(draw: Draw) -> Obstacles:
    """Draw a U that is open to the left, where the robot comes from: a blind alley."""
    return _bars(draw, ("top", "right", "bottom"), *BAR_SIDES)


def hook(draw: Draw) -> Obstacles:
    """Draw a pocket whose mouth is half closed, above or below."""
    shape = pocket(draw)
    shape[: len(shape) // 2, :2] = True
    return np.asarray(shape[:: 1 - 2 * draw.integer(0, 1)])


def cup(draw: Draw) -> Obstacles:
    """Draw a U turned any way."""
    return _turned(draw, pocket(draw))


def slant(draw: Draw) -> Obstacles:
    """Draw a diagonal bar that rises or falls."""
    length, thick = draw.integer(8, 18), draw.integer(2, 4)
    y, x = np.mgrid[0:length, 0 : length + thick]
    shape = (x >= y) & (x < y + thick)
    return np.asarray(shape[:: 1 - 2 * draw.integer(0, 1)])


def blob(draw: Draw) -> Obstacles:
    """Draw three discs that overlap."""
    y, x = np.mgrid[0:15, 0:15]
    shape = np.zeros((15, 15), dtype=bool)
    for _ in range(3):
        radius = draw.integer(2, 4)
        u, v = draw.integer(4, 10), draw.integer(4, 10)
        shape |= (x - u) ** 2 + (y - v) ** 2 <= radius**2
    return shape


def _blind_alley(draw: Draw, blocked: Obstacles) -> None:
    """Build a great pocket across the straight line, with narrow ways past it."""
    shape = _bars(draw, ("top", "right", "bottom"), *ALLEY_SIDES)
    rows, cols = shape.shape
    x, y = draw.integer(6, 14), draw.integer(2, ROWS - 2 - rows)
    blocked[y : y + rows, x : x + cols] |= shape


def complex_environment(draw: Draw) -> Obstacles:
    """Class 4: a great blind alley, and shapes of eight kinds anywhere, one into another."""
    kinds = (block, angle, cross, pocket, hook, cup, slant, blob)

    def once(draw: Draw) -> Obstacles:
        blocked = empty_map()
        _blind_alley(draw, blocked)
        for _ in range(24):
            shape = kinds[draw.integer(0, len(kinds) - 1)](draw)
            _place(draw, blocked, shape, -3)
        return blocked

    return _drawn_until_fit(draw, once)


def enclosed_target(draw: Draw) -> Obstacles:
    """Draw a building without a door around the target, and a few obstacles before it."""
    blocked = empty_map()
    left, top = draw.integer(60, 85), draw.integer(4, 16)
    bottom = draw.integer(32, 45)
    blocked[top : bottom + 1, left:] = True
    blocked[top + 2 : bottom - 1, left + 2 :] = False
    for _ in range(6):
        width, height = draw.rectangle((3, 8), (3, 8))
        _place(draw, blocked, np.ones((height, width), dtype=bool), 3)
    return blocked


CLASSES: dict[str, tuple[Callable[[Draw], Obstacles], int]] = {
    # Seeds chosen so that instance 0 is a typical one of its class.
    "kg18_map1": (simple_obstacle, 1),
    "kg18_map2": (simple_obstacles, 2),
    "kg18_map3": (rooms, 5),
    "kg18_map4": (complex_environment, 3),
    "kg18_enclosed": (enclosed_target, 1),
}
