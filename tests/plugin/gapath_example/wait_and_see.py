"""Looks around in its place first, then does what repeated A* does."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gapath.driving.navigation import Call, Decision, Past, Situation, StreamOf
from gapath.driving.past_path import Track
from gapath.errors import require
from gapath.events import Mode
from gapath.kernels.field_of_view import remaining_cost
from gapath.planning.shortest_path import shortest_path


@dataclass(frozen=True)
class Navigator:
    """A* from the robot's field on the known map, after some steps without a move.

    Parameters
    ----------
    steps : int
        Steps to stand at the start.
    """

    steps: int

    complete = True

    def __post_init__(self) -> None:
        require(0 <= self.steps <= 1000, "navigator.steps", self.steps, "an integer from 0 to 1000")

    def begin(self, query: Situation) -> Track:
        """Remember how long to stand."""
        return Track(Past((query.start,)), memory=self.steps)

    def step(
        self, state: Track, query: Situation, news: NDArray[np.int64], streams: StreamOf
    ) -> Decision:
        """Stand, go on while the path is free, plan, or go back a field without a path."""
        if state.memory:
            waited = Track(state.past, memory=state.memory - 1)
            return Decision(query.start, Mode.EXPLORE, waited, waited, past=state.past)
        table, rule = query.map.table, int(query.corner_cutting)
        if state.path is not None and remaining_cost(table, state.path, state.at, rule) >= 0:
            return state.go_on(to_end=True)
        plan = shortest_path(query)
        calls = (Call("A" if state.returning else "C", 0, plan, plan.feasible),)
        if not plan.feasible:
            return state.go_back(calls)
        return state.adopt(plan.path).go_on(calls, to_end=True)
