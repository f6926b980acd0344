"""D* Lite: repair the shortest path after every change (Koenig & Likhachev 2002).

Unlike repeated A* it keeps its search from step to step, and its path is a cheapest one on
the known map in every step, not only when it was planned.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gapath.driving.navigation import Call, Decision, Past, Situation, StreamOf
from gapath.driving.past_path import Track
from gapath.errors import require
from gapath.grid import Field
from gapath.kernels.rivals import dstar_lite as kernels
from gapath.kernels.rivals.dstar_lite import LENGTH_BITS, MAX_FIELDS, Heuristic, Search
from gapath.kernels.units import SCALE
from gapath.problem import Plan, PlanStatus, Query


class Repair:
    """A search that follows the robot and the known map.

    Parameters
    ----------
    query : Situation
        The first field, the target, and what is known before the first repair.
    """

    def __init__(self, query: Situation) -> None:
        known = query.map
        count = known.rows * known.cols
        self._search = Search(
            known.table.copy(),
            np.empty(count, dtype=np.int64),
            np.empty(count, dtype=np.int64),
            np.empty(count, dtype=np.int64),
            np.empty(count, dtype=np.int64),
            np.empty((count, 2), dtype=np.int64),
            query.target,
            int(query.corner_cutting),
        )
        self._size = kernels.begin(self._search)
        self._began = query.start
        light = int(known.table[query.start[1], query.start[0]])
        self._heuristic = Heuristic(query.start, self._least(query), query.start, light, 0)

    def _least(self, query: Situation) -> int:
        return query.map.least_weight(self._began, query.target)

    def changed(self, query: Situation, news: NDArray[np.int64]) -> NDArray[np.int64]:
        """Give those of the news that differ from what the search knows."""
        known, own = query.map.table.ravel(), self._search.table.ravel()
        changed: NDArray[np.int64] = news[known[news] != own[news]]
        return changed

    def plan(self, query: Situation, changed: NDArray[np.int64]) -> Plan:
        """Give a cheapest path from the robot's field.

        Parameters
        ----------
        query : Situation
            The robot's field, and what is known now.
        changed : (n,) int64
            Flat indices of the fields that changed since the last call.
        """
        self._follow(query.start, self._least(query))
        self._size, expansions, path = kernels.repair(
            self._search, self._heuristic, self._size, query.map.table, changed
        )
        if not len(path):
            return Plan(PlanStatus.INFEASIBLE, expansions=int(expansions))
        (x, y), (u, v) = query.start, query.target
        cost = int(self._search.rhs[y * query.map.cols + x]) >> LENGTH_BITS
        total = cost + int(query.map.table[v, u])
        return Plan(PlanStatus.OPTIMAL, path, total / SCALE, expansions=int(expansions))

    def _follow(self, robot: Field, least: int) -> None:
        """Move the robot; keys already queued stay lower bounds, or are made anew."""
        before = self._heuristic
        offset = before.offset + int(kernels.bound(before, *robot))
        self._heuristic = before._replace(robot=robot, least=least, offset=offset)
        if least < before.least:
            kernels.requeue(self._search, self._heuristic, self._size)


@dataclass(frozen=True)
class Navigator:
    """D* Lite on the known map; it has no settings.

    `Track.memory` is the search. It knows only the map and the robot's field, so a robot that
    had to stand finds it as it needs it.
    """

    complete = True

    def check(self, problem: Query) -> None:
        """Refuse a map of more than `MAX_FIELDS` fields; raises InputError."""
        cols, rows = problem.map.cols, problem.map.rows
        require(
            cols * rows <= MAX_FIELDS,
            "map",
            f"{cols} x {rows} fields",
            f"at most {MAX_FIELDS} fields in all for D* Lite, whose costs are exact up to there: "
            "navigator=replan_astar takes larger maps",
        )

    def begin(self, query: Situation) -> Track:
        """Begin a search without a path; raises InputError as `check` does."""
        self.check(query)
        return Track(Past((query.start,)), memory=Repair(query))

    def step(
        self, state: Track, query: Situation, news: NDArray[np.int64], streams: StreamOf
    ) -> Decision:
        """Go on along the path; repair it if the map changed, and without one go back a field."""
        changed = state.memory.changed(query, news)
        first = state.path is None and not state.returning
        if not first and not len(changed):
            return state.go_back() if state.returning else state.go_on()
        plan = state.memory.plan(query, changed)
        calls = (Call("A" if state.returning else "C", 0, plan, plan.feasible),)
        return state.adopt(plan.path).go_on(calls) if plan.feasible else state.go_back(calls)
