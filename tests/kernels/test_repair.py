"""Paths that were cut and are repaired, against what must hold of any path."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from strategies import problems

from gapath.grid import GridMap
from gapath.kernels.field_of_view import remaining_cost
from gapath.kernels.repair import behind_cuts, repaired
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem

NOTHING = np.empty((0, 2), dtype=np.int32)


def order_of(grid):
    """Room full of numbers that could be places on a path."""
    return np.arange(grid.table.size, dtype=np.int32) % 7


@st.composite
def cut_paths(draw):
    """A problem, a path from before some obstacles were there, and where the robot is on it."""
    problem = draw(problems(16))
    path = shortest_path(problem).path
    grid = problem.map
    if len(path):
        weights = grid.weights.copy()
        for _ in range(draw(st.integers(0, 3))):
            x, y = path[draw(st.integers(0, len(path) - 1))].tolist()
            weights[y : y + draw(st.integers(1, 6)), x : x + draw(st.integers(1, 6))] = 1.0
        at = draw(st.integers(0, len(path) - 1))
        for x, y in (path[at], path[-1]):
            weights[y, x] = 0.5
        grid = GridMap("cut", weights)
    else:
        at = 0
    start = tuple(path[at].tolist()) if len(path) else problem.start
    return Problem(grid, start, problem.target, problem.corner_cutting), path, at


@given(cut_paths())
def test_a_repaired_path_is_free_and_there_is_one_wherever_there_can_be(case):
    problem, old, at = case
    grid, rule = problem.map, int(problem.corner_cutting)
    for path, robot in ((old, at), (NOTHING, 0)):
        new, cost = repaired(
            grid.table, path, robot, *problem.start, *problem.target, rule, order_of(grid)
        )
        assert (len(new) > 0) == shortest_path(problem).feasible
        if len(new):
            assert tuple(new[0]) == problem.start and tuple(new[-1]) == problem.target
            assert (np.abs(np.diff(new, axis=0)).max(axis=1, initial=0) <= 1).all()
            assert remaining_cost(grid.table, new, 0, rule) == cost


@given(cut_paths())
def test_the_end_of_a_path_is_free_from_behind_its_cuts(case):
    problem, path, at = case
    if not len(path):
        return
    rule, table = int(problem.corner_cutting), problem.map.table
    behind = behind_cuts(table, path, at, rule)
    assert remaining_cost(table, path, behind, rule) >= 0
    assert behind == at or remaining_cost(table, path, behind - 1, rule) < 0


def test_only_what_is_near_the_cut_changes():
    weights = np.full((60, 1000), 0.5)
    weights[20:40, 500] = 1.0
    weights[:50, 700] = 1.0
    grid = GridMap("walls", weights)
    x = np.arange(1000)
    y = 30 + np.clip(30 - np.abs(x - 700), 0, 20)  # round the second wall
    path = np.stack([x, y], axis=1).astype(np.int32)
    new, _ = repaired(grid.table, path, 480, 480, 30, 999, 30, 0, order_of(grid))
    assert new[-350:].tolist() == path[-350:].tolist()
    assert not grid.obstacles[new[:, 1], new[:, 0]].any()
    assert 10 <= np.abs(new[:60, 1] - 30).max() <= 11  # straight to the wall's end and on
