"""Steps against the rules field by field, and that a hand on the wall comes to all of it."""

import itertools

import naive
import numpy as np
import pytest
from hypothesis import given
from naive_memetic import STEPS, beside, may, plus, rays, region, walled_problems

from gapath.grid import GridMap
from gapath.kernels.memetic.steps import STEP_X, STEP_Y, may_step, towards, wall_of, wall_step


def rules(problem):
    """The name of the rule for steps of a ray, and the kernel's."""
    name = problem.corner_cutting.name.lower()
    return "one_side" if name == "no_diagonals" else name, int(problem.corner_cutting)


@given(walled_problems())
def test_steps_are_allowed_where_the_rule_has_it(problem):
    name, rule = rules(problem)
    assert list(zip(STEP_X.tolist(), STEP_Y.tolist(), strict=True)) == STEPS
    for step in STEPS:
        there = plus(problem.start, step)
        allowed = may_step(problem.map.table, *problem.start, *there, rule)
        assert allowed == may(problem.map.weights, problem.start, there, name)


@given(rays())
def test_the_first_step_is_the_lines(drawn):
    problem, end = drawn
    if end != problem.start:
        first = naive.polyline([problem.start, end])[1]
        assert plus(problem.start, towards(*problem.start, *end)) == first


def round_the_wall(problem, place, step, side):
    """All fields that a hand comes to, from a field whose step is blocked."""
    table, rule = problem.map.table, int(problem.corner_cutting)
    (x, y), wall = place, wall_of(table, *place, *step, side, rule)
    first, came = None, {place}
    for _ in range(8 * table.size + 8):
        u, v, wall = wall_step(table, x, y, wall, side, rule)
        if (u, v) != (x, y):
            name = problem.corner_cutting.name.lower()
            assert name == "allow" or u == x or v == y
            assert may(problem.map.weights, (x, y), (u, v), name)
        x, y = u, v
        if (x, y, wall) == first:
            return came
        first = first or (x, y, wall)
        came.add((x, y))
    raise AssertionError("the hand does not come round")


@given(walled_problems(most=12))
def test_a_hand_comes_round_and_was_on_all_fields_beside_the_obstacle(problem):
    """The proof that there is no way rests on it; at each field from which a step is blocked."""
    weights, name = problem.map.weights, rules(problem)[0]
    by_corner = problem.corner_cutting.name == "ALLOW"
    own = region(
        problem.start,
        lambda f: not naive.is_obstacle(weights, *f),
        STEPS if by_corner else STEPS[::2],
    )
    for place in sorted(own)[:: max(len(own) // 8, 1)]:
        for step in STEPS:
            there = plus(place, step)
            if may(weights, place, there, name):
                continue
            if not naive.is_obstacle(weights, *there):  # the corner is in the way
                sides = [(there[0], place[1]), (place[0], there[1])]
                there = next(f for f in sides if naive.is_obstacle(weights, *f))
            wall = beside(weights, place, there, name)
            for side in (1, -1):
                assert wall <= round_the_wall(problem, place, step, side)


@pytest.mark.parametrize("name", ["allow", "one_side", "forbid", "no_diagonals"])
def test_a_wall_is_what_blocks_the_step_or_beside_it_the_corner_that_does(name):
    """All surroundings of a field; of two corners the first counterclockwise."""
    rule = ["allow", "one_side", "forbid", "no_diagonals"].index(name)
    for walls in itertools.product([0.5, 1.0], repeat=8):
        weights = np.full((3, 3), 0.5)
        for (dx, dy), weight in zip(STEPS, walls, strict=True):
            weights[1 + dy, 1 + dx] = weight
        table = GridMap("around", weights).table
        for (k, step), side in itertools.product(enumerate(STEPS), (1, -1)):
            corners = [i % 8 for i in (k - 1, k + 1) if walls[i % 8] == 1]
            if name == "allow" or k % 2 == 0:
                expected = k
            else:
                expected = corners[0] if corners else (k - side) % 8
            assert wall_of(table, 1, 1, *step, side, rule) == expected
