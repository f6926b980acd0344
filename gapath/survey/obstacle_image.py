"""Obstacles as a picture, grown by the robot's radius (M22 Secs II.A and II.B.1).

White obstacles on a black floor; where the map is grey, a threshold decides what an obstacle
is. The picture is then dilated, so that a robot that is a point on it keeps its distance.
"""

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks, InputError, require, require_extra
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.problem import Query
from gapath.scenario.nearest import nearest_told, other_reading

Picture = NDArray[np.bool_]
"""True where an obstacle is, (rows, cols)."""

MAX_RADIUS = 1 << 12
"""Pixels by which obstacles may grow."""


@dataclass(frozen=True)
class Clearance:
    """How far a robot keeps from obstacles, and what an obstacle is.

    Parameters
    ----------
    robot_radius : float
        r_m of eq. (1).
    radius_unit : str
        "pixels", or "metres", on a map with a resolution; on another a pixel counts as one metre.
    radius_tolerance : float
        The tolerance of eq. (1) as a part of r_m.
    element : str
        The square of the dilation: "reach" grows obstacles by r_d to all sides; "width" takes a
        square r_d wide (made odd), which grows them by half of that, rounded down.
    threshold : str or float
        Fields that weigh at least so much are obstacles; "otsu" sets this by Otsu's method where
        the free fields do not all weigh the same (start and target apart).
    """

    robot_radius: float
    radius_unit: str
    radius_tolerance: float
    element: str
    threshold: str | float

    def __post_init__(self) -> None:
        kind = type(self).__module__.rpartition(".")[2]
        require_extra(f"planner {kind}", "image", "scikit-image")
        check = Checks(self, "planner")
        check("robot_radius", 0 <= self.robot_radius <= 10**6, "a number from 0 to 1000000")
        check("radius_unit", self.radius_unit in ("pixels", "metres"), '"pixels" or "metres"')
        check("radius_tolerance", 0 <= self.radius_tolerance <= 10, "a number from 0 to 10")
        check("element", self.element in ("reach", "width"), '"reach" or "width"')
        good = (
            self.threshold == "otsu" if isinstance(self.threshold, str) else 0 < self.threshold <= 1
        )
        check("threshold", good, '"otsu" or a weight in (0, 1]')

    def radius(self, problem: Query) -> int:
        """Give r_d of eq. (1), in pixels, exactly: 10 pixels and a tenth are 11, not 12.

        Parameters
        ----------
        problem : Query
            For the resolution of its map.

        Returns
        -------
        int
            r_d = ceil(r_m + tolerance).

        Raises
        ------
        InputError
            If that is more than `MAX_RADIUS`.
        """
        radius = Fraction(str(self.robot_radius)) * (1 + Fraction(str(self.radius_tolerance)))
        if self.radius_unit == "metres":
            radius /= Fraction(str(problem.map.resolution))
        grown = math.ceil(radius)
        require(
            grown <= MAX_RADIUS,
            "planner.robot_radius",
            f"{self.robot_radius} {self.radius_unit}, {grown} pixels with its tolerance",
            f"at most {MAX_RADIUS} pixels",
        )
        return grown

    def growth(self, problem: Query) -> int:
        """Give by how many pixels obstacles grow to each side."""
        radius = self.radius(problem)
        return radius if self.element == "reach" else radius // 2

    def obstacles(self, problem: Query) -> Picture:
        """Tell what is an obstacle: what no planner may enter, and what the threshold adds.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.

        Returns
        -------
        (rows, cols) bool
            The picture that the algorithm starts from.
        """
        table = problem.map.table
        least = OBSTACLE
        if not isinstance(self.threshold, str):
            least = math.ceil(self.threshold * SCALE)
        elif _is_grey(problem):
            from skimage.filters import threshold_otsu  # half a second: only where it is needed

            least = int(threshold_otsu(np.minimum(table, SCALE))) + 1
        return np.asarray(table >= least)

    def check(self, problem: Query) -> None:
        """Refuse a start or target where the robot does not fit.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.

        Raises
        ------
        InputError
            If one lies within a grown obstacle; names the nearest point that does not.
        """
        growth = self.growth(problem)
        obstacles = self.obstacles(problem)
        grown = dilate(obstacles, growth)
        for name, place in (("start", problem.start), ("target", problem.target)):
            if grown[place[1], place[0]]:
                nearest = nearest_told(problem.map, grown, place)
                right = (
                    f"a point where the robot fits; the nearest is {nearest}"
                    if nearest
                    else "a map with room for the robot; this one has none, or planner.robot_radius"
                    " and planner.threshold that leave some"
                )
                right += other_reading(problem.map, ~obstacles, [problem.start, problem.target])
                found = f"{list(place)}, within an obstacle grown by {growth} pixels"
                raise InputError(f"map.{name}", found, right)


def _is_grey(problem: Query) -> bool:
    """Tell whether free fields other than start and target weigh differently."""
    table = problem.map.table
    free = table < OBSTACLE
    for x, y in (problem.start, problem.target):
        free[y, x] = False
    first = table.flat[free.argmax()]  # of no free field anything
    return bool((free & (table != first)).any())


def dilate(obstacles: Picture, growth: int) -> Picture:
    """Grow obstacles by a square, so many pixels to each side.

    Parameters
    ----------
    obstacles : (rows, cols) bool
        The picture.
    growth : int
        Pixels.

    Returns
    -------
    (rows, cols) bool
        True within `growth` of an obstacle, by the Chebyshev distance.
    """
    grown = obstacles
    for axis in (0, 1):  # a square is a row of columns
        grown = _towards(_towards(grown, growth, axis, True), growth, axis, False)
    return grown


def _towards(picture: Picture, growth: int, axis: int, first: bool) -> Picture:
    """Grow along one axis in one direction: with each copy nearly twice as far as before."""
    reach = 0
    while reach < growth:
        step = min(reach + 1, growth - reach)
        near, far = [slice(None)] * 2, [slice(None)] * 2
        near[axis], far[axis] = slice(None, -step), slice(step, None)
        into, out_of = (near, far) if first else (far, near)
        grown = picture.copy()
        grown[tuple(into)] |= picture[tuple(out_of)]
        picture, reach = grown, reach + step
    return picture
