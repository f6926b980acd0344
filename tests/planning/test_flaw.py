"""The check of paths: what is wrong with one, whoever planned it."""

import itertools

import naive
import numpy as np
import pytest
from hypothesis import given
from strategies import problems

from gapath.grid import GridMap
from gapath.planning.flaw import flaw
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Problem

WEIGHTS = np.full((5, 7), 0.5)
WEIGHTS[2, 3] = 1.0
GRID = GridMap("hand", WEIGHTS)
PATH = np.array([(0, 0), (1, 1), (2, 1), (3, 1), (4, 2), (4, 3)], dtype=np.int32)


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ([(0, 0), (1, 1)], "joins"),
        ([(1, 0), (4, 3)], "joins"),
        ([(0, 0), (2, 2), (4, 3)], "not neighbours"),
        ([(0, 0), (0, 0), (4, 3)], "not neighbours"),
        ([(0, 0), (1, 1), (2, 1), (3, 2), (4, 3)], "obstacle"),
        ([(0, 0), (0, -1), (4, 3)], "outside"),
        ([], "shape"),
    ],
)
def test_wrong_paths_are_recognised(path, message):
    problem = Problem(GRID, (0, 0), (4, 3))
    assert message in flaw(problem, np.array(path, dtype=np.int32).reshape(-1, 2))


@pytest.mark.parametrize("path", [PATH.tolist(), PATH.astype(np.int64), PATH / 1.0, None])
def test_what_is_no_array_of_fields_is_told(path):
    found = getattr(path, "dtype", type(path).__name__)
    assert flaw(Problem(GRID, (0, 0), (4, 3)), path) == f"{found} instead of an array of int32"


def test_a_right_path_has_no_flaw():
    assert flaw(Problem(GRID, (0, 0), (4, 3)), PATH) is None
    assert flaw(Problem(GRID, (0, 0), (4, 3), CornerCutting.ONE_SIDE), PATH) is None
    assert "corner" in flaw(Problem(GRID, (0, 0), (4, 3), CornerCutting.FORBID), PATH)
    assert "corner" in flaw(Problem(GRID, (0, 0), (4, 3), CornerCutting.NO_DIAGONALS), PATH)


@given(problems(most=10))
def test_corners_are_judged_as_by_the_naive_twin(problem):
    """A path that is shortest where corners may be cut, judged by the stricter rules."""
    free = Problem(problem.map, problem.start, problem.target)
    path = shortest_path(free).path
    if not len(path):
        return
    steps = [tuple(field) for field in path.tolist()]
    rule = problem.corner_cutting.name.lower()
    cut = any(
        naive.forbidden(problem.map.weights, a, b, rule) for a, b in itertools.pairwise(steps)
    )
    assert (flaw(problem, path) is not None) == cut
