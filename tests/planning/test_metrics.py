"""Metrics of paths, by hand, and the check of paths."""

import itertools
import math

import naive
import numpy as np
import pytest
from hypothesis import given
from strategies import problems

from gapath.grid import GridMap
from gapath.planning.flaw import flaw
from gapath.planning.metrics import clearances, path_metrics
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Problem

WEIGHTS = np.full((5, 7), 0.5)
WEIGHTS[2, 3] = 1.0
GRID = GridMap("hand", WEIGHTS)
PATH = np.array([(0, 0), (1, 1), (2, 1), (3, 1), (4, 2), (4, 3)], dtype=np.int32)


def test_a_path_by_hand():
    """Two diagonal and three straight steps; SE, E, E, SE, S: three turns of 45 degrees."""
    metrics = path_metrics(GRID, PATH, clearances(GRID))
    assert metrics.cost == 3.0
    assert metrics.length == pytest.approx(3 + 2 * math.sqrt(2))
    assert metrics.turns == 3
    assert metrics.clearance == 1.0
    assert metrics.curvature == pytest.approx(3 * math.pi / 4 / (3 + 2 * math.sqrt(2)))


def test_turning_back_is_a_half_turn():
    there_and_back = np.array([(0, 0), (1, 0), (0, 0)], dtype=np.int32)
    assert path_metrics(GRID, there_and_back, clearances(GRID)).curvature == math.pi / 2


def test_no_path_has_no_metrics():
    metrics = path_metrics(GRID, PATH[:0], clearances(GRID))
    assert math.isnan(metrics.cost)
    assert math.isnan(metrics.length)


def test_what_lies_outside_the_map_is_an_obstacle():
    assert clearances(GridMap("empty", np.zeros((5, 5)))).tolist()[2] == [1, 2, 3, 2, 1]


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
