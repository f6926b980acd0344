"""Lazy Theta* (Nash, Koenig & Tovey 2010): short and smooth paths of straight lines."""

from dataclasses import dataclass

import numpy as np

from gapath.kernels.graph_search import NO_PATH
from gapath.kernels.raster import polyline
from gapath.kernels.rivals.lazy_theta import lazy_theta, way_points_to
from gapath.kernels.rng import Stream
from gapath.kernels.table import weights_of
from gapath.kernels.units import SCALE
from gapath.problem import Plan, PlanStatus, Query


@dataclass(frozen=True)
class Planner:
    """Any-angle search over lines of the grid as all planners here draw them.

    It finds a path wherever there is one, seldom the shortest. What it seeks the least of is the
    length of its lines, each times the mean weight of its fields.
    """

    exact = True
    minimises = "line_length"

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Find a short path; the stream is not used.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        stream : (4,) uint64
            Not used.

        Returns
        -------
        Plan
            FOUND, or INFEASIBLE where no path exists. Its cost is KG18 eq. (5) of the fields on its
            lines, which `lines` gives.
        """
        grid, table = problem.map, problem.map.table
        rule, least = int(problem.corner_cutting), grid.least_weight(problem.start, problem.target)
        costs, expansions = np.zeros(table.size, dtype=np.int64), np.zeros(1, dtype=np.int64)
        parents = np.empty(table.size, dtype=np.int32)
        (x, y), (u, v) = problem.start, problem.target
        count = lazy_theta(table, x, y, u, v, rule, least, costs, parents, expansions)
        if count == NO_PATH:
            return Plan(PlanStatus.INFEASIBLE, expansions=int(expansions[0]))
        way_points = way_points_to(parents, table.shape[1], u, v, count)
        path = polyline(way_points)
        total = weights_of(table, path)
        return Plan(
            PlanStatus.FOUND,
            path,
            total / SCALE,
            expansions=int(expansions[0]),
            lines=lambda: way_points,
        )
