"""Jump point search: A* on maps whose fields weigh the same, by jumps (Harabor & Grastien 2011).

It finds what A* finds, the same cost to the last bit, where it may be asked.
"""

from dataclasses import dataclass

import numpy as np

from gapath.errors import require
from gapath.grid import GridMap
from gapath.kernels.graph_search import DIAGONAL, NO_PATH, STRAIGHT
from gapath.kernels.rivals.jump_points import jump_search, jumped_path
from gapath.kernels.rng import Stream
from gapath.kernels.table import weights_of
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.problem import Plan, PlanStatus, Query

STEPS = {"weights": (1, 1), "length": (STRAIGHT, DIAGONAL)}
"""Lengths of straight and diagonal steps by what is minimised: equal ones by KG18 eq. (5)."""


@dataclass(frozen=True)
class Planner:
    """Jump point search on the 8-connected grid, nothing prepared beforehand.

    Parameters
    ----------
    minimise : str
        "weights": the sum of the weights of the path's fields (KG18 eq. (5)), and of equal ones
        the number of its fields; all free fields but start and target have to weigh the same;
        "length": the octile length, on any map.
    """

    minimise: str

    exact = optimal = True

    def __post_init__(self) -> None:
        require(
            self.minimise in STEPS,
            "planner.minimise",
            self.minimise,
            '"weights" or "length"',
        )

    @property
    def minimises(self) -> str:
        """As its setting says."""
        return self.minimise

    def check(self, problem: Query) -> None:
        """Refuse a map whose weights it would have to compare.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.

        Raises
        ------
        InputError
            If free fields other than start and target differ in weight.
        """
        require(
            self._takes(problem),
            "map",
            "fields of several weights",
            "one weight for all free fields but start and target: planner=astar takes any map, "
            "planner.minimise=length heeds no weights",
        )

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Find a cheapest path; the stream is not used.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        stream : (4,) uint64
            Not used.

        Returns
        -------
        Plan
            OPTIMAL, by length FOUND, or INFEASIBLE where no path exists; NOT_FOUND for what `check`
            refuses and a robot has come to know only now.
        """
        if not self._takes(problem):
            return Plan(PlanStatus.NOT_FOUND)
        table, rule = problem.map.table, int(problem.corner_cutting)
        turns, expansions = np.empty(table.size, dtype=np.int64), np.zeros(1, dtype=np.int64)
        (x, y), (u, v) = problem.start, problem.target
        count = jump_search(table, x, y, u, v, rule, *STEPS[self.minimise], turns, expansions)
        if count == NO_PATH:
            return Plan(PlanStatus.INFEASIBLE, expansions=int(expansions[0]))
        path = jumped_path(turns[:count], table.shape[1], rule)
        total = weights_of(table, path)
        status = PlanStatus.FOUND if self.minimise == "length" else PlanStatus.OPTIMAL
        return Plan(status, path, total / SCALE, expansions=int(expansions[0]))

    def _takes(self, problem: Query) -> bool:
        if self.minimise == "length":
            return True
        grid, ends = problem.map, (problem.start, problem.target)
        if isinstance(grid, GridMap):
            return grid.is_even(*ends)
        others = grid.table.copy()  # what a robot knows of its map, which changes
        for x, y in ends:
            others[y, x] = OBSTACLE
        free = others[others < OBSTACLE]
        return not len(free) or bool(free.min() == free.max())
