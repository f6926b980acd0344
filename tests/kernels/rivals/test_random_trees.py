"""RRT-Connect and its shortcuts against slow twins, and what a shortcut may do."""

import itertools

import naive
import naive_lines
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from strategies import problems

from gapath.kernels.graph_search import NO_PATH
from gapath.kernels.lines import ONE_OBSTACLE, Ends, line_key
from gapath.kernels.rivals.line_costs import line_cost
from gapath.kernels.rivals.rrt_connect import field_of_line, nearest, rrt_connect
from gapath.kernels.rivals.shortcuts import shorten
from gapath.kernels.rng import stream

PLACES = st.tuples(st.integers(0, 99), st.integers(0, 99))


def grown(problem, iterations, step, random):
    """Way points of the kernel, room for more, their number, and the fields of both trees."""
    ends, rule = Ends(*problem.start, *problem.target), int(problem.corner_cutting)
    points = np.empty((2 * problem.map.table.size + 100, 2), dtype=np.int32)
    fields = np.zeros(1, dtype=np.int64)
    count = rrt_connect(problem.map.table, ends, rule, iterations, step, points, fields, random)
    return points, count, int(fields[0])


def cost_of(problem, points):
    """The lines' cost; every one of them is free."""
    rule, total = int(problem.corner_cutting), 0
    for a, b in itertools.pairwise(points):
        assert a != b
        assert line_key(problem.map.table, *a, *b, rule) < ONE_OBSTACLE
        total += line_cost(problem.map.table, *a, *b, rule)
    return total


@given(problems(most=40), st.integers(1, 60), st.integers(1, 20), st.integers(0, 1000))
def test_trees_grow_as_those_of_the_slow_twin(problem, iterations, step, seed):
    if problem.start == problem.target:
        return
    random, words = stream(seed), naive.Words(seed)
    points, count, fields = grown(problem, iterations, step, random)
    rule = problem.corner_cutting.name.lower()
    expected, grew = naive_lines.rrt_connect(
        problem.map.weights, problem.start, problem.target, rule, iterations, step, words
    )
    assert fields == len(grew)
    assert count == (NO_PATH if expected is None else len(expected))
    found = [tuple(p) for p in points[: max(count, 0)].tolist()]
    assert found == (expected or [])
    cost_of(problem, found)


@given(problems(most=40), st.integers(0, 40), st.integers(0, 1000))
def test_shortcuts_equal_the_slow_twin_and_never_cost_more(problem, tries, seed):
    random, words = stream(seed, 1), naive.Words(seed, 1)
    if problem.start == problem.target:
        return
    points, count, _ = grown(problem, 400, 4, stream(seed))
    if count == NO_PATH:
        return
    before = [tuple(p) for p in points[:count].tolist()]
    rule = problem.corner_cutting
    count = shorten(problem.map.table, points, count, int(rule), tries, random)
    after = [tuple(p) for p in points[:count].tolist()]
    assert after == naive_lines.shorten(
        problem.map.weights, before, rule.name.lower(), tries, words
    )
    assert (after[0], after[-1]) == (problem.start, problem.target)
    assert cost_of(problem, after) <= cost_of(problem, before)


@given(st.lists(PLACES, min_size=1, max_size=60, unique=True), PLACES)
def test_the_nearest_field_is_found_in_squares(places, goal):
    nodes = np.zeros((len(places), 4), dtype=np.int64)
    firsts = np.full((7, 7), -1, dtype=np.int32)
    for i, (x, y) in enumerate(places):
        nodes[i] = x, y, -1, firsts[y // 16, x // 16]
        firsts[y // 16, x // 16] = i
    distances = [(x - goal[0]) ** 2 + (y - goal[1]) ** 2 for x, y in places]
    assert nearest(nodes, firsts, *goal) == distances.index(min(distances))


@given(PLACES, PLACES)
def test_fields_of_a_line_are_those_that_it_is_drawn_with(a, b):
    fields = naive.polyline([a, b])
    if len(fields) > 1:
        assert [field_of_line(*a, *b, i) for i in range(len(fields))] == fields
