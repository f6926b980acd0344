"""The memetic planner's walls and strings in a drive: a path is repaired where it was cut.

The robot follows its path while that is free. Where it is cut, walls are followed round what is
in the way, loops are cut off and strings pulled (`gapath.kernels.repair`), and a path that is all
new is crossed with what comes out. Unknown fields count as free, so where the target can be reached
at all it is reached: a hand that comes round the wall proves where it cannot.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.driving.navigation import Call, Decision, Past, Path, Situation, StreamOf
from gapath.driving.past_path import Track
from gapath.kernels.repair import FREE, repaired
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.problem import Answer, PlanStatus, no_path


class Memory(NamedTuple):
    """What lasts from one repair to the next."""

    order: NDArray[np.int32]
    """(rows * cols,) room for the kernel: nothing in it is remembered."""
    expected: int = 0
    """What a new path cost when one was last looked for, from where the path begins."""
    walls: NDArray[np.bool_] | None = None
    """(rows * cols,) the obstacles that were known when it was proved that there is no way."""


@dataclass(frozen=True)
class Navigator:
    """The memetic planner's first path, repaired wherever it is cut; it has no settings."""

    complete = True

    def begin(self, query: Situation) -> Track:
        """Begin without a path."""
        room = np.empty(query.map.table.size, dtype=np.int32)
        return Track(Past((query.start,)), memory=Memory(room))

    def step(
        self, state: Track, query: Situation, news: NDArray[np.int64], streams: StreamOf
    ) -> Decision:
        """Go on while the path is free; else repair it, and without a path go back a field.

        On the way back it plans only where an obstacle that was in the way has vanished.
        """
        known, memory = query.map, state.memory
        fields = known.table.ravel()
        if state.returning and not (memory.walls[news] & (fields[news] < OBSTACLE)).any():
            return state.go_back()
        ends, least = (*query.start, *query.target), known.least_weight(query.start, query.target)
        path, cost, expected = repaired(
            known.table,
            _NONE if state.path is None else state.path,
            state.at,
            *ends,
            int(query.corner_cutting),
            least,
            memory.expected,
            memory.order,
        )
        if cost == FREE:
            return state.go_on(to_end=True)
        part = "A" if state.returning else "C"
        if not len(path):
            state = state._replace(memory=Memory(memory.order, walls=fields >= OBSTACLE))
            return state.go_back((Call(part, 0, Answer(PlanStatus.INFEASIBLE), False),))
        calls = (Call(part, 0, Answer(PlanStatus.FOUND, path, cost / SCALE), True),)
        memory = Memory(memory.order, expected)
        return Track(state.past, path, memory=memory).go_on(calls, to_end=True)


_NONE: Path = no_path()
