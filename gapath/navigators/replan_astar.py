"""Repeated A*: plan anew, from scratch, whenever the current path is blocked.

What a robotics engineer would try first. Unknown fields count as free, so where the target
can be reached at all it is reached.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gapath.driving.navigation import Call, Decision, Past, Situation, StreamOf
from gapath.driving.past_path import Track
from gapath.kernels.field_of_view import remaining_cost
from gapath.planning.shortest_path import shortest_path


@dataclass(frozen=True)
class Navigator:
    """A* from the robot's field on the known map; it has no settings."""

    complete = True

    def begin(self, query: Situation) -> Track:
        """Begin without a path."""
        return Track(Past((query.start,)))

    def step(
        self, state: Track, query: Situation, news: NDArray[np.int64], streams: StreamOf
    ) -> Decision:
        """Go on while the path is free; else plan, and without a path go back a field.

        On the way back it plans in every step, because the map may have changed.
        """
        table, rule = query.map.table, int(query.corner_cutting)
        if state.path is not None and remaining_cost(table, state.path, state.at, rule) >= 0:
            return state.go_on(to_end=True)
        plan = shortest_path(query)
        calls = (Call("A" if state.returning else "C", 0, plan, plan.feasible),)
        if not plan.feasible:
            return state.go_back(calls)
        return state.adopt(plan.path).go_on(calls, to_end=True)
