"""The whole numbers of the GPU's fitness, on the processor, against the processor's own."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from strategies import problems, weights

from gapath.grid import GridMap
from gapath.kernels.cuda.fitness import MOST_PARTS, fitness, short_line, way_point, way_rows
from gapath.kernels.kg18 import bspline
from gapath.kernels.kg18 import fitness as processors
from gapath.kernels.lines import line_key
from gapath.kernels.raster import COORDINATE_LIMIT
from gapath.kernels.units import ALLOW


@settings(max_examples=40)
@example(32, 64, True, 0)
@given(st.integers(3, 12), st.integers(2, 20), st.booleans(), st.integers(0, 2**32 - 1))
def test_way_points_are_the_processors_as_far_off_as_genes_may_lie(k, samples, per_span, seed):
    random = np.random.default_rng(seed)
    limit = int(random.choice([3, 100, COORDINATE_LIMIT]))
    chromosome = random.integers(-limit, limit, 2 * k, endpoint=True).astype(np.int32)
    chromosome[random.random(2 * k) < 0.5] = limit
    ours = way_rows(*bspline.fractions(k, samples, per_span))
    expected = bspline.way_points(chromosome[None], bspline.basis(k, samples, per_span))[0]
    for j in range(len(ours)):
        assert [way_point(chromosome, ours, j, axis) for axis in range(2)] == expected[j].tolist()


def test_32_bits_are_enough_for_every_setting_of_a_planner():
    """Denominators grow with way points, and with spans that have no factor in common with them."""
    largest = max(
        bspline.fractions(k, samples, per_span)[1].max()
        for k, samples, per_span in [
            (32, 64, True),
            (31, 64, False),
            (19, 64, False),
            (3, 64, True),
        ]
    )
    assert 2**12 < largest <= MOST_PARTS
    assert 2 * largest * COORDINATE_LIMIT + largest < 2**31


def line_on(values, ends):
    grid = GridMap("drawn", values)
    (rows, cols), table = values.shape, grid.table
    x0, x1 = (np.int32(x % cols) for x in ends[::2])
    y0, y1 = (np.int32(y % rows) for y in ends[1::2])
    ours = short_line(table.reshape(-1), np.int32(cols), x0, y0, x1, y1)
    assert ours == line_key(table, int(x0), int(y0), int(x1), int(y1), ALLOW)


@given(weights(most=40, least=1), st.tuples(*[st.integers(0, 10**6)] * 4))
def test_a_line_on_the_map_is_the_processors(values, ends):
    line_on(values, ends)


@pytest.mark.parametrize("weight", [0.0, 0.99999, 1.0])
def test_long_lines_carry_nothing_from_cost_to_obstacles(weight):
    line_on(np.full((3, 60_000), weight), (0, 0, 59_999, 2))
    line_on(np.full((60_000, 3), weight), (2, 59_999, 0, 0))


@given(problems(most=30, least=1), st.integers(3, 9), st.integers(2, 9), st.integers(0, 2**32 - 1))
def test_a_chromosomes_key_is_the_processors(problem, k, samples, seed):
    random = np.random.default_rng(seed)
    table, rule = problem.map.table, int(problem.corner_cutting)
    spread = int(random.choice([5, 40, 3000, COORDINATE_LIMIT]))
    chromosome = random.integers(-spread // 4, spread, 2 * k).astype(np.int32)
    ours = way_rows(*bspline.fractions(k, samples, False))
    key = processors.fitness(table, chromosome, bspline.basis(k, samples, False), rule)
    assert fitness(table, table.reshape(-1), chromosome, ours, rule) == key
