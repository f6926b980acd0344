"""Clamped B-splines of degree 2 with equidistant knots, in exact arithmetic (KG18 Sec. 3.1).

Every way point is a fixed rational combination of the control points, with a small common
denominator d, so the basis functions are computed once, as fractions. Before it is rounded
half up a coordinate is a multiple of 1 / (2 d). Adding 1 / (4 d) moves it that far from every
integer, much farther than floating-point sums err: its floor is exact on every machine.
"""

import math
from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.raster import polyline

DEGREE = 2


class Basis(NamedTuple):
    """Basis functions at the parameters of the way points (w way points, k control points)."""

    weights: NDArray[np.float64]
    """(w, k) N_i(u_j); each row sums to 1."""
    rounding: NDArray[np.float64]
    """(w,) what to add before the floor: 1/2, and 1 / (4 d) with the row's denominator d."""


def knots(control_points: int) -> list[Fraction]:
    """Give the clamped, equidistant knot vector U (KG18 eq. (2)).

    Parameters
    ----------
    control_points : int
        k, at least 3.

    Returns
    -------
    list of Fraction
        k + 3 knots: 0, 0, 0, 1 / (k - 2), ..., 1, 1, 1.
    """
    spans = control_points - DEGREE
    inner = [Fraction(j, spans) for j in range(spans + 1)]
    return [inner[0]] * DEGREE + inner + [inner[-1]] * DEGREE


def basis_functions(control_points: int, u: Fraction) -> list[Fraction]:
    """Evaluate the basis functions N_{i,2}(u) by their recursion (KG18 eq. (1)).

    Parameters
    ----------
    control_points : int
        k, at least 3.
    u : Fraction
        Parameter in [0, 1].

    Returns
    -------
    list of Fraction
        N_0 to N_{k-1}; they sum to 1.
    """
    knot = knots(control_points)
    last = control_points - 1  # the last span is closed on the right
    values = [
        Fraction(knot[i] <= u < knot[i + 1] or (u == 1 and i == last)) for i in range(len(knot) - 1)
    ]

    def part(value: Fraction, numerator: Fraction, denominator: Fraction) -> Fraction:
        return value * numerator / denominator if denominator else Fraction(0)

    for p in range(1, DEGREE + 1):
        values = [
            part(values[i], u - knot[i], knot[i + p] - knot[i])
            + part(values[i + 1], knot[i + p + 1] - u, knot[i + p + 1] - knot[i + 1])
            for i in range(len(values) - 1)
        ]
    return values


@lru_cache
def fractions(
    control_points: int, way_points: int, per_span: bool
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Compute the basis functions at equidistant parameters, as whole numbers.

    Parameters
    ----------
    control_points : int
        k, at least 3.
    way_points : int
        Samples of the whole curve, or of each knot span; at least 2, both ends included.
    per_span : bool
        Sample every knot span instead of the whole curve; shared ends count once.

    Returns
    -------
    numerators : (w, k) int64
        One row a way point; each sums to its denominator, and at most three are not 0.
    denominators : (w,) int64
        The least of each row.
    """
    spans = control_points - DEGREE if per_span else 1
    pieces = spans * (way_points - 1)
    rows = [basis_functions(control_points, Fraction(j, pieces)) for j in range(pieces + 1)]
    denominators = [math.lcm(*(value.denominator for value in row)) for row in rows]
    numerators = [
        [int(value * d) for value in row] for row, d in zip(rows, denominators, strict=True)
    ]
    return np.array(numerators), np.array(denominators)


@lru_cache
def basis(control_points: int, way_points: int, per_span: bool) -> Basis:
    """Compute the basis functions at equidistant parameters.

    Parameters
    ----------
    control_points, way_points, per_span
        As of `fractions`.

    Returns
    -------
    Basis
        One row a way point.
    """
    numerators, denominators = fractions(control_points, way_points, per_span)
    return Basis(numerators / denominators[:, None], 0.5 + 0.25 / denominators)


@kernel
def way_point(chromosome: NDArray[np.int32], basis: Basis, j: int, axis: int) -> int:
    """Compute one coordinate of a way point, rounded half up to a field's centre.

    Parameters
    ----------
    chromosome : (2 k,) int32
        Control points x1, y1, ..., xk, yk (KG18 eq. (3)).
    basis : Basis
        The basis functions.
    j : int
        Number of the way point.
    axis : int
        0 for x, 1 for y.

    Returns
    -------
    int
        floor(B(u_j) + 1/2).
    """
    total = basis.rounding[j]
    for i in range(basis.weights.shape[1]):
        total += basis.weights[j, i] * chromosome[2 * i + axis]
    return np.int64(np.floor(total))


@kernel
def way_points(chromosomes: NDArray[np.int32], basis: Basis) -> NDArray[np.int32]:
    """Compute the way points of many chromosomes.

    Parameters
    ----------
    chromosomes : (n, 2 k) int32
        One chromosome a row.
    basis : Basis
        The basis functions at w parameters.

    Returns
    -------
    (n, w, 2) int32
        Way points as (x, y).
    """
    points = np.empty((chromosomes.shape[0], basis.rounding.shape[0], 2), dtype=np.int32)
    for i in range(points.shape[0]):
        for j in range(points.shape[1]):
            for axis in range(2):
                points[i, j, axis] = way_point(chromosomes[i], basis, j, axis)
    return points


@kernel
def rasterise(
    chromosome: NDArray[np.int32], weights: NDArray[np.float64], rounding: NDArray[np.float64]
) -> NDArray[np.int32]:
    """Give the fields of a chromosome's path (KG18 Sec. 3.4, step 1).

    Parameters
    ----------
    chromosome : (2 k,) int32
        Control points x1, y1, ..., xk, yk.
    weights, rounding
        `Basis`.

    Returns
    -------
    (n, 2) int32
        Fields as (x, y), as `gapath.kernels.raster.polyline` gives them.
    """
    points = way_points(chromosome.reshape(1, chromosome.shape[0]), Basis(weights, rounding))
    return polyline(points[0])
