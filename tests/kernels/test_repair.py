"""Paths that were cut and are repaired, against what must hold of any path."""

from itertools import product

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from strategies import problems

from gapath.grid import GridMap
from gapath.kernels.field_of_view import remaining_cost
from gapath.kernels.memetic.rays import ray
from gapath.kernels.repair import FREE, behind_cuts, goes_straight_on, last_beside, repaired
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
    ends = (*problem.start, *problem.target)
    weights = (0, grid.least_weight(problem.start, problem.target))
    for (path, robot), least in product(((old, at), (NOTHING, 0)), weights):
        new, cost, _ = repaired(grid.table, path, robot, *ends, rule, least, 0, order_of(grid))
        if cost == FREE:
            assert np.array_equal(new, path)
            assert len(path) and remaining_cost(grid.table, path, robot, rule) >= 0
            continue
        assert (len(new) > 0) == shortest_path(problem).feasible
        if len(new):
            assert tuple(new[0]) == problem.start and tuple(new[-1]) == problem.target
            assert (np.abs(np.diff(new, axis=0)).max(axis=1, initial=0) <= 1).all()
            assert remaining_cost(grid.table, new, 0, rule) == cost


@pytest.mark.parametrize("at", [0, 1, 5, 18])
def test_what_a_new_path_would_cost_falls_by_the_fields_that_the_robot_left_behind(at):
    """So much is expected that no new one is looked for."""
    weights = np.random.default_rng(at).integers(1, 60, (9, 30)) / 64
    path = np.stack([np.arange(30), np.full(30, 4)], axis=1).astype(np.int32)
    for cut in (False, True):
        weights[2:7, 20] = 1.0 if cut else 0.5
        grid, much = GridMap("cut", weights), np.int64(1 << 40)
        _, cost, expected = repaired(grid.table, path, at, at, 4, 29, 4, 0, 0, much, order_of(grid))
        assert (cost == FREE) != cut
        assert expected == much - cut * grid.table[4, 1 : at + 1].sum()


@given(cut_paths())
def test_the_end_of_a_path_is_free_from_behind_its_cuts(case):
    problem, path, at = case
    if not len(path):
        return
    rule, table = int(problem.corner_cutting), problem.map.table
    behind = behind_cuts(table, path, at, rule)
    assert remaining_cost(table, path, behind, rule) >= 0
    assert behind == at or remaining_cost(table, path, behind - 1, rule) < 0


def some_fields(most):
    fields = st.tuples(st.integers(1, 9), st.integers(1, 9))
    return st.lists(fields, min_size=1, max_size=most)


@given(some_fields(9), some_fields(2), st.integers(0, 8))
@example([(9, 9), (6, 6)], [(5, 5)], 0)
@example([(9, 9), (4, 4)], [(5, 5)], 0)
def test_what_of_a_path_is_beside_a_way_is_found_by_its_bounds(path, way, first):
    path, way, first = np.array(path, np.int32), np.array(way, np.uint32), min(first, len(path) - 1)
    low, high = way.min(axis=0) - 1, way.max(axis=0) + 1
    inside = np.flatnonzero(((low <= path) & (path <= high)).all(axis=1))
    packed = (way[:, 1] << 16) + way[:, 0]
    assert last_beside(path, first, packed, len(way)) == max([first, *inside])


@given(cut_paths())
def test_a_last_ray_goes_straight_on_if_it_is_free_and_no_dearer(case):
    problem, path, at = case
    table, rule = problem.map.table, int(problem.corner_cutting)
    behind = behind_cuts(table, path, at, rule) if len(path) else 0
    if behind >= len(path) - 1:
        return
    i = behind + 1
    points = path[[behind, i]].copy()
    costs = np.array([table[path[i, 1], path[i, 0]], 0], dtype=np.int64)
    along = int(table[path[i:, 1], path[i:, 0]].sum())
    (x, y), (u, v) = path[behind].tolist(), path[-1].tolist()
    blocked, through = ray(table, x, y, u, v, rule)
    goes = blocked == 0 and through <= along
    assert goes_straight_on(table, path, i, points, costs, 2, rule) == goes
    assert points[1].tolist() == (path[-1] if goes else path[i]).tolist()
    assert costs[0] == (through if goes else table[path[i, 1], path[i, 0]])


def route(grid, path, at, start, target, expected=0):
    least = int(grid.table.min())
    return repaired(grid.table, path, at, *start, *target, 0, least, expected, order_of(grid))[:2]


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
    grid = GridMap("wall", weights)
    new, _ = route(grid, around, 0, start, target)
    assert (new[:, 1].max() > 60) == keeps
    kept, cost = route(grid, around, 0, start, target, expected=1 << 30)
    assert kept[:, 1].max() > 60
    again, _ = route(grid, around, 0, start, target, expected=cost)  # it has not grown since
    assert np.array_equal(again, kept)
