"""Lazy Theta* against a slow twin, and what can be said of its paths."""

import math

import naive
import naive_lines
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import problems

from gapath.components import build
from gapath.discovery import yaml_values
from gapath.grid import GridMap
from gapath.kernels.jit import kernel
from gapath.kernels.rivals import lazy_theta
from gapath.kernels.rivals.line_costs import FINE, IN_THE_WAY, line_cost
from gapath.kernels.rng import stream
from gapath.planning.flaw import flaw
from gapath.planning.path import octile_length, polyline_length
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem


def plan(problem):
    planner = build("planner", yaml_values("planner", "lazy_theta"), "planner")
    return planner.plan(problem, stream(0))


@given(problems())
def test_lines_cost_what_the_slow_twin_says(problem):
    rule = problem.corner_cutting
    cost = naive_lines.line_cost(
        problem.map.weights, problem.start, problem.target, rule.name.lower()
    )
    found = line_cost(problem.map.table, *problem.start, *problem.target, int(rule))
    assert found == (IN_THE_WAY if cost is None else cost)


@kernel
def step_cost(weight, step):
    return lazy_theta.step_cost(weight, step)


@given(st.integers(0, 65536), st.integers(0, 7))
def test_steps_cost_what_they_are_long_and_a_little_more(weight, step):
    """A unit at most: 1 + the root, rounded down."""
    length = (weight + 1) * FINE
    assert step_cost(weight, step) == 1 + math.isqrt((2 if step > 3 else 1) * length**2)


@given(problems(most=16))
def test_way_points_equal_the_slow_twin(problem):
    points, expanded = naive_lines.lazy_theta(problem)
    found = plan(problem)
    assert found.expansions == expanded
    assert found.lines().tolist() == [list(point) for point in points or []]


@given(problems())
def test_it_finds_a_path_wherever_there_is_one(problem):
    found, best = plan(problem), shortest_path(problem)
    assert found.feasible == best.feasible
    if found.feasible:
        assert flaw(problem, found.path, found.cost) is None
        assert found.path.tolist() == [list(f) for f in naive.polyline(found.lines().tolist())]
        assert polyline_length(found.lines()) >= math.dist(problem.start, problem.target) - 1e-9


@given(problems(least=1), st.sampled_from([0.0, 0.5]))
def test_without_an_obstacle_it_goes_straight(problem, floor):
    grid = GridMap("floor", np.full(problem.map.weights.shape, floor))
    lines = plan(Problem(grid, problem.start, problem.target)).lines()
    assert polyline_length(lines) == pytest.approx(math.dist(problem.start, problem.target))


def test_heavy_fields_are_gone_round():
    """A band of weight 0.9 across the straight line, with a gap of 0.1 as the rest of the map."""
    weights = np.full((21, 41), 0.1)
    weights[:18, 15:25] = 0.9
    problem = Problem(GridMap("band", weights), (2, 5), (38, 5))
    found = plan(problem)
    assert (weights[found.path[:, 1], found.path[:, 0]] == 0.1).all()
    assert len(found.lines()) == 4
    assert polyline_length(found.lines()) < octile_length(shortest_path(problem).path)


def test_paths_are_shorter_than_those_along_eight_directions():
    """Among scattered obstacles; it is no theorem."""
    random, ratios = np.random.default_rng(4), []
    for _ in range(60):
        weights = np.where(random.random((40, 60)) < 0.2, 1.0, 0.5)
        weights[0, 0] = weights[39, 59] = 0.5
        problem = Problem(GridMap("noise", weights), (0, 0), (59, 39))
        found = plan(problem)
        if found.feasible:
            best = shortest_path(problem, by_length=True)
            ratios.append(polyline_length(found.lines()) / octile_length(best.path))
    assert len(ratios) > 50
    assert max(ratios) < 1.0 and np.mean(ratios) < 0.96
