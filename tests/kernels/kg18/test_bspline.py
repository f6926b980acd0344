"""The B-spline against SciPy, against de Boor's algorithm, and by hand."""

import math
from fractions import Fraction

import naive
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from gapath.kernels.kg18.bspline import (
    basis,
    basis_functions,
    fractions,
    knots,
    rasterise,
    way_points,
)
from gapath.kernels.raster import COORDINATE_LIMIT, polyline


def test_knots_of_five_control_points_by_hand():
    assert knots(5) == [0, 0, 0, Fraction(1, 3), Fraction(2, 3), 1, 1, 1]


def test_three_control_points_are_a_parabola_by_hand():
    """Without inner knots eq. (1) is Bernstein's: (1 - u)^2, 2 u (1 - u), u^2."""
    assert basis_functions(3, Fraction(1, 4)) == [Fraction(9, 16), Fraction(6, 16), Fraction(1, 16)]


def test_four_control_points_by_hand():
    """At the inner knot 1/2 of four control points only the two middle ones count, half each."""
    assert basis_functions(4, Fraction(1, 2)) == [0, Fraction(1, 2), Fraction(1, 2), 0]


@pytest.mark.parametrize("control_points", [3, 4, 5, 6, 8, 12])
@pytest.mark.parametrize("per_span", [False, True])
def test_basis_equals_scipy(control_points, per_span):
    ours = basis(control_points, 5, per_span)
    u = np.linspace(0, 1, len(ours.rounding))
    knot = np.array(knots(control_points), dtype=float)
    curves = [BSpline(knot, row, 2) for row in np.eye(control_points)]
    expected = np.stack([curve(u) for curve in curves], axis=1)
    np.testing.assert_allclose(ours.weights, expected, atol=1e-12)
    np.testing.assert_allclose(ours.weights.sum(axis=1), 1.0, rtol=1e-15)


@given(st.integers(3, 32), st.integers(2, 64), st.booleans())
def test_whole_numbers_are_the_same_basis_functions(k, samples, per_span):
    numerators, denominators = fractions(k, samples, per_span)
    pieces = len(denominators) - 1
    for j in {0, 1, pieces // 2, pieces}:
        of_row = [Fraction(int(n), int(denominators[j])) for n in numerators[j]]
        assert of_row == basis_functions(k, Fraction(j, pieces))
        assert math.lcm(*(each.denominator for each in of_row)) == denominators[j]


@given(
    st.lists(st.tuples(st.integers(-5000, 5000), st.integers(-5000, 5000)), min_size=3, max_size=9),
    st.integers(2, 9),
    st.booleans(),
)
def test_way_points_equal_the_naive_twin(points, samples, per_span):
    chromosome = [c for point in points for c in point]
    ours = way_points(np.array([chromosome], dtype=np.int32), basis(len(points), samples, per_span))
    assert list(map(tuple, ours[0])) == naive.way_points(chromosome, samples, per_span)


@settings(max_examples=40)
@given(st.integers(3, 32), st.integers(2, 64), st.booleans(), st.integers(0, 2**32 - 1))
def test_way_points_are_exact_for_the_largest_settings(k, samples, per_span, seed):
    """As many control and way points as a planner takes, as far off as genes may lie."""
    random = np.random.default_rng(seed)
    chromosome = random.integers(-COORDINATE_LIMIT, COORDINATE_LIMIT, 2 * k, endpoint=True)
    ours = way_points(chromosome[None].astype(np.int32), basis(k, samples, per_span))[0]
    assert list(map(tuple, ours)) == naive.way_points(chromosome.tolist(), samples, per_span)


def test_the_path_is_the_way_points_joined():
    chromosome = np.array([3, 7, 900, -20, 41, 5, 60, 8], dtype=np.int32)
    splines = basis(4, 5, False)
    joined = polyline(way_points(chromosome[None], splines)[0])
    assert rasterise(chromosome, *splines).tolist() == joined.tolist()


def test_the_curve_begins_and_ends_at_its_outer_control_points():
    chromosome = np.array([[3, 7, 900, -20, 41, 5, 60, 8]], dtype=np.int32)
    ours = way_points(chromosome, basis(4, 5, False))[0]
    assert tuple(ours[0]) == (3, 7)
    assert tuple(ours[-1]) == (60, 8)
