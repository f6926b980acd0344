"""Mutations: what is drawn stays on the map, what is taken is cheaper or simpler."""

import naive
import naive_memetic as slow
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from naive_memetic import places, polygons, vertices

from gapath.kernels.memetic.mutations import (
    CUT,
    INSERT,
    MOVE,
    REFUSED,
    SHORTCUT,
    distance_below,
    propose,
    replace,
)
from gapath.kernels.rng import fill, stream

FULL = 2**64 - 1
WORD = st.one_of(st.sampled_from([0, 2**32 - 1, FULL - (2**32 - 1), FULL]), st.integers(0, FULL))


@given(st.integers(0, 16), WORD)
def test_distances_are_below_their_bound(bits, word):
    assert 0 <= distance_below(bits, np.uint64(word)) < 2**bits


@pytest.mark.parametrize("bits", [0, 1, 5])
def test_orders_of_magnitude_are_equally_likely_and_distances_within_one(bits):
    words = np.empty(30_000, dtype=np.uint64)
    fill(stream(3), words)
    drawn = np.array([distance_below(bits, word) for word in words])
    orders = np.bincount([int(d).bit_length() for d in drawn], minlength=bits + 1)
    assert len(orders) == bits + 1
    share = len(words) / (bits + 1)
    assert (abs(orders - share) <= 5 * share**0.5).all()
    if bits:
        last = np.bincount(drawn[drawn >= 2 ** (bits - 1)] - 2 ** (bits - 1))
        share /= 2 ** (bits - 1)
        assert len(last) == 2 ** (bits - 1)
        assert (abs(last - share) <= 5 * share**0.5).all()


KINDS = [SHORTCUT, MOVE, CUT, INSERT]


@st.composite
def proposals(draw):
    """A problem, a polygon, and what `propose` makes of any words."""
    kind = draw(st.sampled_from(KINDS))
    problem, points = draw(polygons(most=24, least=2 if kind == INSERT else 3))
    rows, cols = problem.map.weights.shape
    words = np.array(draw(st.tuples(WORD, WORD, WORD, WORD)), dtype=np.uint64)
    new = np.full((2, 2), -1, dtype=np.int32)
    i, j, count = propose(kind, vertices(points), len(points), rows, cols, words, new)
    return problem, points, kind, i, j, places(new[:count])


@given(proposals())
def test_proposals_stay_on_the_map_and_within_the_polygon(drawn):
    problem, points, kind, i, j, new = drawn
    rows, cols = problem.map.weights.shape
    assert 0 <= i < j < len(points)
    assert all(0 <= x < cols and 0 <= y < rows for x, y in new)
    assert len(new) == {SHORTCUT: 0, MOVE: 1, CUT: 2, INSERT: 1}[kind]
    assert j - i == 1 if kind == INSERT else j - i >= 2
    if kind == MOVE:
        assert j - i == 2
    if kind == CUT:
        assert new[0] in naive.polyline(points[i : i + 2])
        assert new[1] in naive.polyline(points[j - 1 : j + 1])


def test_every_place_of_a_polygon_is_proposed():
    points, words = vertices([(i, i % 2) for i in range(9)]), np.empty(4, dtype=np.uint64)
    new, random = np.empty((2, 2), dtype=np.int32), stream(1)
    for kind in KINDS:
        seen = set()
        for _ in range(3000):
            fill(random, words)
            seen.add(propose(kind, points, 9, 10, 10, words, new)[:2])
        apart = {SHORTCUT: 8, CUT: 8, MOVE: 2, INSERT: 1}[kind]
        least = min(apart, 2)
        assert seen == {
            (i, j) for i in range(9) for j in range(i + least, min(i + apart, 8) + 1)
        }, kind


@pytest.mark.parametrize("kind", [MOVE, INSERT])
def test_vertices_may_come_to_any_field_and_to_each_border(kind):
    points, words = vertices([(2, 1), (3, 2), (4, 1)]), np.empty(4, dtype=np.uint64)
    new, random, seen = np.empty((2, 2), dtype=np.int32), stream(2), set()
    for _ in range(8000):
        fill(random, words)
        propose(kind, points, 3, 4, 6, words, new)
        seen.add((int(new[0, 0]), int(new[0, 1])))
    assert seen == {(x, y) for x in range(6) for y in range(4)}


@given(st.tuples(WORD, WORD, WORD, WORD))
def test_a_vertex_moves_from_where_it_is_along_both_axes_or_one(drawn):
    """On a map of 50 fields by 50: by less than 32."""
    points, new = vertices([(2, 1), (40, 7), (4, 1)]), np.empty((2, 2), dtype=np.int32)
    propose(MOVE, points, 3, 50, 50, np.array(drawn, dtype=np.uint64), new)
    (x, y), along = new[0].tolist(), naive.low(drawn[0], 3)
    assert x == 40 if along == 1 else 40 - 32 < x <= 49
    assert y == 7 if along == 2 else 0 <= y < 7 + 32


@given(proposals())
def test_what_is_replaced_is_free_and_never_dearer(drawn):
    problem, points, _, i, j, new = drawn
    weights, name = problem.map.weights, problem.corner_cutting.name.lower()
    costs, size = slow.ray_costs(weights, points, name), len(points)
    room = np.full((size + 2, 2), -1, dtype=np.int32)
    room[:size] = points
    paid = np.array([*costs, -1, -1, -1], dtype=np.int64)
    given_new = vertices([*new, (0, 0), (0, 0)][:2])
    gain, count = replace(
        problem.map.table, room, paid, size, i, j, given_new, len(new),
        int(problem.corner_cutting),
    )  # fmt: skip
    found, between = places(room[:count]), [points[i], *new, points[j]]
    assert paid[: count - 1].tolist() == slow.ray_costs(weights, found, name)
    blocked = any(naive.is_obstacle(weights, *place) for place in new) or not all(
        slow.is_free(weights, a, b, name) for a, b in slow.itertools.pairwise(between)
    )
    saved = 0 if blocked else sum(costs[i:j]) - sum(slow.ray_costs(weights, between, name))
    simpler = not blocked and saved == 0 and len(new) < j - i - 1
    if saved > 0 or simpler:
        assert (gain, found) == (saved, points[:i] + between + points[j + 1 :])
        assert sum(paid[: count - 1]) == sum(costs) - gain
    else:
        assert (gain, found) == (REFUSED, points)
