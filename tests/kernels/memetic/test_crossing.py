"""The crossover against a dictionary of common fields: never dearer than either parent."""

import naive_memetic as slow
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from naive_memetic import packed, unpacked

from gapath.grid import GridMap
from gapath.kernels.memetic.crossing import cross


@st.composite
def parents(draw):
    """A problem and two paths with the same ends; of the second also one that comes back."""
    problem, first = draw(slow.paths(most=12))
    weights, name = problem.map.weights, problem.corner_cutting.name.lower()
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    second = slow.wandering(weights, problem.start, name, draw(st.integers(0, 60)), random)
    last = {place: i for i, place in enumerate(first)}
    second = max((second[: i + 1] for i, f in enumerate(second) if f in last), key=len)
    first = first[: last[second[-1]] + 1]
    return problem, *draw(st.permutations([first, second]))


def crossed(problem, first, second, seed=0):
    random = np.random.default_rng(seed)
    order = random.integers(-3, 99, problem.map.table.size).astype(np.int32)
    child = np.empty(len(first) + len(second), dtype=np.uint32)
    count, cost, pieces = cross(
        problem.map.table, packed(first), len(first), packed(second), len(second), order, child
    )
    return unpacked(child[:count]), cost, pieces


@given(parents(), st.integers(0, 9))
def test_a_child_equals_the_slow_twins_and_is_never_dearer_than_a_parent(drawn, seed):
    problem, first, second = drawn
    weights, name = problem.map.weights, problem.corner_cutting.name.lower()
    child, cost, pieces = crossed(problem, first, second, seed)
    assert (child, pieces) == slow.cross(weights, first, second)
    assert cost == slow.cost(weights, child)
    assert cost <= min(slow.cost(weights, path) for path in (first, second))
    assert (child[0], child[-1]) == (first[0], first[-1])
    assert slow.flaw_of(weights, child, name) is None


def test_a_child_has_the_best_of_both():
    """Two ways round each of two obstacles, one parent the better past the first, one the other."""
    weights = np.full((3, 9), 0.5)
    weights[1, 2] = weights[1, 6] = 1.0
    weights[0, 1:4], weights[2, 5:8] = 0.75, 0.75
    problem = slow.Problem(GridMap("two", weights), (0, 1), (8, 1))
    above = [(0, 1), (1, 0), (2, 0), (3, 0), (4, 1), (5, 0), (6, 0), (7, 0), (8, 1)]
    below = [(x, 2 if y == 0 else y) for x, y in above]
    child, cost, pieces = crossed(problem, above, below)
    assert child == below[:5] + above[5:] and pieces == 1
    assert cost == 8 * 32768
