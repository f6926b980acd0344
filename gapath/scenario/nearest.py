"""What to take instead of a start or target that is blocked."""

import numpy as np
from numpy.typing import NDArray

from gapath.grid import Field, GridMap, PlanningMap


def other_reading(grid: PlanningMap, obstacles: NDArray[np.bool_], places: list[Field]) -> str:
    """Suggest to read a picture the other way round, if all of some places are free then.

    Parameters
    ----------
    grid : PlanningMap
        The map.
    obstacles : (rows, cols) bool
        What would be an obstacle, were the picture inverted.
    places : list of (x, y)
        Fields on it.

    Returns
    -------
    str
        The end of a sentence; empty if the map is no picture, or a place is blocked then, too.
    """
    inverted = grid.inverted if isinstance(grid, GridMap) else None
    if inverted is None or any(obstacles[y, x] for x, y in places):
        return ""
    now, then = ("dark", "bright") if inverted else ("bright", "dark")
    setting = f"map.invert={str(not inverted).lower()}"
    return f"; or, if {then} is an obstacle here, not {now}, map=image and {setting}"


def nearest_told(grid: PlanningMap, obstacles: NDArray[np.bool_], place: Field) -> str | None:
    """Say which free field is nearest, on a map with a scale or an origin in metres, too.

    Parameters
    ----------
    grid : GridMap or other map
        The map.
    obstacles : (rows, cols) bool
        True where a field of it cannot be passed.
    place : (x, y)
        A field of it.

    Returns
    -------
    str or None
        As a setting has it: ``[3, 1]``; None if nothing is free.
    """
    nearest = nearest_free(obstacles, place)
    if nearest is None:
        return None
    told = str(list(nearest))
    if not isinstance(grid, GridMap) or (grid.resolution, *grid.origin) == (1.0, 0.0, 0.0, 0.0):
        return told
    x, y = grid.to_metres(np.array([nearest]))[0].round(3).tolist()
    return f"{told}, in metres [{x}m,{y}m]"


def nearest_free(obstacles: NDArray[np.bool_], place: Field) -> Field | None:
    """Find the free field nearest to a place.

    Parameters
    ----------
    obstacles : (rows, cols) bool
        True where a field cannot be passed.
    place : (x, y)
        A field.

    Returns
    -------
    (x, y) or None
        The nearest by the Euclidean distance, of several the first from top and left; None if
        nothing is free.
    """
    rows, cols = obstacles.shape
    reach, found = 1, False
    while True:
        top, left = max(place[1] - reach, 0), max(place[0] - reach, 0)
        window = obstacles[top : place[1] + reach + 1, left : place[0] + reach + 1]
        if found:  # this window is twice as wide as one with a free field: none beyond is nearer
            y, x = np.nonzero(~window)
            first = int(np.argmin((x + left - place[0]) ** 2 + (y + top - place[1]) ** 2))
            return int(x[first]) + left, int(y[first]) + top
        found = not window.all()
        if not found and reach > max(rows, cols):
            return None
        reach *= 2
