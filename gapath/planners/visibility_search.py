"""A* and Dijkstra on M22's visibility graph: the exact answer to what its GA searches for."""

from dataclasses import dataclass
from functools import partial

from gapath.errors import InputError
from gapath.kernels.rng import Stream
from gapath.planning.stages import Stages
from gapath.problem import Plan, PlanStatus, Query
from gapath.survey.visibility_graph import Surveyor


@dataclass(frozen=True)
class Planner(Surveyor):
    """Shortest path through the visibility graph.

    Parameters
    ----------
    robot_radius, radius_unit, radius_tolerance, element, threshold
        As of `gapath.survey.obstacle_image.Clearance`.
    keypoints, corner_tolerance, push_out, resize
        As of `gapath.survey.visibility_graph.Surveyor`.
    informed : bool
        True for A*, False for Dijkstra.
    """

    informed: bool

    exact = False
    minimises = "line_length"

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Make the graph and search it; the stream is not used.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        stream : (4,) uint64
            Not used.

        Returns
        -------
        Plan
            FOUND, or INFEASIBLE if no path of the graph joins start and end; NOT_FOUND for what
            `check` refuses and a robot has come to know only now.
        """
        stages = Stages()
        try:
            graph = self.survey(problem, stages)
        except InputError:
            return Plan(PlanStatus.NOT_FOUND, stages=stages.seconds)
        indices, expansions = graph.shortest(self.informed)
        stages.end("search")
        plan = Plan(
            PlanStatus.INFEASIBLE,
            expansions=expansions,
            survey=partial(graph.drawn, problem),
            stages=stages.seconds,
        )
        return graph.answer(plan, indices, problem) if len(indices) else plan
