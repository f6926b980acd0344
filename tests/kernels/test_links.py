"""Link distances: by hand, and against the naive raster."""

import naive
import numpy as np
from hypothesis import given, settings
from strategies import problems

from gapath.grid import GridMap
from gapath.kernels.links import link_distances


def test_an_s_needs_three_pieces_by_hand():
    rows = ["...@...", "...@.@.", "...@.@.", ".....@."]
    weights = np.array([[1.0 if c == "@" else 0.5 for c in row] for row in rows])
    distances = link_distances(GridMap("s", weights).table, (0, 0), 5)
    assert distances[3, 4] == 2  # around the first wall
    assert distances[0, 4] == 3
    assert distances[3, 6] == 4
    assert distances[0, 3] == -1


@settings(max_examples=30)
@given(problems(most=7))
def test_one_piece_is_a_free_line(problem):
    table, (x, y) = problem.map.table, problem.start
    rows, cols = table.shape
    distances = link_distances(table, (x, y), 1)
    for v in range(rows):
        for u in range(cols):
            obstacles, _ = naive.fitness(problem.map.weights, naive.polyline([(x, y), (u, v)]))
            assert (distances[v, u] >= 0) == (obstacles == 0)
