"""The obstacle avoidance of Kwasniewski & Gosiewski 2018 (KG18 Sec. 4).

The step function has three parts, as in Figs 11-14: A goes back in the robot's footsteps,
B follows the current path and looks for a better one, C looks for a new path when the
current one met an obstacle.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.driving.navigation import Call, Decision, Path, Situation, StreamOf
from gapath.driving.past_path import simplified
from gapath.errors import Checks, require
from gapath.events import Mode
from gapath.grid import Field
from gapath.kernels.field_of_view import remaining_cost
from gapath.kernels.rng import fill, high
from gapath.kernels.units import SCALE
from gapath.planning.planner import A_PLANNER, Planner

A, B, C, DRAW = 0, 1, 2, 3  # numbers of the parts in random streams


class State(NamedTuple):
    """What the step function remembers."""

    mode: Mode
    """Return mode or not."""
    path: Path | None
    """The current path, (n, 2) int32 as (x, y)."""
    at: int
    """Index of the robot's own field on it."""
    past: tuple[Field, ...]
    """The past path, the robot's own field last."""
    passed: int = 0
    """Fields passed since the path was adopted (B) or since the last call (A)."""
    due: int = 0
    """A calls its planner after this many fields."""
    walked_back: tuple[Field, ...] = ()
    """Fields left since return mode began."""

    def further(self, fields: tuple[Field, ...]) -> "State":
        """Pass the next fields of the current path."""
        at, passed = self.at + len(fields), self.passed + len(fields)
        return State(self.mode, self.path, at, self.past + fields, passed)


@dataclass(frozen=True)
class Navigator:
    """KG18's step function; ``conf/navigator/kg18.yaml`` says where each value comes from.

    Parameters
    ----------
    retreat : Planner
        Part A's planner.
    explore : Planner
        Part B's.
    replan : tuple of Planner
        Part C's, tried in this order; one that is no genetic algorithm may stand last.
    explore_interval : int
        B calls its planner every so many passed fields.
    retreat_interval : (int, int)
        A calls its planner after a number of fields drawn between these, both included.
    return_penalty : float
        Added to the weight of fields walked back, for A's planner only.
    """

    retreat: Any
    explore: Any
    replan: Any
    explore_interval: int
    retreat_interval: list[int]
    return_penalty: float

    def __post_init__(self) -> None:
        check = Checks(self, "navigator")
        check.whole("explore_interval", 1, 10**6)
        interval = self.retreat_interval
        good = len(interval) == 2 and 1 <= interval[0] <= interval[1] <= 10**6
        check("retreat_interval", good, "[least, most] with 1 <= least <= most <= 1000000")
        check("return_penalty", 0 <= self.return_penalty <= 1000, "a number in [0, 1000]")
        some = isinstance(self.replan, list | tuple) and len(self.replan) > 0
        check("replan", some, "a list of at least one planner")
        named = {"retreat": self.retreat, "explore": self.explore}
        named |= {f"replan[{i}]": planner for i, planner in enumerate(self.replan)}
        for name, planner in named.items():
            good = isinstance(planner, Planner)
            require(good, f"navigator.{name}", planner, A_PLANNER)

    @property
    def complete(self) -> bool:
        """Only with an exact planner last in part C; a genetic algorithm may miss."""
        return bool(self.replan[-1].exact)

    def begin(self, query: Situation) -> State:
        """Begin without a path, so that the first one comes from part C."""
        return State(Mode.EXPLORE, None, 0, (query.start,))

    def step(
        self, state: State, query: Situation, news: NDArray[np.int64], streams: StreamOf
    ) -> Decision:
        """KG18 Fig. 11."""
        if state.mode is Mode.RETURN:
            return self._part_a(state, query, streams)
        if state.path is not None:
            rest = remaining_cost(query.map.table, state.path, state.at, int(query.corner_cutting))
            if rest >= 0:
                return self._part_b(state, query, rest, streams)
        return self._part_c(state, query, streams)

    def _part_a(
        self, state: State, query: Situation, streams: StreamOf, calls: tuple[Call, ...] = ()
    ) -> Decision:
        """KG18 Fig. 12: go back, and on every second or third field look for a path."""
        if state.passed >= state.due:
            plan = self.retreat.plan(self._penalised(state, query), streams(A, 0))
            calls = (*calls, Call("A", 0, plan, plan.feasible))
            if plan.feasible:
                return self._follow(state, plan.path, Mode.EXPLORE, calls)
            state = state._replace(passed=0, due=self._draw_due(streams))
        if len(state.past) < 2:
            return Decision(query.start, Mode.RETURN, state, state, calls, None, state.past)
        stood = state._replace(passed=state.passed + 1)
        moved = stood._replace(
            past=state.past[:-1], walked_back=(*state.walked_back, state.past[-1])
        )
        return Decision(state.past[-2], Mode.RETURN, moved, stood, calls, None, state.past)

    def _part_b(self, state: State, query: Situation, rest: int, streams: StreamOf) -> Decision:
        """KG18 Fig. 13: go on; every few fields look for a better path."""
        path = state.path
        assert path is not None
        calls: tuple[Call, ...] = ()
        due = state.passed > 0 and state.passed % self.explore_interval == 0
        if due and rest > self._lower_bound(query):
            plan = self.explore.plan(query, streams(B, 0))
            better = plan.feasible and round(plan.cost * SCALE) < rest
            calls = (Call("B", 0, plan, better),)
            if better:
                return self._follow(state, plan.path, Mode.EXPLORE, calls)
        return self._advance(state, Mode.EXPLORE, calls)

    def _part_c(self, state: State, query: Situation, streams: StreamOf) -> Decision:
        """KG18 Fig. 14: look for a new path, thoroughly; without one go back."""
        calls: tuple[Call, ...] = ()
        for i, planner in enumerate(self.replan):
            plan = planner.plan(query, streams(C, i))
            calls = (*calls, Call("C", i, plan, plan.feasible))
            if plan.feasible:
                return self._follow(state, plan.path, Mode.REPLAN, calls)
        back = State(Mode.RETURN, None, 0, simplified(state.past), due=self._draw_due(streams))
        return self._part_a(back, query, streams, calls)

    def _follow(self, state: State, path: Path, mode: Mode, calls: tuple[Call, ...]) -> Decision:
        """Adopt a path and go to its next field."""
        adopted = State(Mode.EXPLORE, path, 0, state.past)
        return self._advance(adopted, mode, calls)

    def _advance(self, state: State, mode: Mode, calls: tuple[Call, ...]) -> Decision:
        """Go on along the path, as far as where B is due."""
        path, past = state.path, state.past
        assert path is not None
        rest = path[state.at :]
        if len(rest) < 2:
            return Decision(past[-1], mode, state, state, calls, rest, past)
        place = (int(rest[1, 0]), int(rest[1, 1]))
        due = self.explore_interval - state.passed % self.explore_interval
        fields = min(due, len(rest) - 1)
        return Decision(place, mode, state.further((place,)), state, calls, rest, past, fields)

    def _draw_due(self, streams: StreamOf) -> int:
        least, most = self.retreat_interval
        word = np.empty(1, dtype=np.uint64)
        fill(streams(DRAW, 0), word)
        return least + int(high(word[0], most - least + 1))

    def _lower_bound(self, query: Situation) -> int:
        """Give what no path can undercut, so that B need not look: exact, saves most calls."""
        (x, y), (u, v) = query.start, query.target
        distance = max(abs(u - x), abs(v - y))
        least = query.map.least_weight(query.start, query.target)
        table = query.map.table
        return int(table[y, x]) + least * (distance - 1) + int(table[v, u])

    def _penalised(self, state: State, query: Situation) -> Situation:
        if not self.return_penalty or not state.walked_back:
            return query
        return query._replace(map=query.map.dearer(state.walked_back, self.return_penalty))
