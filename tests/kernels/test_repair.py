"""Paths that were cut and are repaired, against what must hold of any path."""

import numpy as np
import pytest
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
            grid.table, path, robot, *problem.start, *problem.target, rule, 0, order_of(grid)
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


def route(grid, path, at, start, target):
    least = int(grid.table.min())
    return repaired(grid.table, path, at, *start, *target, 0, least, order_of(grid))


def test_what_lies_behind_the_next_wall_stays():
    weights = np.full((60, 1000), 0.5)
    weights[:50, 700] = 1.0
    path, _ = route(GridMap("one", weights), NOTHING, 0, (0, 30), (999, 30))
    weights[:45, 500] = 1.0
    grid = GridMap("two", weights)
    new, _ = route(grid, path, 480, tuple(path[480].tolist()), (999, 30))
    assert new[-299:].tolist() == path[-299:].tolist()
    assert new[20].tolist() == [500, 45] != path[500].tolist()


@pytest.mark.parametrize(("longer", "keeps"), [(6, True), (11, False)])
def test_it_changes_sides_only_where_that_saves_enough(longer, keeps):
    """A path round the farther end of a wall is cut near the robot; the other end saves 2 a row."""
    weights = np.full((120, 150), 0.5)
    weights[30 : 71 + longer, 75] = 1.0
    start, target, end = (65, 50), (85, 50), 71 + longer
    corner = np.arange(51, end + 1)
    left, right = np.minimum(65 + corner - 50, 74), np.minimum(76 + end - corner, 85)
    down, up = np.stack([left, corner], axis=1), np.stack([right, corner], axis=1)[::-1]
    around = np.concatenate([[start], down, [[75, end]], up, [[85, 50]]]).astype(np.int32)
    weights[around[2, 1], around[2, 0]] = 1.0
    new, _ = route(GridMap("wall", weights), around, 0, start, target)
    assert (new[:, 1].max() > 60) == keeps
