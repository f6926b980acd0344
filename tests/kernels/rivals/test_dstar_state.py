"""What D* Lite's search keeps to whatever changes: bounds, costs one step ahead, and its queue."""

import naive
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from strategies import RULES, problems

from gapath.grid import GridMap
from gapath.kernels.rivals import dstar_lite as kernels
from gapath.kernels.rivals.dstar_lite import FREE, LENGTH_BITS, NO_PATH, Heuristic, Search

STEPS = [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1) if x or y]
FIELD = st.tuples(st.integers(0, 6), st.integers(0, 6))


@given(FIELD, FIELD, FIELD, st.integers(0, 9), st.integers(0, 9))
def test_the_bound_is_the_least_cost_if_all_but_the_light_field_weigh_the_least(
    robot, light, place, least, lighter
):
    weights = np.full((7, 7), least)
    weights[light[::-1]] = min(least, lighter)
    costs = np.full((7, 7), 10**9)
    costs[robot[::-1]] = 0
    for _ in range(48):
        before = costs.copy()
        for dx, dy in STEPS:
            for y, x in np.argwhere(costs < 10**9):
                if 0 <= x + dx < 7 and 0 <= y + dy < 7:
                    through = costs[y, x] + weights[y, x]
                    costs[y + dy, x + dx] = min(costs[y + dy, x + dx], through)
        if (before == costs).all():
            break
    heuristic = Heuristic(robot, least, light, int(weights[light[::-1]]), 0)
    (x, y), (u, v) = robot, place
    straight, diagonal = abs(abs(x - u) - abs(y - v)), min(abs(x - u), abs(y - v))
    assert kernels.bound(heuristic, *place) >> LENGTH_BITS == costs[place[::-1]]
    assert kernels.bound(heuristic, *place) % (1 << LENGTH_BITS) == 2 * straight + 3 * diagonal


def least_ahead(search, weights, place):
    """The least cost to the target by a step and what g says there."""
    if place == search.target:
        return 0
    x, y = place
    found = [NO_PATH]
    for dx, dy in STEPS:
        there = x + dx, y + dy
        if any(naive.is_obstacle(weights, *each) for each in (place, there)):
            continue
        if not naive.forbidden(weights, place, there, RULES[search.rule]):
            step = (int(search.table[y, x]) << LENGTH_BITS) + (3 if dx and dy else 2)
            found.append(step + int(search.g[there[1] * search.table.shape[1] + there[0]]))
    return min(found)


def check(search, heuristic, weights, size):
    """Raise AssertionError unless the search may go on from here."""
    rows, cols = weights.shape
    for place in range(rows * cols):
        assert search.rhs[place] == least_ahead(search, weights, (place % cols, place // cols))
    queue = search.queue[:size].tolist()
    assert sorted(queue) == np.flatnonzero(search.g != search.rhs).tolist()
    for place in range(rows * cols):
        at = search.position[place]
        assert at == (queue.index(place) if place in queue else FREE)
    keys = [tuple(search.keys[place].tolist()) for place in queue]
    assert all(keys[i] >= keys[(i - 1) // 2] for i in range(1, size))
    for place, key in zip(queue, keys, strict=True):
        cost = int(min(search.g[place], search.rhs[place]))
        bound = int(kernels.bound(heuristic, place % cols, place // cols))
        assert key <= (cost + bound + heuristic.offset, cost)


@given(problems(most=8), st.data())
def test_after_every_change_what_differs_is_queued_by_a_key_that_is_not_too_large(problem, data):
    weights, rows, cols = problem.map.weights.copy(), problem.map.rows, problem.map.cols
    fields = st.tuples(st.integers(0, cols - 1), st.integers(0, rows - 1))
    whole = [np.empty(rows * cols, dtype=np.int64) for _ in range(4)]
    keys = np.empty((rows * cols, 2), dtype=np.int64)
    rule = int(problem.corner_cutting)
    search = Search(problem.map.table.copy(), *whole, keys, problem.target, rule)
    size = kernels.begin(search)
    light = int(problem.map.table[problem.start[::-1]])
    heuristic = Heuristic(problem.start, 0, problem.start, light, 0)
    for _ in range(data.draw(st.integers(1, 4))):
        known = GridMap("known", weights).table
        changed = np.flatnonzero(known != search.table)
        size, expansions, path = kernels.repair(search, heuristic, size, known, changed)
        check(search, heuristic, weights, size)
        assert expansions <= 2 * rows * cols
        if len(path):
            robot = tuple(path[data.draw(st.integers(0, len(path) - 1))].tolist())
            offset = heuristic.offset + kernels.bound(heuristic, *robot)
            heuristic = heuristic._replace(robot=robot, offset=offset)
        for x, y in data.draw(st.lists(fields, max_size=6)):
            if (x, y) not in (problem.target, problem.start, heuristic.robot):
                weights[y, x] = data.draw(st.sampled_from([0.25, 0.5, 1.0]))
