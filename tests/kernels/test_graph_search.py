"""A* and Dijkstra against scikit-image, Bellman's equation, each other, and a slow twin."""

import heapq
import math

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from skimage.graph import MCP
from strategies import problems

from gapath.components import build
from gapath.discovery import yaml_values
from gapath.grid import GridMap
from gapath.kernels.rng import stream
from gapath.kernels.units import SCALE
from gapath.planning import shortest_path as shortest_paths
from gapath.planning.flaw import flaw
from gapath.planning.path import octile_length, path_weights
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, PlanStatus, Problem

STEPS = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]


def naive_search(problem, informed):
    """Expand what has the least priority, the newest of several; give path and expansions."""
    grid, start, target = problem.map, problem.start, problem.target
    rule = problem.corner_cutting.name.lower()
    table = grid.table.tolist()

    def estimate(x, y):
        """Of weights and fields; the target is a field that is not counted."""
        distance = max(abs(target[0] - x), abs(target[1] - y))
        if distance == 0:
            return 0, -1
        if not informed:
            return 0, 0
        least = grid.least_weight(start, target)
        return least * (distance - 1) + table[target[1]][target[0]], distance - 1

    queue, number = [((0, 0), 0, start)], 0
    costs, before, expanded = {start: (0, 0)}, {}, set()
    while queue:
        place = heapq.heappop(queue)[2]
        if place == target:
            path = [place]
            while path[0] != start:
                path.insert(0, before[path[0]])
            return path, len(expanded)
        if place in expanded:
            continue
        expanded.add(place)
        for dx, dy in reversed(STEPS):
            x, y = neighbour = (place[0] + dx, place[1] + dy)
            if naive.is_obstacle(grid.weights, x, y) or neighbour in expanded:
                continue
            cost = (costs[place][0] + table[y][x], costs[place][1] + 1)
            cut = naive.forbidden(grid.weights, place, neighbour, rule)
            if cut or cost >= costs.get(neighbour, (math.inf, 0)):
                continue
            costs[neighbour], before[neighbour] = cost, place
            number += 1
            priority = tuple(map(sum, zip(cost, estimate(x, y), strict=True)))
            heapq.heappush(queue, (priority, -number, neighbour))
    return [], len(expanded)


@given(problems(most=16), st.booleans())
def test_of_equal_priorities_the_newest_goes_first(problem, informed):
    path, expansions = naive_search(problem, informed)
    plan = shortest_path(problem, informed)
    assert [tuple(field) for field in plan.path.tolist()] == path
    assert plan.expansions == expansions


def test_a_queue_of_thousands_grows():
    weights = np.random.default_rng(0).choice([0.25, 0.5, 0.75, 1.0], (120, 120))
    weights[60, 60] = weights[119, 119] = 0.5
    problem = Problem(GridMap("noise", weights), (60, 60), (119, 119))
    for informed in (True, False):
        path, expansions = naive_search(problem, informed)
        plan = shortest_path(problem, informed)
        assert (plan.path.tolist(), plan.expansions) == ([list(p) for p in path], expansions)


@given(problems(most=16))
def test_astar_equals_dijkstra_and_bellman(problem):
    rule = problem.corner_cutting.name.lower()
    expected = naive.shortest_cost(problem.map.weights, problem.start, problem.target, rule)
    for informed in (True, False):
        plan = shortest_path(problem, informed)
        assert plan.cost == expected
        if math.isinf(expected):
            assert plan.status is PlanStatus.INFEASIBLE
        else:
            assert flaw(problem, plan.path) is None


FLOORS = {"as drawn": None, "nothing": [0.0], "nothing or something": [0.0, 0.5]}


def on_floor(problem, floor, seed=0):
    """The same obstacles, other weights."""
    weights = problem.map.weights
    if floor is not None:
        weights = np.random.default_rng(seed).choice(floor, weights.shape)
        weights[problem.map.obstacles] = 1.0
    return Problem(GridMap("floor", weights), problem.start, problem.target, problem.corner_cutting)


@pytest.mark.parametrize("name", ["astar", "dijkstra"])
@pytest.mark.parametrize("floor", FLOORS.values(), ids=FLOORS)
@given(problem=problems(most=16), seed=st.integers(0, 1000))
def test_of_the_cheapest_paths_it_is_one_of_the_fewest_fields(name, floor, problem, seed):
    problem = on_floor(problem, floor, seed)
    rule = problem.corner_cutting.name.lower()
    best = naive.fewest_fields(problem.map.weights, problem.start, problem.target, rule)
    plan = build("planner", yaml_values("planner", name), "planner").plan(problem, stream(0))
    assert (plan.cost, len(plan.path)) == (best or (math.inf, 0))
    if best:
        assert flaw(problem, plan.path, plan.cost) is None


@given(problems())
def test_where_fields_cost_nothing_the_path_is_that_of_fields_that_cost_the_same(problem):
    for informed in (True, False):
        paths = [
            shortest_path(on_floor(problem, [weight]), informed).path.tolist()
            for weight in (0.0, 0.5, 1 / 65536)
        ]
        assert paths[0] == paths[1] == paths[2]


def test_a_path_too_long_to_be_counted_is_still_a_cheapest_one(monkeypatch):
    weights = np.zeros((9, 21))
    weights[3, :-1] = weights[6, 1:] = 1.0
    weights[:, 10] = np.maximum(weights[:, 10], 0.5)
    problem = Problem(GridMap("snake", weights), (0, 0), (20, 8))
    assert shortest_path(problem).cost == 1.5
    monkeypatch.setattr(shortest_paths, "FIELD_BITS", 5)
    plan = shortest_path(problem)
    assert plan.cost == 1.5
    assert flaw(problem, plan.path, plan.cost) is None


@given(problems())
def test_costs_equal_scikit_image(problem):
    rule = problem.corner_cutting
    if rule not in (CornerCutting.ALLOW, CornerCutting.NO_DIAGONALS):
        return
    table = problem.map.table.astype(float)
    start, target = problem.start[::-1], problem.target[::-1]
    graph = MCP(
        np.where(problem.map.obstacles, -1, table + 1), fully_connected=rule is CornerCutting.ALLOW
    )
    costs, _ = graph.find_costs([start], [target])
    plan = shortest_path(problem)
    if math.isinf(costs[target]):
        assert plan.status is PlanStatus.INFEASIBLE
        return
    # MCP refuses weights of 0, so each field costs a unit more; compare with that map's optimum
    again = GridMap("plus", np.where(problem.map.obstacles, 1.0, (table + 1) / SCALE))
    exact = shortest_path(Problem(again, problem.start, problem.target, rule))
    assert round(exact.cost * SCALE) == costs[target] or problem.start == problem.target


@given(problems(most=12))
def test_lengths_are_least_too(problem):
    plan = shortest_path(problem, by_length=True)
    fewest = shortest_path(problem, informed=False, by_length=True)
    if plan.feasible:
        assert octile_length(plan.path) == pytest.approx(octile_length(fewest.path))
        assert plan.cost == pytest.approx(path_weights(problem.map, plan.path))
        assert flaw(problem, plan.path) is None


def test_astar_settles_no_more_than_the_straight_line_where_nothing_is_in_the_way():
    grid = GridMap("empty", np.full((50, 100), 0.5))
    plan = shortest_path(Problem(grid, (0, 24), (98, 24)))
    assert plan.expansions == 98
    assert plan.cost == 99 * 0.5


def test_a_light_target_costs_astar_no_ties():
    """The estimate is least (distance - 1) + the target's own weight, here 0."""
    weights = np.full((50, 100), 0.5)
    weights[24, 0] = weights[24, 98] = 0.0
    plan = shortest_path(Problem(GridMap("kg18", weights), (0, 24), (98, 24)))
    assert plan.expansions == 98
    assert plan.cost == 97 * 0.5


def test_start_at_target():
    grid = GridMap("dot", np.full((3, 3), 0.5))
    plan = shortest_path(Problem(grid, (1, 1), (1, 1)))
    assert plan.path.tolist() == [[1, 1]]
    assert plan.cost == 0.5
