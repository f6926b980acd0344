"""Ways along the walls past some vertices: never dearer, and the polygon stays one."""

import naive_memetic as slow
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from naive_memetic import packed, places, polygons, unpacked, vertices, walled_problems

from gapath.grid import GridMap
from gapath.kernels.jit import kernel
from gapath.kernels.memetic import rerouting
from gapath.kernels.memetic.account import CROWDED
from gapath.kernels.memetic.population import individuals, put
from gapath.kernels.memetic.rerouting import Room, crossed, reroute, walked_path
from gapath.kernels.memetic.walls import BOTH, LEFT, RIGHT
from gapath.kernels.rng import fill, stream


def room_of(grid):
    """Small, so that paths have to move; what it holds does not matter."""
    order = np.full(grid.table.size, 1, dtype=np.int32)
    return Room(order, *(np.full(1, 7, dtype=np.uint32) for _ in range(3)))


@given(walled_problems(), st.sampled_from([LEFT, RIGHT, BOTH]), st.booleans(), st.integers(0, 99))
def test_a_walk_back_is_the_one_from_the_target_turned_round(problem, hands, varied, seed):
    walks = []
    for (a, b), backward in (
        ((problem.start, problem.target), True),
        ((problem.target, problem.start), False),
    ):
        count, steps, path = walked_path(
            problem.map.table, (*a, *b), int(problem.corner_cutting), hands, 1 << 40, varied,
            backward, packed([(0, 0)]), stream(seed),
        )  # fmt: skip
        walks.append((count, steps, unpacked(path[: max(count, 0)])))
    assert walks[0] == (*walks[1][:2], walks[1][2][::-1])


@given(slow.two_polygons())
def test_polygons_are_crossed_as_the_paths_of_their_rays(drawn):
    problem, first, second = drawn
    weights, name = problem.map.weights, problem.corner_cutting.name.lower()
    paths = [slow.fields(weights, points, name) for points in (first, second)]
    count, cost, fields, room = crossed(
        problem.map.table, vertices(first), len(first), vertices(second), len(second),
        int(problem.corner_cutting), room_of(problem.map),
    )  # fmt: skip
    child, _ = slow.cross(weights, *paths)
    assert unpacked(room.child[:count]) == child
    assert cost == slow.cost(weights, child)
    assert fields == sum(map(len, paths))


@kernel
def first_walk(table, ends, rule, settings, stream):
    return rerouting.first_walk(table, ends, rule, settings, stream)


@pytest.mark.parametrize(("wide", "asks"), [(1, True), (1, False), (2, True)])
@pytest.mark.parametrize("seed", range(4))
def test_who_asks_leaves_corridors_of_a_field_after_eight_steps_a_row_and_column(wide, asks, seed):
    """A maze, each cell open to the one above or to its left; the target is in it or closed in."""
    random, cells = np.random.default_rng(seed), 20
    weights = np.full((2 * cells - 1, 2 * cells - 1), 1.0)
    weights[::2, ::2] = 0.5
    for y, x in np.ndindex(cells, cells):
        if x or y:
            up = y and (x == 0 or random.integers(2))
            weights[2 * y - bool(up), 2 * x - (not up)] = 0.5
    weights = np.kron(weights, np.ones((wide, wide)))
    end = weights.shape[0] - 1
    for closed in (False, True):
        weights[end - 2 * wide, end - wide :] = weights[end - wide :, end - 2 * wide] = 1.0
        if not closed:
            weights[end - 2 * wide :, end] = weights[end, end - 2 * wide :] = 0.5
        grid = GridMap("maze", weights)
        for hands in (LEFT, RIGHT, BOTH):
            settings = np.array([1, hands, 0, 0, 0, 0, int(asks)])
            ends, none = (0, 0, end, end), np.empty(1, dtype=np.uint32)
            whole = walked_path(grid.table, ends, 0, hands, 1 << 40, False, False, none, stream(0))
            count, walked, path = first_walk(grid.table, ends, 0, settings, stream(0))
            leaves = asks and wide == 1 and whole[1] > 8 * 2 * (end + 1)
            assert count == (CROWDED if leaves else whole[0])
            assert walked == (8 * 2 * (end + 1) if leaves else whole[1])
            if count > 0:
                assert unpacked(path[:count]) == unpacked(whole[2][:count])


def rerouted(problem, points, hands, seed):
    """Gain, fields read, and the individual's vertices, rays' costs and total then."""
    weights, name = problem.map.weights, problem.corner_cutting.name.lower()
    costs = np.array([*slow.ray_costs(weights, points, name), 0])
    members = put(individuals(2, 1), 0, vertices([(3, 3)]), costs[:0], 1, 5)
    members = put(members, 1, vertices(points), costs, len(points), int(costs.sum()))
    random, words = stream(seed), np.empty(2, dtype=np.uint64)
    fill(random, words)
    least = problem.map.least_weight(points[0], points[-1])
    gain, fields, members, _ = reroute(
        problem.map.table, members, 1, least, int(problem.corner_cutting), hands, words,
        room_of(problem.map), random,
    )  # fmt: skip
    assert (places(members.points[0, :1]), members.sizes[0], members.totals[0]) == ([(3, 3)], 1, 5)
    size = members.sizes[1]
    found = places(members.points[1, :size]), members.costs[1, : size - 1].tolist()
    return gain, fields, *found, members.totals[1]


@given(polygons(least=3), st.sampled_from([LEFT, RIGHT, BOTH]), st.integers(0, 999))
def test_a_reroute_gains_what_it_says_and_leaves_a_polygon(drawn, hands, seed):
    problem, points = drawn
    weights, name = problem.map.weights, problem.corner_cutting.name.lower()
    before = sum(slow.ray_costs(weights, points, name))
    gain, fields, found, costs, total = rerouted(problem, points, hands, seed)
    assert gain >= 0 and fields >= 0
    assert costs == slow.ray_costs(weights, found, name)
    assert total == sum(costs) == before - gain
    assert (found[0], found[-1]) == (points[0], points[-1])
    if gain == 0:
        assert found == points


def test_vertices_in_one_place_become_one():
    """A detour that comes back to where it began is cut off."""
    weights = np.full((9, 9), 0.5)
    problem = slow.Problem(GridMap("detour", weights), (0, 4), (8, 4))
    points, gains = [(0, 4), (4, 4), (4, 0), (4, 4), (8, 4)], set()
    for seed in range(60):
        gain, _, found, costs, total = rerouted(problem, points, BOTH, seed)
        assert costs == slow.ray_costs(weights, found, "allow") and total == sum(costs)
        gains.add((gain // 32768, *found))
    assert (8, (0, 4), (4, 4), (8, 4)) in gains


def test_it_finds_the_other_side_of_an_obstacle():
    """The polygon goes the long way: one hand makes it a bit shorter, the other finds the short."""
    weights = np.full((21, 21), 0.5)
    weights[2:18, 10] = 1.0
    problem = slow.Problem(GridMap("other", weights), (4, 4), (16, 4))
    points = [(4, 4), (10, 19), (16, 4)]
    gains = {rerouted(problem, points, BOTH, seed)[0] for seed in range(20)}
    assert gains == {(30 - 28) * 32768, (30 - 12) * 32768}
