"""The memetic planner's walls and strings in a drive: a path is repaired where it was cut.

The robot follows its path while that is free. Where it is cut, walls are followed round what is
in the way, loops are cut off and strings pulled (`gapath.kernels.repair`), and a path that is all
new is crossed with what comes out. Unknown fields count as free, so where the target can be reached
at all it is reached: a hand that comes round the wall proves where it cannot.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gapath.driving.navigation import Call, Decision, Path, Situation, StreamOf
from gapath.driving.past_path import Track
from gapath.kernels.field_of_view import remaining_cost
from gapath.kernels.repair import repaired
from gapath.kernels.units import SCALE
from gapath.problem import Plan, PlanStatus


@dataclass(frozen=True)
class Navigator:
    """The memetic planner's first path, repaired wherever it is cut; it has no settings.

    `Track.memory` is room for the kernel: nothing in it is remembered.
    """

    complete = True

    def begin(self, query: Situation) -> Track:
        """Begin without a path."""
        return Track((query.start,), memory=np.empty(query.map.table.size, dtype=np.int32))

    def step(
        self, state: Track, query: Situation, news: NDArray[np.int64], streams: StreamOf
    ) -> Decision:
        """Go on while the path is free; else repair it, and without a path go back a field.

        On the way back it plans in every step, because the map may have changed.
        """
        table, rule = query.map.table, int(query.corner_cutting)
        path = _NONE
        if state.path is not None:
            if remaining_cost(table, state.path, state.at, rule) >= 0:
                return state.go_on(to_end=True)
            path = state.path
        least = query.map.least_weight(query.start, query.target)
        path, cost = repaired(
            table, path, state.at, *query.start, *query.target, rule, least, state.memory
        )
        found = len(path) > 0
        plan = Plan(PlanStatus.FOUND, path, cost / SCALE) if found else Plan(PlanStatus.INFEASIBLE)
        calls = (Call("A" if state.returning else "C", 0, plan, found),)
        return state.adopt(path).go_on(calls, to_end=True) if found else state.go_back(calls)


_NONE: Path = np.empty((0, 2), dtype=np.int32)
