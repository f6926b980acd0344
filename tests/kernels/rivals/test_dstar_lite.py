"""D* Lite against A* from scratch, after every one of many changes."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import problems

from gapath.driving.navigation import Situation
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.navigators.dstar_lite import Navigator, Repair
from gapath.planning.flaw import flaw
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem

WEIGHTS = [0.0, 0.25, 0.5, 1 / 3, 0.999, 1.0, 1.0, 1.0]


class Changing:
    """A map whose weights change, with a bound that only falls, like what a robot knows."""

    def __init__(self, problem):
        self.weights = problem.map.weights.copy()
        self.ends = (problem.start, problem.target)
        self.table = problem.map.table.copy()
        self.rows, self.cols = self.table.shape
        self.least = 1 << 24
        self.least_weight(*self.ends)

    def change(self, places, values):
        for (x, y), value in zip(places, values, strict=True):
            if (x, y) not in self.ends:
                self.weights[y, x] = value
        self.table[:] = GridMap("now", self.weights).table

    def least_weight(self, start, target):
        others = self.table.copy()
        for x, y in self.ends:
            others[y, x] = 1 << 24
        self.least = min(self.least, int(others.min()))
        return self.least


def check(repair, now, query, rule, changed):
    plan = repair.plan(query, changed)
    problem = Problem(GridMap("now", now.weights), query.start, query.target, rule)
    assert plan.cost == shortest_path(problem).cost
    if plan.feasible:
        assert flaw(problem, plan.path) is None
        entries = now.table[plan.path[:, 1], plan.path[:, 0]]
        assert plan.cost == entries.sum() / 65536
    return plan


@given(problems(most=14), st.data())
def test_costs_equal_astar_after_every_change(problem, data):
    now = Changing(problem)
    query = Situation(now, problem.start, problem.target, problem.corner_cutting)
    repair = Repair(query)
    places = st.tuples(st.integers(0, now.cols - 1), st.integers(0, now.rows - 1))
    plan = check(repair, now, query, problem.corner_cutting, np.empty(0, dtype=np.int64))
    for _ in range(data.draw(st.integers(1, 6))):
        if plan.feasible:
            ahead = data.draw(st.integers(0, len(plan.path) - 1))
            query = query._replace(start=tuple(map(int, plan.path[ahead])))
        fields = [p for p in data.draw(st.lists(places, max_size=12)) if p != query.start]
        values = data.draw(st.tuples(*[st.sampled_from(WEIGHTS) for _ in fields]))
        now.change(fields, values)
        flat = np.array([y * now.cols + x for x, y in fields], dtype=np.int64)
        plan = check(repair, now, query, problem.corner_cutting, repair.changed(query, flat))


@pytest.mark.parametrize("seed", range(60))
def test_costs_equal_astar_on_a_long_way(seed):
    """The robot goes on step by step while walls come and go; later lighter fields appear.

    While all weights are equal the bound is tight, so a key that is not a lower bound shows.
    """
    random = np.random.default_rng(seed)
    values = np.full((24, 32), 0.5)
    values[2, 16] = random.choice([0.0, 0.5])  # a light start that may lie on the way
    problem = Problem(GridMap("long", values), (16, 2), (30, 20))
    now = Changing(problem)
    query = Situation(now, problem.start, problem.target, problem.corner_cutting)
    repair = Repair(query)
    flat = np.empty(0, dtype=np.int64)
    for step in range(40):
        plan = check(repair, now, query, problem.corner_cutting, repair.changed(query, flat))
        if plan.feasible:
            ahead = min(int(random.integers(0, 4)), len(plan.path) - 1)
            query = query._replace(start=tuple(map(int, plan.path[ahead])))
        x, y = (int(random.integers(0, side)) for side in (32, 24))
        length, across = int(random.integers(1, 12)), bool(random.integers(2))
        wall = [(x + i, y) if across else (x, y + i) for i in range(length)]
        fields = [p for p in wall if p[0] < 32 and p[1] < 24 and p != query.start]
        value = random.choice([0.5, 1.0, 1.0] if step < 25 else [0.5, 1.0, 0.25, 0.125])
        now.change(fields, [value] * len(fields))
        flat = np.array([v * 32 + u for u, v in fields], dtype=np.int64)


def test_a_light_lane_far_from_what_was_searched_is_found():
    """Lighter fields than any before make the queued keys too large: they are made anew."""
    problem = Problem(GridMap("lane", np.full((24, 60), 0.5)), (5, 12), (55, 12))
    now = Changing(problem)
    query = Situation(now, problem.start, problem.target, problem.corner_cutting)
    repair = Repair(query)
    check(repair, now, query, problem.corner_cutting, np.empty(0, dtype=np.int64))
    lane = [(x, 4) for x in range(13, 48)]
    now.change(lane, [0.125] * len(lane))
    flat = np.array([y * 60 + x for x, y in lane], dtype=np.int64)
    plan = check(repair, now, query, problem.corner_cutting, repair.changed(query, flat))
    assert plan.cost < 51 * 0.5


def test_a_repair_is_cheaper_than_a_search():
    values = np.full((60, 120), 0.5)
    values[20:40, 60] = 1.0
    problem = Problem(GridMap("wall", values), (0, 30), (118, 30))
    now = Changing(problem)
    query = Situation(now, problem.start, problem.target, problem.corner_cutting)
    repair = Repair(query)
    first = repair.plan(query, np.empty(0, dtype=np.int64))
    x, y = map(int, first.path[3])
    now.change([(x, y)], [1.0])
    again = repair.plan(query, np.array([y * 120 + x]))
    assert again.expansions < first.expansions / 4


def test_a_map_too_large_for_its_costs_is_refused():
    navigator = Navigator()
    grid = SimpleNamespace(rows=2**10, cols=2**10)
    query = Situation(grid, (0, 0), (1, 1), 0)
    navigator.check(query)
    grid.cols += 1
    for refuse in (navigator.check, navigator.begin):
        with pytest.raises(InputError, match="1025 x 1024 fields, expected at most 1048576"):
            refuse(query)
