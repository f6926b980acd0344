"""Straight on, and A* when something is in the way.

The robot follows the straight line to the target. Where what it knows blocks the line it
asks A* once and follows that path; as soon as the line from its own field is free again, it
goes straight on. A line, once taken, is followed until an obstacle is seen on it: the robot
turns from one to the other only after it learnt something, so it never goes to and fro.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gapath.driving.navigation import Call, Decision, Past, Situation, StreamOf
from gapath.driving.past_path import Track
from gapath.kernels.field_of_view import remaining_cost
from gapath.kernels.lines import ONE_OBSTACLE, line_key
from gapath.kernels.raster import polyline
from gapath.planning.shortest_path import shortest_path


@dataclass(frozen=True)
class Navigator:
    """A straight line, else A*; it has no settings.

    `Track.memory` is True while the robot follows a straight line.
    """

    complete = True

    def begin(self, query: Situation) -> Track:
        """Begin without a path."""
        return Track(Past((query.start,)), memory=False)

    def step(
        self, state: Track, query: Situation, news: NDArray[np.int64], streams: StreamOf
    ) -> Decision:
        """Go straight on if possible, else along A*'s path, else back a field."""
        table, rule = query.map.table, int(query.corner_cutting)
        free = state.path is not None and remaining_cost(table, state.path, state.at, rule) >= 0
        if free and state.memory:
            return state.go_on(to_end=True)
        if line_key(table, *query.start, *query.target, rule) < ONE_OBSTACLE:
            line = polyline(np.array([query.start, query.target], dtype=np.int32))
            return state._replace(memory=True).adopt(line).go_on(to_end=True)
        if free:
            return state.go_on()
        plan = shortest_path(query)
        calls = (Call("A" if state.returning else "C", 0, plan, plan.feasible),)
        state = state._replace(memory=False)
        return state.adopt(plan.path).go_on(calls) if plan.feasible else state.go_back(calls)
