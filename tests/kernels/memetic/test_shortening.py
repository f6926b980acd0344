"""Loops cut, looks aside and strings pulled: against slow twins, and never dearer."""

import naive_memetic as slow
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from naive_memetic import packed, paths, places, polygons, unpacked, vertices

from gapath.grid import GridMap
from gapath.kernels.memetic.account import ASIDE, LOOPS, OPERATORS, PULLING, WALLS
from gapath.kernels.memetic.shortening import (
    APART,
    LEAST_GAIN,
    LONG,
    REACH,
    cut_loops,
    look_aside,
    pull,
    pull_there_and_back,
    running_cost,
    shortened,
)
from gapath.problem import CornerCutting

NOTHING = np.empty(0, dtype=np.int64)


def rules(problem):
    return problem.corner_cutting.name.lower(), int(problem.corner_cutting)


def rubbish(grid, seed=0):
    """Room for the order of fields, which may hold anything."""
    random = np.random.default_rng(seed)
    return random.integers(-3, 99, grid.table.size).astype(np.int32)


@given(paths(), st.integers(0, 9))
def test_loops_are_cut_as_by_the_slow_twin(drawn, seed):
    problem, path = drawn
    weights, (name, rule) = problem.map.weights, rules(problem)
    table, short = problem.map.table, packed(path)
    count = cut_loops(table, short, len(path), rubbish(problem.map, seed), rule)
    found = unpacked(short[:count])
    assert found == slow.cut_loops(weights, path, name)
    assert len(set(found)) == count
    assert (found[0], found[-1]) == (path[0], path[-1])
    assert slow.flaw_of(weights, found, name) is None
    assert slow.cost(weights, found) <= slow.cost(weights, path)


@given(paths(most=24, twice=False), st.integers(0, 9))
def test_looks_aside_equal_the_slow_twin_and_are_never_dearer(drawn, seed):
    problem, path = drawn
    weights, name = problem.map.weights, rules(problem)[0]
    table, short = problem.map.table, np.empty(len(path), dtype=np.uint32)
    sums = running_cost(table, packed(path), len(path))
    assert sums.tolist() == [slow.cost(weights, path[: i + 1]) for i in range(len(path))]
    order = rubbish(problem.map, seed)
    count = look_aside(table, packed(path), len(path), sums, order, short)
    found = unpacked(short[:count])
    assert found == slow.look_aside(weights, path, APART, REACH, LEAST_GAIN)
    assert (found[0], found[-1]) == (path[0], path[-1])
    assert slow.flaw_of(weights, found, name) is None
    assert slow.cost(weights, found) <= slow.cost(weights, path)


def pulled(problem, path):
    """Vertices, what their rays cost, and the sum."""
    table = problem.map.table
    points, costs = np.empty((len(path), 2), dtype=np.int32), np.empty(len(path), dtype=np.int64)
    sums = running_cost(table, packed(path), len(path))
    size, total = pull(table, packed(path), len(path), sums, rules(problem)[1], points, costs)
    return places(points[:size]), costs[: size - 1].tolist(), total


@given(paths(twice=False))
def test_each_ray_that_is_pulled_ends_where_one_field_more_is_too_far(drawn):
    problem, path = drawn
    weights, name = problem.map.weights, rules(problem)[0]
    points, costs, total = pulled(problem, path)
    assert costs == slow.ray_costs(weights, points, name)
    assert total == sum(costs) <= slow.cost(weights, path)
    at = [path.index(point) for point in points]
    assert at[0] == 0 and at[-1] == len(path) - 1 and at == sorted(set(at))
    for i, cost in enumerate(costs):
        a, b = at[i], at[i + 1]
        assert cost <= slow.cost(weights, path[a : b + 1])
        if b + 1 < len(path):
            blocked, way = slow.ray(weights, path[a], path[b + 1], name)
            assert blocked or slow.cost(weights, way) > slow.cost(weights, path[a : b + 2])


@given(polygons())
def test_pulled_there_and_back_no_polygon_is_dearer(drawn):
    problem, points = drawn
    weights, (name, rule) = problem.map.weights, rules(problem)
    costs = slow.ray_costs(weights, points, name)
    size, total, new, new_costs, _ = pull_there_and_back(
        problem.map.table, vertices(points), np.array([*costs, 0]), len(points), rule,
        np.empty(1, dtype=np.uint32),
    )  # fmt: skip
    found = places(new[:size])
    assert (found[0], found[-1]) == (points[0], points[-1])
    assert new_costs[: size - 1].tolist() == slow.ray_costs(weights, found, name)
    assert total == sum(new_costs[: size - 1]) <= sum(costs)


def test_a_pull_back_comes_to_the_inner_side_of_a_bend():
    """Along the outer side of a corner a pull leaves a vertex that the way back does not."""
    weights = np.full((12, 12), 0.5)
    weights[:8, 6] = 1.0
    problem = slow.Problem(GridMap("bend", weights), (0, 0), (11, 0))
    path = [(0, y) for y in range(12)] + [(x, 11) for x in range(1, 12)]
    path += [(11, y) for y in range(10, -1, -1)]
    points, _, there = pulled(problem, path)
    back = pull_there_and_back(
        problem.map.table, vertices(points), np.zeros(len(points), dtype=np.int64), len(points),
        0, np.empty(1, dtype=np.uint32),
    )[1]  # fmt: skip
    assert back < there


@pytest.mark.parametrize("aside", [False, True])
@given(drawn=paths(most=24), enough=st.sampled_from([-1, 0, 65536, 10**9]))
def test_shortened_paths_are_polygons_of_the_same_ends_and_shares_add_up(drawn, enough, aside):
    problem, path = drawn
    weights, (name, rule) = problem.map.weights, rules(problem)
    shares = np.zeros(OPERATORS, dtype=np.int64)
    size, total, points, costs = shortened(
        problem.map.table, packed(path), len(path), rule, enough, aside, rubbish(problem.map),
        shares,
    )  # fmt: skip
    found = places(points[:size])
    assert (found[0], found[-1]) == (path[0], path[-1])
    assert costs[: size - 1].tolist() == slow.ray_costs(weights, found, name)
    assert total == sum(costs[: size - 1]) <= slow.cost(weights, path)
    assert shares[WALLS] == slow.cost(weights, path)
    cut = slow.cut_loops(weights, path, name)
    assert shares[LOOPS] == slow.cost(weights, path) - slow.cost(weights, cut)
    looks = aside and len(cut) > LONG and slow.cost(weights, cut) > enough
    seen = slow.look_aside(weights, cut, APART, REACH, LEAST_GAIN) if looks else cut
    assert shares[ASIDE] == slow.cost(weights, cut) - slow.cost(weights, seen)
    assert shares[WALLS] - shares[LOOPS] - shares[ASIDE] - shares[PULLING] == total
    assert shares.min() >= 0 and not shares[PULLING + 1 :].any()
    again = shortened(
        problem.map.table, packed(path), len(path), rule, enough, aside, rubbish(problem.map, 1),
        NOTHING,
    )  # fmt: skip
    assert (again[0], again[1], places(again[2][: again[0]])) == (size, total, found)


def test_a_look_aside_does_not_go_through_what_is_dearer():
    """Between the legs of a way that costs nothing lies heavy ground, and one lane through it."""
    path = [(1, y) for y in range(40)] + [(x, 39) for x in range(2, 20)]
    path += [(19, y) for y in range(38, -1, -1)]
    for lane in (None, 8):
        weights = np.full((40, 21), 0.5)
        weights[tuple(np.array(path).T[::-1])] = 0.0
        if lane:
            weights[lane] = 0.0
        grid, short = GridMap("lane", weights), np.empty(len(path), dtype=np.uint32)
        sums = running_cost(grid.table, packed(path), len(path))
        count = look_aside(grid.table, packed(path), len(path), sums, rubbish(grid), short)
        crossed = [(x, lane) for x in range(2, 19)] if lane else []
        assert [place for place in unpacked(short[:count]) if place not in path] == crossed


def test_a_dead_end_that_a_hand_followed_is_left_by_a_look_aside():
    """Round the wall in a deep bay, down and up: no ray from field to field of the way is short."""
    weights = np.full((60, 30), 0.5)
    weights[10:58, 5], weights[10:58, 25], weights[58, 5:26] = 1.0, 1.0, 1.0
    weights[13, 8:24] = 1.0
    grid = GridMap("bay", weights)
    path = [(6, y) for y in range(12, 57)] + [(x, 57) for x in range(6, 25)]
    path += [(24, y) for y in range(56, 8, -1)]
    path += [(25, 9)] + [(26, y) for y in range(9, 41)]
    totals = [
        shortened(grid.table, packed(path), len(path), int(CornerCutting.ALLOW), 0, aside,
                  rubbish(grid), NOTHING)[1]
        for aside in (False, True)
    ]  # fmt: skip
    assert totals == [53 * 32768, 50 * 32768]  # 20 across, 30 down
