"""The fitness of many chromosomes at once against the fitness of one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import RULES, weights

from gapath.grid import GridMap
from gapath.kernels.bspline import basis
from gapath.kernels.evaluation import MOST_FIELDS, evaluate, workspace
from gapath.kernels.fitness import OBSTACLE, fitness
from gapath.kernels.lanes import CHROMOSOMES
from gapath.kernels.population import width
from gapath.kernels.raster import COORDINATE_LIMIT


def both(table, chromosomes, splines, rule):
    count, genes = chromosomes.shape
    matrix = np.full((count + 2 + CHROMOSOMES, width(genes)), -(2**31), dtype=np.int32)
    matrix[2 : count + 2, :genes] = chromosomes
    keys = np.full(count + 3, -7, dtype=np.int64)
    memory = workspace(splines)
    for _ in range(2):  # the second time on memory that is used
        evaluate(table, matrix, 2, count + 2, splines, rule, keys, memory)
    assert keys[:2].tolist() == [-7, -7] and keys[-1] == -7
    return keys[2:-1].tolist(), [fitness(table, row, splines, rule) for row in chromosomes]


def draw_table(random, rows, cols):
    table = random.integers(0, 65537, (rows, cols)).astype(np.int32)
    table[random.random((rows, cols)) < 0.1] = OBSTACLE
    return table


@given(
    weights(),
    st.integers(0, 2**32 - 1),
    st.integers(1, 40),
    st.integers(3, 9),
    st.sampled_from([0, 3, 60, 1000, COORDINATE_LIMIT]),
    st.sampled_from(range(3)),
    st.booleans(),
)
def test_small_maps_and_genes_far_outside(values, seed, count, k, beyond, rule, per_span):
    table = GridMap("random", values).table
    random = np.random.default_rng(seed)
    chromosomes = random.integers(-beyond, 25 + beyond, (count, 2 * k)).astype(np.int32)
    chromosomes = chromosomes.clip(-COORDINATE_LIMIT, COORDINATE_LIMIT)
    ours, expected = both(table, chromosomes, basis(k, 5, per_span), rule)
    assert ours == expected


@pytest.mark.parametrize(("rows", "cols"), [(50, 100), (500, 1000), (4000, 4000), (3, 4000)])
@pytest.mark.parametrize("rule", range(len(RULES)))
@pytest.mark.parametrize("beyond", [0, 0.3])
def test_large_maps(rows, cols, rule, beyond):
    random = np.random.default_rng(rows)
    table = draw_table(random, rows, cols)
    chromosomes = np.empty((60, 10), dtype=np.int32)
    for axis, side in enumerate((cols, rows)):
        low, high = int(-beyond * side), int((1 + beyond) * side)
        chromosomes[:, axis::2] = random.integers(low, high, (60, 5))
    ours, expected = both(table, chromosomes, basis(5, 5, False), rule)
    assert ours == expected


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1))
def test_long_lines_of_every_slope(seed):
    """The steepest test of the arithmetic: lines across a wide map, way points at its border."""
    random = np.random.default_rng(seed)
    table = draw_table(random, 300, 60_000)
    chromosomes = np.empty((8, 6), dtype=np.int32)
    chromosomes[:, 0::2] = random.choice([0, 1, 29_999, 59_998, 59_999], (8, 3))
    chromosomes[:, 1::2] = random.choice([0, 1, 149, 150, 299], (8, 3))
    ours, expected = both(table, chromosomes, basis(3, 3, False), 0)
    assert ours == expected


def test_the_heaviest_fields_do_not_carry_into_the_obstacles():
    """A weight just below 1 rounds up to 65536 units; so many at a time still fit 24 bits."""
    table = np.full((2, 4 * MOST_FIELDS), 65536, dtype=np.int32)
    chromosome = np.array([[0, 0, 500, 0, 4 * MOST_FIELDS - 1, 1]], dtype=np.int32)
    ours, expected = both(table, chromosome, basis(3, 2, False), 0)
    assert ours == expected == [4 * MOST_FIELDS * 65536]
