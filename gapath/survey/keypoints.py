"""Points around obstacles that a path may turn at (M22 Sec. II.B.2).

Everything that decides where a point lies is computed from sums of integers by + - * / and
square roots, so that it lies there on every machine; scikit-image's own axes and polygons, equal
but for rounding, come from sines, arc tangents and matrix products, which differ.
"""

import math

import numpy as np
from numpy.typing import NDArray

from gapath.survey.obstacle_image import Picture

Points = NDArray[np.int32]
"""Pixels as (x, y), (n, 2)."""

Vector = tuple[float, float]


def label(obstacles: Picture) -> tuple[NDArray[np.int32], int]:
    """Give each obstacle a number: pixels that touch, corners included, belong together.

    Parameters
    ----------
    obstacles : (rows, cols) bool
        The picture.

    Returns
    -------
    labels : (rows, cols) int32
        0 where nothing is, else the obstacle's number from 1.
    count : int
        Number of obstacles.
    """
    from skimage import measure

    labels, count = measure.label(obstacles, return_num=True, connectivity=2)
    return labels, int(count)


def axis_ends(labels: NDArray[np.int32]) -> list[tuple[Vector, Vector]]:
    """Give the ends of both main axes of every obstacle, eqs (2) and (3).

    The axes are those of the ellipse with the obstacle's second moments, as in scikit-image: of
    an ellipse its own, of other shapes longer or shorter than the shape. Eq. (2) as printed has
    one angle for both; the second axis is taken at a right angle to the first, as Fig. 4 shows.

    Parameters
    ----------
    labels : (rows, cols) int32
        As `label` gives them.

    Returns
    -------
    list of ((x, y), (dx, dy))
        For each obstacle its four ends, the longer axis first, each with the direction in which
        it lies from the centroid, a unit vector.
    """
    from skimage import measure

    ends: list[tuple[Vector, Vector]] = []
    for region in measure.regionprops(labels):
        top, left, bottom, right = region.bbox
        y, x = np.arange(top, bottom), np.arange(left, right)
        rows, cols = region.image.sum(axis=1), region.image.sum(axis=0)
        n, sx, sy = int(rows.sum()), int(cols @ x), int(rows @ y)
        # central moments times n squared, exactly
        xx = n * int(cols @ (x * x)) - sx * sx
        yy = n * int(rows @ (y * y)) - sy * sy
        xy = n * int(np.einsum("ij,j->i", region.image, x) @ y) - sx * sy
        root = math.sqrt((xx - yy) ** 2 + 4 * xy * xy)
        # of a circle any axes would do: these are those of the picture
        along = (root + xx - yy, 2.0 * xy) if xx >= yy else (2.0 * xy, root + yy - xx)
        length = math.sqrt(along[0] * along[0] + along[1] * along[1])
        cos, sin = (along[0] / length, along[1] / length) if length else (1.0, 0.0)
        for variance, (dx, dy) in ((xx + yy + root, (cos, sin)), (xx + yy - root, (-sin, cos))):
            half = 2.0 * math.sqrt(max(variance, 0.0) / 2.0) / n  # l / 2 of eq. (2)
            for sign in (1.0, -1.0):
                away = (sign * dx, sign * dy)
                ends.append(((sx / n + half * away[0], sy / n + half * away[1]), away))
    return ends


def corners(obstacles: Picture, tolerance: float) -> list[tuple[Vector, Vector]]:
    """Give the outward corners of every obstacle, holes and concave ones included.

    Parameters
    ----------
    obstacles : (rows, cols) bool
        The picture.
    tolerance : float
        Pixels by which the straight sides between corners may miss the obstacle's outline; fewer
        for one that is thinner than that.

    Returns
    -------
    list of ((x, y), (dx, dy))
        Each corner with the direction in which it points, a unit vector.
    """
    from skimage import measure

    found: list[tuple[Vector, Vector]] = []
    framed = np.pad(obstacles, 1).astype(np.float64)
    for outline in measure.find_contours(framed, 0.5):
        twice = np.rint(2 * (outline[:-1, ::-1] - 1)).astype(np.int64)  # whole numbers, as (x, y)
        kept, finer = _simplified(twice, tolerance), tolerance
        while len(kept) < 3:  # an obstacle thinner than the tolerance
            finer /= 2
            kept = _simplified(twice, finer)
        for before, at, after in zip(np.roll(kept, 1, 0), kept, np.roll(kept, -1, 0), strict=True):
            one, other = _unit(at - before), _unit(at - after)
            dx, dy = one[0] + other[0], one[1] + other[1]
            length = math.sqrt(dx * dx + dy * dy)
            if length < 1e-9:
                continue
            away = (dx / length, dy / length)
            place = (at[0] / 2, at[1] / 2)
            if not _at(obstacles, place[0] + 1.5 * away[0], place[1] + 1.5 * away[1]):
                found.append((place, away))
    return found


def ahead(ends: list[tuple[Vector, Vector]], distance: float) -> list[tuple[Vector, Vector]]:
    """Move points in their directions.

    Parameters
    ----------
    ends : list of ((x, y), (dx, dy))
        Points and directions, unit vectors.
    distance : float
        Pixels.

    Returns
    -------
    list of ((x, y), (dx, dy))
        The points, moved, and the same directions.
    """
    return [((x + distance * dx, y + distance * dy), (dx, dy)) for (x, y), (dx, dy) in ends]


def _simplified(outline: NDArray[np.int64], tolerance: float) -> NDArray[np.int64]:
    """Leave out what lies within a tolerance of a closed polygon (Douglas and Peucker 1973)."""
    ring = np.concatenate((outline, outline[:1]))
    far = int(np.argmax(((outline - outline[0]) ** 2).sum(axis=1)))
    keep = np.zeros(len(ring), dtype=np.bool_)
    keep[[0, far, len(outline)]] = True
    limit = (2 * tolerance) ** 2
    spans = [(0, far), (far, len(outline))]
    while spans:
        first, last = spans.pop()
        if last - first < 2:
            continue
        side = ring[last] - ring[first]
        offset = ring[first + 1 : last] - ring[first]
        away = np.abs(side[0] * offset[:, 1] - side[1] * offset[:, 0])
        most = int(np.argmax(away))
        if int(away[most]) ** 2 > limit * int(side @ side):
            middle = first + 1 + most
            keep[middle] = True
            spans += [(first, middle), (middle, last)]
    return ring[:-1][keep[:-1]]


def _unit(vector: NDArray[np.int64]) -> Vector:
    dx, dy = float(vector[0]), float(vector[1])
    length = math.sqrt(dx * dx + dy * dy)
    return dx / length, dy / length


def _at(obstacles: Picture, x: float, y: float) -> bool:
    """Tell whether an obstacle is at a point; outside the picture is none."""
    column, row = math.floor(x + 0.5), math.floor(y + 0.5)
    inside = 0 <= row < obstacles.shape[0] and 0 <= column < obstacles.shape[1]
    return inside and bool(obstacles[row, column])


def place(ends: list[tuple[Vector, Vector]], obstacles: Picture, push_out: bool) -> Points:
    """Round points to pixels; those outside the picture are left out.

    Parameters
    ----------
    ends : list of ((x, y), (dx, dy))
        Points and the directions in which they may be moved.
    obstacles : (rows, cols) bool
        The picture on which lines are drawn.
    push_out : bool
        Move a point that lies within an obstacle outwards to the first pixel that does not:
        no line to it could be free.

    Returns
    -------
    (n, 2) int32
        Pixels (x, y), n at most the number of points.
    """
    rows, cols = obstacles.shape
    pixels = []
    for (x, y), (dx, dy) in ends:
        column, row = math.floor(x + 0.5), math.floor(y + 0.5)
        moved = 0
        while push_out and 0 <= row < rows and 0 <= column < cols and obstacles[row, column]:
            moved += 1
            column = math.floor(x + moved * dx + 0.5)
            row = math.floor(y + moved * dy + 0.5)
        if 0 <= row < rows and 0 <= column < cols:
            pixels.append((column, row))
    return np.array(pixels, dtype=np.int32).reshape(-1, 2)
