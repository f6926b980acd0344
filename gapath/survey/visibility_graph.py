"""From a map to a visibility graph (M22 Secs II.A to II.C): dilation, keypoints, free lines."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks, require
from gapath.history.graph import Graph
from gapath.kernels.m22.graph import END, START, graph_lengths, line_is_free, shortest
from gapath.kernels.raster import polyline
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.planning.stages import Stages
from gapath.problem import CornerCutting, Plan, PlanStatus, Query, no_path
from gapath.survey.keypoints import Points, Vector, ahead, axis_ends, corners, label, place
from gapath.survey.obstacle_image import Clearance, Picture, dilate
from gapath.survey.resizing import coarsest_scale, growth_at, shrunk

MAX_POINTS = 4096
"""Points of the largest graph: its lengths then take 128 MiB."""

MAX_OUTLINE = 1 << 17
"""Sides of pixels between obstacles and floor, at most: all outlines together."""


class VisibilityGraph(NamedTuple):
    """Points, and the straight lines between them that meet no obstacle."""

    obstacles: Picture
    """The picture on which lines are drawn, grown by the robot's radius, (rows, cols)."""
    points: Points
    """(n, 2) pixels (x, y) of that picture: the start, the end, the keypoints."""
    lengths: NDArray[np.int64]
    """(n, n) in units of 1 / SCALE pixels of the picture, or `BLOCKED`."""
    scale: int
    """Pixels of the map, along a side, that are one of the picture."""
    obstacle_count: int
    """Number of obstacles."""
    full: Picture
    """The grown obstacles at full size, (rows, cols) of the map."""

    def shortest(self, informed: bool) -> tuple[NDArray[np.int32], int]:
        """Find the shortest path through the graph.

        Parameters
        ----------
        informed : bool
            True for A*, False for Dijkstra.

        Returns
        -------
        indices : (m,) int32
            Points from the start to the end; none if no path joins them.
        expansions : int
            Points that the search expanded.
        """
        n = len(self.points)
        before, expansions = np.empty(n, dtype=np.int32), np.empty(1, dtype=np.int64)
        costs = np.empty(n, dtype=np.int64)
        length = shortest(self.lengths, self.points, informed, costs, before, expansions)
        indices = [END] if length >= 0 else []
        while indices and indices[-1] != START:
            indices.append(int(before[indices[-1]]))
        return np.array(indices[::-1], dtype=np.int32), int(expansions[0])

    def drawn(self, problem: Query) -> Graph:
        """Give the graph as recordings show it."""
        edges = np.argwhere(np.triu(self.lengths >= 0, 1)).astype(np.int32)
        return Graph(self.obstacles, self.scale, self.on_map(problem), edges)

    def answer(self, plan: Plan, indices: NDArray[np.int32], problem: Query) -> Plan:
        """Give a plan its path.

        Parameters
        ----------
        plan : Plan
            A plan without a path.
        indices : (m,) int32
            Points from the start to the end, joined by free lines.
        problem : Query
            The problem whose graph this is.

        Returns
        -------
        Plan
            FOUND.
        """
        straight = self.straight(indices, problem)
        path = polyline(straight) if straight is not None else self.through(indices, problem)
        cost = int(problem.map.table[path[:, 1], path[:, 0]].sum(dtype=np.int64)) / SCALE
        return replace(
            plan,
            status=PlanStatus.FOUND,
            path=path,
            weights=cost,
            lines=no_path if straight is None else lambda: straight,
        )

    def on_map(self, problem: Query) -> Points:
        """Give where the points lie on the map, (n, 2) pixels (x, y)."""
        if self.scale == 1:
            return self.points
        points = self._representatives(self.points, problem)
        points[START], points[END] = problem.start, problem.target
        return points

    def straight(self, indices: NDArray[np.int32], problem: Query) -> Points | None:
        """Give the points of a path on the map, if the straight lines between them are free.

        They always are unless the picture was made smaller: a line of the small picture is only
        nearly one of the map, and may graze what that one misses.

        Parameters
        ----------
        indices, problem
            As of `answer`.

        Returns
        -------
        (m, 2) int32 or None
            Pixels (x, y) of the map.
        """
        points, rule = self.on_map(problem)[indices], int(problem.corner_cutting)
        if self.scale > 1:
            table = np.where(self.full, np.int32(OBSTACLE), np.int32(0))
            for (x0, y0), (x1, y1) in pairwise(points.tolist()):
                if not line_is_free(table, x0, y0, x1, y1, rule):
                    return None
        return points

    def through(self, indices: NDArray[np.int32], problem: Query) -> Points:
        """Give the fields of a path on the map that keeps to the blocks of the small picture.

        Parameters
        ----------
        indices : (m,) int32
            Points from the first to the last one, joined by free lines.
        problem : Query
            The problem whose graph this is.

        Returns
        -------
        (k, 2) int32
            Fields (x, y) from start to target, each a neighbour of the one before.
        """
        fields = polyline(self.points[indices])
        # From block to block, straight to the next one's representative or over the corner that
        # both share: any other line could enter a third block.
        step = np.diff(fields, axis=0)
        diagonal = step.all(axis=1)
        through = np.repeat(self._representatives(fields, problem)[:, np.newaxis], 3, axis=1)
        leave = fields[:-1] * self.scale + np.where(step > 0, self.scale - 1, 0)
        through[:-1][diagonal, 1] = leave[diagonal]
        through[:-1][diagonal, 2] = (leave + step)[diagonal]

        ends = np.array([problem.start, problem.target], dtype=np.int32)
        bends = ends
        if problem.corner_cutting is CornerCutting.NO_DIAGONALS:  # within the ends' blocks
            bends = np.stack((through[[0, -1], 0, 0], ends[:, 1]), axis=1)
        inner = through.reshape(-1, 2)
        return polyline(np.concatenate((ends[:1], bends[:1], inner, bends[1:], ends[1:])))

    def _representatives(self, blocks: Points, problem: Query) -> Points:
        last = (problem.map.rows - 1) % self.scale, (problem.map.cols - 1) % self.scale
        offset = min(self.scale // 2, *last)  # the same in every block, also in a cut one
        return (blocks * self.scale + offset).astype(np.int32)


@dataclass(frozen=True)
class Surveyor(Clearance):
    """Makes visibility graphs.

    Parameters
    ----------
    robot_radius, radius_unit, radius_tolerance, element, threshold
        As of `gapath.survey.obstacle_image.Clearance`.
    keypoints : str
        "axes": four an obstacle, the ends of its main axes; "corners": its outward corners.
    corner_tolerance : float
        Pixels by which the sides between corners may miss an outline.
    push_out : bool
        Move keypoints that lie within a grown obstacle outwards.
    resize : bool
        Work on the smallest picture that closes no gap; paths may be longer.
    """

    keypoints: str
    corner_tolerance: float
    push_out: bool
    resize: bool

    def __post_init__(self) -> None:
        super().__post_init__()
        check = Checks(self, "planner")
        check("keypoints", self.keypoints in ("axes", "corners"), '"axes" or "corners"')
        good = 0 < self.corner_tolerance <= 100
        check("corner_tolerance", good, "a number of pixels in (0, 100]")

    def check(self, problem: Query) -> None:
        """Refuse a start or target where the robot does not fit, and too many keypoints.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.

        Raises
        ------
        InputError
            As of `gapath.survey.obstacle_image.Clearance.check` and `survey`.
        """
        self.count_obstacles(problem)

    def count_obstacles(self, problem: Query) -> int:
        """Count the obstacles of the graph of a problem; raises InputError as `check` does."""
        super().check(problem)
        return self._found(self._grown(problem, Stages())[0])[1]

    def survey(self, problem: Query, stages: Stages) -> VisibilityGraph:
        """Make the graph of a problem.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        stages : Stages
            Takes the times of "resizing", "dilation", "keypoints" and "graph".

        Returns
        -------
        VisibilityGraph
            A start or end within an obstacle has no line.

        Raises
        ------
        InputError
            If there are too many keypoints.
        """
        grown, scale, full = self._grown(problem, stages)
        found, count = self._found(grown)
        ends = np.array([problem.start, problem.target], dtype=np.int32) // scale
        points = np.concatenate((ends, place(found, grown, self.push_out)))
        stages.end("keypoints")

        lengths = np.empty((len(points), len(points)), dtype=np.int64)
        table = np.where(grown, np.int32(OBSTACLE), np.int32(0))
        graph_lengths(table, points, int(problem.corner_cutting), lengths)
        stages.end("graph")
        return VisibilityGraph(grown, points, lengths, scale, count, full)

    def _grown(self, problem: Query, stages: Stages) -> tuple[Picture, int, Picture]:
        """Give the picture on which lines are drawn, its scale, and the one at full size."""
        obstacles, growth = self.obstacles(problem), self.growth(problem)
        if not self.resize:
            grown = dilate(obstacles, growth)
            stages.end("dilation")
            return grown, 1, grown
        full = dilate(obstacles, growth)
        scale = coarsest_scale(obstacles, full, growth, (problem.start, problem.target))
        stages.end("resizing")
        grown = dilate(shrunk(obstacles, scale), growth_at(scale, growth))
        stages.end("dilation")
        return grown, scale, full

    def _found(self, grown: Picture) -> tuple[list[tuple[Vector, Vector]], int]:
        """Find keypoints, as `place` takes them, and count obstacles."""
        labels, count = label(grown)
        expected = (
            f"at most {MAX_POINTS - 2}: a larger planner.corner_tolerance or robot_radius, or a"
            " smaller map"
        )
        if self.keypoints == "axes":
            require(4 * count + 2 <= MAX_POINTS, "map", f"{4 * count} keypoints", expected)
            return axis_ends(labels), count
        sides = int(np.diff(grown, axis=0).sum() + np.diff(grown, axis=1).sum())
        require(
            sides <= MAX_OUTLINE,
            "map",
            f"{sides} sides of pixels between obstacles and floor",
            f"at most {MAX_OUTLINE}: a larger planner.robot_radius, or a smaller map",
        )
        # Sides may cut into outlines: if it were not ahead, no corner would see its neighbours.
        found = ahead(corners(grown, self.corner_tolerance), self.corner_tolerance + 1)
        require(len(found) + 2 <= MAX_POINTS, "map", f"{len(found)} keypoints", expected)
        return found, count
