"""What M22 printed.

M22: Martínez Santa, Martínez Sarmiento, Montiel Ariza 2022.
"""

import math
from typing import NamedTuple

MAPS = tuple(f"m22_scene{number:02d}" for number in range(1, 11))
CONCAVE = "m22_u"
PLANNERS = (
    "visibility_ga",
    "visibility_ga_unlimited",
    "visibility_ga_resized",
    "visibility_ga_corners",
)
EXACT = {
    "visibility_ga": "visibility_dijkstra",
    "visibility_ga_unlimited": "visibility_dijkstra",
    "visibility_ga_corners": "visibility_dijkstra_corners",
    "visibility_astar": "visibility_dijkstra",
}
"""Which planner knows the shortest path of a planner's graph."""

RIVALS = {
    "visibility_dijkstra": "Dijkstra on the graph",
    "visibility_astar": "A* on the graph",
    "visibility_dijkstra_corners": "Dijkstra on corners",
    "inflated_astar": "A* on pixels",
    "inflated_ga3": "KG18's GA 3",
}
"""What stands beside the paper's planner on its scenes."""

LABELS = {
    "visibility_ga": "M22",
    "visibility_ga_unlimited": "M22 unlimited",
    "visibility_ga_resized": "M22 resized",
    "visibility_ga_corners": "M22 with corners",
    **RIVALS,
    **{name: f"Scene {int(name[-2:])}" for name in MAPS},
    CONCAVE: "U",
}


class Printed(NamedTuple):
    """What the paper says of a method (Sec. III)."""

    length: float
    """f, in pixels of a picture whose size it does not give; NaN where it gives none."""
    generations: float
    seconds: float
    """Of the search, image work included in its fitness."""


PAPER = {
    "visibility_ga": Printed(1115.0, 51.5, 81.3),
    "visibility_ga_unlimited": Printed(1027.7, 829, 1293.0),
    "visibility_astar": Printed(math.nan, math.nan, 83.0),
}
"""Means of ten environments with a limit of 20 generations and for A*; a single run without."""

IMAGE_SHARE = 0.43
"""Part of the paper's time that goes into comparing images (Sec. III)."""
