"""Planners of the pixel grid among grown obstacles."""

from functools import partial

import naive
import naive_visibility as twin
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import RULES, problems
from visibility_strategies import inflated_by, make, map_of

import gapath
from gapath.api import load_map
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels import rng
from gapath.planning.flaw import flaw
from gapath.problem import PlanStatus, Problem
from gapath.survey.obstacle_image import dilate


@settings(max_examples=100)
@given(problems(most=16), st.integers(0, 3), st.booleans())
def test_it_plans_as_on_a_map_that_was_grown_by_hand(problem, radius, by_length):
    inner = make("astar", minimise="length" if by_length else "weights")
    planner = inflated_by(inner, robot_radius=radius, threshold=1)
    plan = planner.plan(problem, rng.stream(0))
    grown = twin.dilated(problem.map.obstacles, twin.radius(str(radius)))
    weights = np.where(grown, 1.0, problem.map.weights)
    if any(grown[y, x] for x, y in (problem.start, problem.target)):
        assert plan.status is PlanStatus.INFEASIBLE
        return
    by_hand = Problem(
        GridMap("grown", weights), problem.start, problem.target, problem.corner_cutting
    )
    expected = inner.plan(by_hand, rng.stream(0))
    assert plan.feasible == expected.feasible
    assert plan.status is not PlanStatus.OPTIMAL  # a robot that is a point may have a cheaper path
    assert plan.path.tolist() == expected.path.tolist()
    assert plan.cost == expected.cost
    if plan.feasible:
        assert flaw(problem, plan.path, plan.cost) is None  # eq. (5) on the true map
        assert not grown[plan.path[:, 1], plan.path[:, 0]].any()
        if not by_length:
            rule = RULES[problem.corner_cutting]
            least = naive.shortest_cost(weights, problem.start, problem.target, rule)
            assert plan.cost == least


@pytest.mark.parametrize("number", range(1, 11))
def test_scenes_have_paths_that_keep_their_distance(number):
    grid = load_map(f"m22_scene{number:02d}")
    problem = Problem(grid, grid.start, grid.target)
    grown = dilate(grid.obstacles, 6)
    for name in ("inflated_astar", "inflated_ga3"):
        plan = gapath.plan(grid, planner=name, seed=1)
        if name == "inflated_astar" or plan.feasible:
            assert flaw(problem, plan.path, plan.cost) is None
            assert not grown[plan.path[:, 1], plan.path[:, 0]].any()
            assert [*plan.stages][:2] == ["dilation", "planning"]


def test_the_evolution_of_the_inner_planner_is_kept():
    grid = load_map("m22_scene07")
    plan = gapath.plan(grid, planner="inflated_ga3", seed=2)
    problem = Problem(grid, grid.start, grid.target)
    inner = make("ga3")
    weights = np.where(dilate(grid.obstacles, 6), 1.0, grid.weights)
    expected = inner.plan(
        Problem(GridMap("grown", weights), grid.start, grid.target), rng.stream(2)
    )
    assert (plan.status, plan.cost, plan.epochs) == (
        expected.status,
        expected.cost,
        expected.epochs,
    )
    assert plan.path.tolist() == expected.path.tolist()
    assert plan.evolution.chromosomes.tolist() == expected.evolution.chromosomes.tolist()
    assert problem.map.weights is grid.weights


def test_what_the_threshold_adds_is_an_obstacle():
    """Dear fields are avoided altogether; the others keep their weights."""
    weights = np.full((9, 30), 0.25)
    weights[:7, 15] = 0.8
    problem = Problem(GridMap("dear", weights), (2, 2), (27, 2))
    inner = make("astar", minimise="length")
    straight = inflated_by(inner, robot_radius=0, threshold=1).plan(problem, rng.stream(0))
    around = inflated_by(inner, robot_radius=0, threshold=0.8).plan(problem, rng.stream(0))
    assert straight.path[:, 1].max() == 2 and straight.cost == 25 * 0.25 + 52429 / 65536
    assert around.path[:, 1].max() == 7 and around.cost == len(around.path) * 0.25
    assert (
        not inflated_by(inner, robot_radius=1, threshold=0.8)
        .plan(problem, rng.stream(0))
        .path[:, 1]
        .max(initial=0)
    )


def test_weights_close_to_1_are_still_no_obstacle():
    """A weight that rounds to 1 in fixed point costs as much as before, and can be passed."""
    weights = np.array([[0.5, np.nextafter(1, 0), 0.5]])
    problem = Problem(GridMap("dear", weights), (0, 0), (2, 0))
    inner = make("astar", minimise="weights")
    plan = inflated_by(inner, robot_radius=0, threshold="otsu").plan(problem, rng.stream(0))
    assert plan.path.tolist() == [[0, 0], [1, 0], [2, 0]]
    assert plan.cost == inner.plan(problem, rng.stream(0)).cost == 2.0


def test_both_parts_may_refuse():
    weights = np.full((20, 30), 0.5)
    grid = GridMap("floor", weights)
    with pytest.raises(InputError, match=r"^map: got 30 x 20 fields, expected a square grid"):
        gapath.plan(grid, (1, 1), (28, 18), inflated_by(make("sedighi")))
    weights[8:12, 10:20] = 1.0
    grid = GridMap("block", weights)
    with pytest.raises(InputError, match=r"^map.target: got \[20, 12\], within an obstacle grown"):
        gapath.plan(grid, (1, 1), (20, 12), inflated_by(make("astar")))
    gapath.plan(grid, (1, 1), (28, 18), inflated_by(make("astar")))  # one that takes any map


def test_a_planner_within_measures_in_metres_too():
    """Obstacles that grow twice: by the robot, and by what the inner planner adds."""
    picture = np.zeros((60, 80), dtype=np.bool_)
    picture[25:35, 35:45] = True
    metres = {"radius_unit": "metres", "radius_tolerance": 0}
    inner = make("visibility_astar", robot_radius=0.1, **metres)
    planner = inflated_by(inner, robot_radius=0.2, **metres)
    problem = Problem(map_of(picture, resolution=0.05), (3, 3), (76, 50))
    planner.check(problem)
    plan = planner.plan(problem, rng.stream(0))
    assert plan.survey().obstacles.sum() == (10 + 2 * (4 + 2)) ** 2


def test_settings_out_of_range_are_refused():
    inner = make("astar")
    for field, value in [
        ("robot_radius", -1),
        ("radius_unit", "feet"),
        ("radius_tolerance", 11),
        ("element", "disc"),
        ("threshold", 2),
    ]:
        with pytest.raises(InputError, match=f"^planner.{field}: got {value}, expected "):
            inflated_by(inner, **{field: value})
    bad = partial(make, "inflated_astar")
    with pytest.raises(InputError, match=r"^planner.planner.minimise: got hops"):
        bad(planner={"base": "astar", "minimise": "hops"})
    with pytest.raises(InputError, match="ga9"):
        bad(planner={"base": "ga9"})
    problem = Problem(map_of(np.zeros((5, 5), dtype=np.bool_)), (0, 0), (4, 4))
    with pytest.raises(InputError, match=r"^planner.robot_radius: got 5000 pixels, "):
        inflated_by(inner, robot_radius=5000).check(problem)
