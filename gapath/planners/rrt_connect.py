"""RRT-Connect (Kuffner & LaValle 2000), smoothed by shortcuts: how sampling planners do it."""

from dataclasses import dataclass

import numpy as np

from gapath.errors import Checks
from gapath.grid import MAX_SIDE
from gapath.kernels.graph_search import NO_PATH
from gapath.kernels.lines import Ends
from gapath.kernels.raster import polyline
from gapath.kernels.rivals.rrt_connect import rrt_connect
from gapath.kernels.rivals.shortcuts import shorten
from gapath.kernels.rng import Stream
from gapath.kernels.table import weights_of
from gapath.kernels.units import SCALE
from gapath.problem import Plan, PlanStatus, Query


@dataclass(frozen=True)
class Planner:
    """Two random trees over lines of the grid as all planners here draw them, then shortcuts.

    The trees heed obstacles only; a shortcut has to cost less: the length of its lines, each times
    the mean weight of its fields.

    Parameters
    ----------
    iterations : int
        Random fields towards which a tree grows.
    step : int
        Fields by which it grows at most.
    shortcuts : int
        Pairs of fields of the path that may be joined by a line.
    """

    iterations: int
    step: int
    shortcuts: int

    exact = False
    minimises = "line_length"

    def __post_init__(self) -> None:
        check = Checks(self, "planner")
        check.whole("iterations", 1, 10**7)
        check.whole("step", 1, MAX_SIDE)
        check.whole("shortcuts", 0, 10**6)

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Plan once.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        stream : (4,) uint64
            A random stream, advanced in place.

        Returns
        -------
        Plan
            FOUND, or NOT_FOUND when the iterations are spent. Its expansions are the fields of both
            trees, its cost is KG18 eq. (5) of the fields on its lines, which `lines` gives.
        """
        table, rule = problem.map.table, int(problem.corner_cutting)
        way_points = np.empty((2 * table.size + self.shortcuts, 2), dtype=np.int32)
        way_points[0], count = problem.start, 1
        fields = np.zeros(1, dtype=np.int64)
        if problem.start != problem.target:
            ends = Ends(*problem.start, *problem.target)
            count = rrt_connect(
                table, ends, rule, self.iterations, self.step, way_points, fields, stream
            )
            if count == NO_PATH:
                return Plan(PlanStatus.NOT_FOUND, expansions=int(fields[0]))
            count = shorten(table, way_points, count, rule, self.shortcuts, stream)
        lines = way_points[:count].copy()
        path = polyline(lines)
        total = weights_of(table, path)
        return Plan(
            PlanStatus.FOUND,
            path,
            total / SCALE,
            expansions=int(fields[0]),
            lines=lambda: lines,
        )
