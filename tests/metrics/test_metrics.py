"""Every metric by hand, and what all of them must offer; they are found, not listed."""

import inspect
import math
from typing import get_type_hints

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from scipy.ndimage import distance_transform_edt

from gapath.discovery import kinds, load
from gapath.grid import GridMap
from gapath.metrics.clearance import measure as clearance
from gapath.planning.path import path_weights
from gapath.problem import Plan, PlanStatus, Problem, no_path
from gapath.task import Row, columns, measured

WEIGHTS = np.full((5, 7), 0.5)
WEIGHTS[2, 3] = 1.0
GRID = GridMap("hand", WEIGHTS)
PATH = np.array([(0, 0), (1, 1), (2, 1), (3, 1), (4, 2), (4, 3)], dtype=np.int32)


def measure(path, lines=no_path):
    """Measure a path, or part of one."""
    path = np.asarray(path, dtype=np.int32).reshape(-1, 2)
    status = PlanStatus.FOUND if len(path) else PlanStatus.NOT_FOUND
    return measured(Problem(GRID, (0, 0), (4, 3)), Plan(status, path, lines=lines))


def test_a_path_by_hand():
    """Two diagonal and three straight steps; SE, E, E, SE, S: three turns of 45 degrees."""
    found = measure(PATH)
    assert path_weights(GRID, PATH) == 3.0
    assert found["length"] == pytest.approx(3 + 2 * math.sqrt(2))
    assert found["turns"] == 3
    assert found["clearance"] == 1.0
    assert found["curvature"] == pytest.approx(3 * math.pi / 4 / (3 + 2 * math.sqrt(2)))
    assert math.isnan(found["line_length"])


def test_straight_lines_are_measured_as_such():
    ends = np.array([(0, 0), (3, 1), (4, 3)], dtype=np.int32)
    found = measure(PATH, lambda: ends)
    assert found["line_length"] == pytest.approx(math.sqrt(10) + math.sqrt(5))


def test_the_angle_over_length_is_that_of_the_lines_where_there_are_any():
    ends = np.array([(0, 0), (0, 0), (3, 1), (4, 3)], dtype=np.int32)
    turn = math.atan2(2, 1) - math.atan2(1, 3)
    found = measure(PATH, lambda: ends)
    assert found["angle_over_length"] == pytest.approx(turn / (math.sqrt(10) + math.sqrt(5)))
    plain = measure(PATH)
    assert plain["angle_over_length"] == pytest.approx(plain["curvature"])
    assert measure([(0, 0)])["angle_over_length"] == 0.0


def test_turning_back_is_a_half_turn():
    found = measure([(0, 0), (1, 0), (0, 0)])
    assert found["curvature"] == found["angle_over_length"] == math.pi / 2


def test_a_path_of_one_field_is_measured():
    found = measure([(0, 0)])
    assert (found["length"], found["turns"], found["curvature"]) == (0.0, 0, 0.0)


@pytest.mark.parametrize("status", [PlanStatus.NOT_FOUND, PlanStatus.INFEASIBLE])
@pytest.mark.parametrize("path", [PATH, PATH[:0]], ids=["passed", "none"])
def test_what_did_not_succeed_has_no_metrics(status, path):
    """Whatever fields it went over."""
    found = measured(Problem(GRID, (0, 0), (4, 3)), Plan(status, path, lines=lambda: path))
    assert found.keys() == set(kinds("metric"))
    assert all(math.isnan(value) for value in found.values())


def test_what_lies_outside_the_map_is_an_obstacle():
    empty = Problem(GridMap("empty", np.zeros((5, 5))), (0, 0), (4, 4))
    plans = [Plan(PlanStatus.FOUND, np.array([(x, 2)], dtype=np.int32)) for x in range(5)]
    assert [clearance(empty, plan) for plan in plans] == [1, 2, 3, 2, 1]


@given(arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, max_side=12)), st.data())
def test_clearance_is_the_least_distance_of_all(blocked, data):
    """Against SciPy's transform, which knows the distance of every field."""
    rows, cols = blocked.shape
    fields = st.tuples(st.integers(0, cols - 1), st.integers(0, rows - 1))
    path = np.array(data.draw(st.lists(fields, min_size=1, max_size=5)), dtype=np.int32)
    blocked[path[:, 1], path[:, 0]] = False
    free = np.pad(~blocked, 1, constant_values=False)
    distances = distance_transform_edt(free)[path[:, 1] + 1, path[:, 0] + 1]
    start, target = map(tuple, path[[0, -1]].tolist())
    problem = Problem(GridMap("drawn", blocked.astype(float)), start, target)
    assert clearance(problem, Plan(PlanStatus.FOUND, path)) == distances.min()


@pytest.mark.parametrize("name", kinds("metric"))
def test_every_metric_says_what_it_is(name):
    metric = load("metric", name)
    assert isinstance(metric.TITLE, str) and metric.TITLE
    assert list(inspect.signature(metric.measure).parameters) == ["problem", "plan"]
    kind = get_type_hints(metric.measure)["return"]
    assert kind in (float, int)
    assert type(measure(PATH, lambda: PATH)[name]) is float
    assert columns(Row)[name] is float
