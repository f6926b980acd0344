"""Grid maps: what they accept, the rule of coordinates, the table."""

import math

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import problems, weights

from gapath.errors import InputError
from gapath.grid import MAX_SIDE, GridMap
from gapath.kernels.units import OBSTACLE
from gapath.problem import CornerCutting


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([[0.5, float("nan")]], r"field \(1, 0\): got nan"),
        ([[0.5], [float("inf")]], r"field \(0, 1\): got inf"),
        ([[0.5, -0.1]], r"field \(1, 0\): got -0.1"),
        ([[0.5, 1.5]], "expected a finite weight in"),
        ([0.5, 0.5], "shape"),
        ([[]], "shape"),
        ([["a"]], "real numbers"),
        ([[1], [1, 2]], "an array of numbers"),
        ([[1j]], "real numbers"),
        (np.zeros((1, MAX_SIDE + 1)), "at most"),
    ],
)
def test_weights_that_are_none_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        GridMap("bad", values)


@pytest.mark.parametrize("resolution", [0.0, -1.0, float("nan"), float("inf")])
def test_a_resolution_that_is_none_is_refused(resolution):
    with pytest.raises(InputError, match="resolution"):
        GridMap("bad", np.zeros((2, 2)), resolution=resolution)


@given(weights())
def test_the_table_holds_weights_in_fixed_point(values):
    table = GridMap("random", values).table
    blocked = values == 1
    assert (table[blocked] == OBSTACLE).all()
    assert np.abs(table[~blocked] / 65536 - values[~blocked]).max(initial=0) <= 0.5 / 65536


@given(weights(6))
def test_the_least_weight_leaves_out_start_and_target(values):
    grid = GridMap("random", values)
    start, target = (0, 0), (grid.cols - 1, grid.rows - 1)
    others = np.delete(grid.table.ravel(), [0, grid.table.size - 1])
    assert grid.least_weight(start, target) == others.min(initial=others[0])


@given(weights(6), st.sampled_from([None, 0.5]))
def test_a_map_is_even_if_no_field_but_the_ends_weighs_more_or_less(values, floor):
    if floor is not None:
        values[values < 1] = floor
        values[0, 0] = 0.25
    grid = GridMap("random", values)
    ends = (0, 0), (grid.cols - 1, grid.rows - 1)
    others = np.delete(values.ravel(), [0, values.size - 1])
    assert grid.is_even(*ends) == (len(set(others[others < 1])) <= 1)
    assert grid.is_even(ends[1], ends[1]) == (len(set(values.ravel()[:-1]) - {1.0}) <= 1)


def test_a_map_cannot_be_changed_behind_its_back():
    values = np.full((2, 3), 0.5)
    grid = GridMap("own", values)
    values[0, 0] = 1.0
    assert grid.weights[0, 0] == 0.5
    with pytest.raises(ValueError, match="read-only"):
        grid.weights[0, 0] = 1.0
    values.setflags(write=False)
    assert GridMap("final", values).weights is values
    of_bytes = np.frombuffer(values.tobytes()).reshape(2, 3)
    assert GridMap("of bytes", of_bytes).weights is of_bytes
    buffer = bytearray(values.tobytes())
    for of_another in (np.frombuffer(buffer).reshape(2, 3), np.full((4, 3), 0.5)[::2]):
        of_another.setflags(write=False)
        assert not np.shares_memory(GridMap("of another", of_another).weights, of_another)


def test_metres_point_up_by_hand():
    """Two rows of 0.5 m, corner at (10, 20): field (0, 1) is the lower left one."""
    grid = GridMap("ros", np.zeros((2, 3)), resolution=0.5, origin=(10.0, 20.0, 0.0))
    fields = np.array([(0, 1), (2, 0)], dtype=np.int32)
    assert grid.to_metres(fields).tolist() == [[10.25, 20.25], [11.25, 20.75]]
    turned = GridMap("ros", np.zeros((2, 3)), resolution=0.5, origin=(10.0, 20.0, math.pi / 2))
    np.testing.assert_allclose(turned.to_metres(fields), [[9.75, 20.25], [9.25, 21.25]])


def test_fields_of_metres_by_hand():
    """A field holds its left and its lower border; what lies beyond the map has a field there."""
    grid = GridMap("ros", np.zeros((2, 3)), resolution=0.5, origin=(10.0, 20.0, 0.0))
    inside = [(10.0, 20.0), (10.49, 20.49), (11.0, 20.5)]
    assert grid.to_fields(inside).tolist() == [[0, 1], [0, 1], [2, 0]]
    beyond = [(9.9, 20.0), (11.5, 21.0), (1e300, -1e300)]
    assert not any(grid.contains(tuple(place)) for place in grid.to_fields(beyond))


@given(
    st.tuples(st.integers(0, 99), st.integers(0, 49)),
    st.sampled_from([0.05, 0.1, 0.5, 1.0]),
    st.tuples(st.floats(-100, 100), st.floats(-100, 100), st.floats(-3.2, 3.2)),
)
def test_a_fields_centre_lies_in_it(place, resolution, origin):
    grid = GridMap("ros", np.zeros((50, 100)), resolution=resolution, origin=origin)
    assert grid.to_fields(grid.to_metres(np.array([place]))).tolist() == [[*place]]


@pytest.mark.parametrize("metres", [(1.0, 2.0), [(1.0, 2.0, 3.0)], [(math.nan, 1.0)]])
def test_what_are_no_points_is_refused(metres):
    with pytest.raises(InputError, match="points"):
        GridMap("ros", np.zeros((2, 3))).to_fields(metres)


def test_the_digest_tells_maps_apart():
    maps = [
        GridMap("a", np.zeros((2, 3))),
        GridMap("a", np.zeros((3, 2))),
        GridMap("a", np.full((2, 3), 0.5)),
        GridMap("a", np.zeros((2, 3)), resolution=0.5),
        GridMap("a", np.zeros((2, 3)), origin=(1.0, 0.0, 0.0)),
    ]
    assert len({grid.digest for grid in maps}) == len(maps)
    assert maps[0].digest == GridMap("b", np.zeros((2, 3))).digest


@given(problems(most=12))
def test_fields_are_joined_where_a_path_joins_them(problem):
    grid, start, target = problem.map, problem.start, problem.target
    for rule in CornerCutting:
        cost = naive.shortest_cost(grid.weights, start, target, rule.name.lower())
        assert grid.joined(start, target, rule) == math.isfinite(cost)
