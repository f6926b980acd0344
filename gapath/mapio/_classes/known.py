"""Classes of KG18's four known test maps (Figs 2-5): increasing complexity, no more is said.

What is drawn are maps on which the paper's three settings need as many epochs as in its
Table 1.
"""

from collections.abc import Callable

from gapath.grid import Field, Table
from gapath.kernels.links import link_distances
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


def _pieces(table: Table) -> int:
    """Count the straight pieces that start and target need: 1, 2, or 3 for more."""
    if straight_line_is_free(table):
        return 1
    ahead = link_distances(table, START, 1) >= 0
    behind = link_distances(table, TARGET, 1) >= 0
    return 2 if (ahead & behind).any() else 3


def one_obstacle(draw: Draw) -> Obstacles:
    """Class 1: one rectangle across the straight line to the target."""
    blocked = empty_map()
    width, height = draw.rectangle((4, 12), (8, 16))
    x = draw.integer(30, 69 - width)
    y = START[1] - draw.integer(2, height - 3)
    blocked[y : y + height, x : x + width] = True
    return blocked


def scattered_obstacles(draw: Draw) -> Obstacles:
    """Class 2: eight rectangles anywhere; redrawn until two straight pieces are needed."""
    for _ in range(MAX_DRAWS):
        blocked = empty_map()
        for _ in range(8):
            width, height = draw.rectangle((3, 8), (6, 16))
            x = draw.integer(6, COLS - 9 - width)
            y = draw.integer(0, ROWS - height)
            blocked[y : y + height, x : x + width] = True
        if _pieces(as_table(blocked)) == 2:
            return blocked
    raise AssertionError("no scattered obstacles of this class in 1000 draws")


def _walls(draw: Draw, columns: list[int], jitter: int, gaps: Field) -> Obstacles:
    """Build walls from the upper and the lower border in turn, each with a gap at its end."""
    blocked = empty_map()
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
