"""Any planner of the pixel grid, for a robot that is not a point: obstacles grow first."""

import dataclasses
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from gapath.errors import require
from gapath.grid import Field, GridMap
from gapath.kernels.rng import Stream
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.planning.planner import A_PLANNER, Particular
from gapath.planning.planner import Planner as AnyPlanner
from gapath.planning.stages import Stages
from gapath.problem import CornerCutting, Plan, PlanStatus, Query
from gapath.survey.obstacle_image import Clearance, dilate


@dataclass(frozen=True)
class Planner(Clearance):
    """Grows obstacles as M22 does and lets another planner plan between them.

    Parameters
    ----------
    robot_radius, radius_unit, radius_tolerance, element, threshold
        As of `gapath.survey.obstacle_image.Clearance`.
    planner : Planner
        Plans on the map of grown obstacles; in a YAML the name of its own as ``base``, and the
        values that replace that one's.
    """

    planner: Any

    exact = False

    def __post_init__(self) -> None:
        super().__post_init__()
        require(isinstance(self.planner, AnyPlanner), "planner.planner", self.planner, A_PLANNER)

    @property
    def minimises(self) -> str:
        """What its planner does."""
        return str(self.planner.minimises)

    def check(self, problem: Query) -> None:
        """Refuse what either part refuses.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.

        Raises
        ------
        InputError
            If the robot does not fit at an end, or the planner does not take such a map.
        """
        super().check(problem)
        if isinstance(self.planner, Particular):
            self.planner.check(self._grown(problem))

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Grow the obstacles, then plan.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        stream : (4,) uint64
            A random stream, advanced in place.

        Returns
        -------
        Plan
            The planner's, FOUND if it is OPTIMAL only where obstacles have grown; INFEASIBLE if the
            robot does not fit at an end.
        """
        stages = Stages()
        grown = self._grown(problem)
        stages.end("dilation")
        for x, y in (problem.start, problem.target):
            if grown.map.table[y, x] == OBSTACLE:
                return Plan(PlanStatus.INFEASIBLE, stages=stages.seconds)
        plan: Plan = self.planner.plan(grown, stream)
        stages.end("planning")
        status = PlanStatus.FOUND if plan.feasible else plan.status
        return dataclasses.replace(plan, status=status, stages=stages.seconds | dict(plan.stages))

    def _grown(self, problem: Query) -> "_Grown":
        obstacles = dilate(self.obstacles(problem), self.growth(problem))
        weights = np.minimum(problem.map.table / SCALE, _DEAREST)
        weights[obstacles] = 1.0
        grid = GridMap("grown", weights, resolution=problem.map.resolution)
        return _Grown(grid, problem.start, problem.target, problem.corner_cutting)


class _Grown(NamedTuple):
    """The same problem among grown obstacles."""

    map: GridMap
    start: Field
    target: Field
    corner_cutting: CornerCutting


_DEAREST = 1 - 1 / (16 * SCALE)
"""Of weights that are no obstacle; in fixed point it is 1."""
