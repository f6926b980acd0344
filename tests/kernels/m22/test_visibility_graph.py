"""Free lines, their lengths and the shortest paths: by the paper's own XOR, and by SciPy."""

import itertools
import math

import naive_visibility as twin
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from strategies import RULES
from visibility_strategies import picture_of, pictures

from gapath.kernels.m22.graph import BLOCKED, graph_lengths, line_is_free, shortest
from gapath.kernels.units import ALLOW, FORBID, NO_DIAGONALS, OBSTACLE, ONE_SIDE, SCALE


def table_of(picture):
    return np.where(picture, np.int32(OBSTACLE), np.int32(0))


def lengths_of(picture, points, rule=ALLOW):
    points = np.array(points, dtype=np.int32).reshape(-1, 2)
    lengths = np.full((len(points), len(points)), 99, dtype=np.int64)
    graph_lengths(table_of(picture), points, rule, lengths)
    return lengths


def search(lengths, points, informed):
    """Length, points of the path and number of points expanded."""
    n = len(points)
    costs, before = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int32)
    expansions = np.empty(1, dtype=np.int64)
    points = np.array(points, dtype=np.int32)
    length = shortest(lengths, points, informed, costs, before, expansions)
    path = [1]
    while length >= 0 and path[-1]:
        path.append(int(before[path[-1]]))
    assert length == costs[1]
    return length, path[::-1], int(expansions[0])


@settings(max_examples=100)
@given(pictures(), st.integers(0, 2**32 - 1), st.sampled_from(RULES))
def test_a_line_is_free_if_drawing_it_changes_no_pixel(picture, seed, rule):
    """Eq. (4) on some thousand lines, in both directions."""
    rows, cols = picture.shape
    random, table = np.random.default_rng(seed), table_of(picture)
    ends = random.integers(0, [cols, rows, cols, rows], (30, 4)).tolist()
    for x, y, u, v in ends:
        free = twin.line_is_free(picture, (x, y), (u, v), rule)
        assert line_is_free(table, x, y, u, v, RULES.index(rule)) == free
        assert line_is_free(table, u, v, x, y, RULES.index(rule)) == free


@pytest.mark.parametrize(
    ("picture", "ends", "free_by_rule"),
    [
        ("... ... ...", (0, 0, 2, 2), (True, True, True, False)),
        (".#. ... ...", (0, 0, 2, 2), (True, True, False, False)),
        (".#. #.. ...", (0, 0, 2, 2), (True, False, False, False)),
        ("... .#. ...", (0, 0, 2, 2), (False, False, False, False)),
        ("... ... ...", (0, 1, 2, 1), (True, True, True, True)),
        ("#.. ... ...", (0, 0, 2, 0), (False, False, False, False)),
        ("..# ... ...", (0, 0, 2, 0), (False, False, False, False)),
        ("... .#. ...", (0, 0, 0, 0), (True, True, True, True)),
        ("... .#. ...", (1, 1, 1, 1), (False, False, False, False)),
    ],
)
def test_lines_by_hand(picture, ends, free_by_rule):
    table = table_of(picture_of(picture))
    rules = (ALLOW, ONE_SIDE, FORBID, NO_DIAGONALS)
    assert tuple(line_is_free(table, *ends, rule) for rule in rules) == free_by_rule


def test_lengths_by_hand():
    """A 3-4-5 triangle; sqrt(2) rounded up; a line through an obstacle; a point within one."""
    picture = np.zeros((5, 5), dtype=np.bool_)
    picture[3, 1] = True
    lengths = lengths_of(picture, [(0, 0), (3, 4), (4, 4), (1, 3), (3, 4)])
    assert lengths[0, 0] == 0
    assert lengths[0, 1] == lengths[1, 0] == 5 * SCALE
    assert lengths[1, 2] == SCALE
    assert lengths[1, 4] == 0
    assert lengths[0, 2] == math.isqrt(32 * SCALE**2) + 1
    assert (lengths[3] == BLOCKED).all() and (lengths[:, 3] == BLOCKED).all()


@given(pictures(most=20), st.integers(0, 2**32 - 1), st.sampled_from(RULES))
def test_lengths_equal_the_twin(picture, seed, rule):
    rows, cols = picture.shape
    points = np.random.default_rng(seed).integers(0, [cols, rows], (7, 2)).tolist()
    lengths = lengths_of(picture, points, RULES.index(rule))
    assert (lengths == lengths.T).all()
    expected = twin.graph_lengths(picture, [tuple(point) for point in points], rule)
    assert [[None if v == BLOCKED else v for v in row] for row in lengths.tolist()] == expected


@settings(max_examples=200)
@given(pictures(), st.integers(0, 2**32 - 1), st.integers(2, 40))
def test_both_searches_find_the_shortest_path(picture, seed, n):
    rows, cols = picture.shape
    random = np.random.default_rng(seed)
    points = random.integers(0, [cols, rows], (n, 2))
    lengths = lengths_of(picture, points)
    # scipy takes edges without length for no edges: one unit more for each line
    there = csr_array(np.where(lengths >= 0, lengths, np.inf) * n + 1)
    there.data[~np.isfinite(there.data)] = 0
    there.eliminate_zeros()
    far = dijkstra(there, indices=0)[1]
    found, path, expansions = search(lengths, points, informed=False)
    assume(found != 0)  # start and end in the same place
    assert found == (BLOCKED if math.isinf(far) else int(far) // n)
    by_star, path_of_star, fewer = search(lengths, points, informed=True)
    assert by_star == found
    assert fewer <= expansions <= n
    if found >= 0:
        for way in (path, path_of_star):
            assert way[0] == 0 and way[-1] == 1
            pieces = [lengths[a, b] for a, b in itertools.pairwise(way)]
            assert min(pieces) >= 0 and sum(pieces) == found


@given(st.integers(0, 2**32 - 1), st.integers(2, 9), st.sampled_from([0.2, 0.5, 0.9]))
def test_shortest_paths_equal_the_twin_on_any_graph(seed, n, density):
    """Lengths need not be those of lines; Dijkstra only, the straight line bounds nothing here."""
    random = np.random.default_rng(seed)
    lengths = random.integers(0, 50, (n, n))
    lengths[random.random((n, n)) > density] = BLOCKED
    lengths = np.triu(lengths, 1) + np.triu(lengths, 1).T
    found, _, _ = search(lengths, np.zeros((n, 2)), informed=False)
    expected = twin.shortest(
        [[None if v == BLOCKED else v for v in row] for row in lengths.tolist()]
    )
    assert found == (BLOCKED if expected is None else expected)


@pytest.mark.parametrize("informed", [True, False])
def test_without_a_way_there_is_no_length(informed):
    walled = picture_of("..#.. ..#.. ..#..")
    points = [(0, 0), (4, 2), (1, 2), (3, 0)]
    found, _, expansions = search(lengths_of(walled, points), points, informed)
    assert found == BLOCKED
    assert expansions == 2


def test_the_straight_line_leads_the_search():
    """Points behind the start are not looked at."""
    points = [(5, 5), (11, 5), *[(0, y) for y in range(11)]]
    lengths = lengths_of(np.zeros((11, 12), dtype=np.bool_), points)
    assert search(lengths, points, True)[1:] == ([0, 1], 1)
    assert search(lengths, points, False)[2] > 1
