"""The fitness of many chromosomes at once against the fitness of one."""

from functools import lru_cache

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import RULES, weights

from gapath.grid import GridMap
from gapath.kernels.jit import JIT
from gapath.kernels.kg18.bspline import basis
from gapath.kernels.kg18.evaluation import MOST_FIELDS, evaluate, workspace
from gapath.kernels.kg18.fitness import fitness
from gapath.kernels.kg18.lanes import ONE_BY_ONE, SIDE_BY_SIDE, chromosome_matrix
from gapath.kernels.raster import COORDINATE_LIMIT
from gapath.kernels.units import OBSTACLE

WAY = SIDE_BY_SIDE if JIT else ONE_BY_ONE


def both(table, chromosomes, splines, rule):
    count, genes = chromosomes.shape
    matrix = chromosome_matrix(count + 2, genes)
    matrix[:] = -(2**31)
    matrix[2 : count + 2, :genes] = chromosomes
    keys = np.full(count + 3, -7, dtype=np.int64)
    memory = workspace(splines)
    for _ in range(2):  # the second time on memory that is used
        evaluate(WAY, table, matrix, 2, count + 2, splines, rule, keys, memory)
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
    st.integers(3, 32),
    st.integers(2, 9),
    st.sampled_from([0, 3, 60, 1000, COORDINATE_LIMIT]),
    st.sampled_from(range(len(RULES))),
    st.booleans(),
)
def test_small_maps_and_genes_far_outside(values, seed, count, k, w, beyond, rule, per_span):
    table = GridMap("random", values).table
    random = np.random.default_rng(seed)
    chromosomes = random.integers(-beyond, 25 + beyond, (count, 2 * k)).astype(np.int32)
    chromosomes = chromosomes.clip(-COORDINATE_LIMIT, COORDINATE_LIMIT)
    chromosomes = chromosomes[: 3 if beyond == COORDINATE_LIMIT else count]  # a second otherwise
    ours, expected = both(table, chromosomes, basis(k, w, per_span), rule)
    assert ours == expected


@lru_cache
def large_table(rows, cols):
    return draw_table(np.random.default_rng(rows), rows, cols)


@settings(max_examples=150)
@given(
    st.sampled_from([(50, 100), (500, 1000), (4000, 4000), (3, 4000)]),
    st.integers(0, 2**32 - 1),
    st.integers(3, 12),
    st.integers(2, 64),
    st.sampled_from([0.0, 0.3, 1.0, None]),
    st.sampled_from(range(len(RULES))),
    st.booleans(),
)
def test_large_maps(shape, seed, k, w, beyond, rule, per_span):
    """Genes on the map, around it, and as far outside as they may lie."""
    random, count = np.random.default_rng(seed), 2 if beyond is None else 20
    chromosomes = np.empty((count, 2 * k), dtype=np.int32)
    for axis, side in enumerate(reversed(shape)):
        out = COORDINATE_LIMIT - side if beyond is None else int(beyond * side)
        chromosomes[:, axis::2] = random.integers(-out, side + out, (count, k))
    ours, expected = both(large_table(*shape), chromosomes, basis(k, w, per_span), rule)
    assert ours == expected


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.sampled_from(range(len(RULES))))
def test_long_lines_of_every_slope(seed, rule):
    """The steepest test of the arithmetic: lines across a wide map, way points at its border."""
    random = np.random.default_rng(seed)
    table = large_table(300, 60_000)
    chromosomes = np.empty((8, 6), dtype=np.int32)
    chromosomes[:, 0::2] = random.choice([0, 1, 29_999, 59_998, 59_999], (8, 3))
    chromosomes[:, 1::2] = random.choice([0, 1, 149, 150, 299], (8, 3))
    ours, expected = both(table, chromosomes, basis(3, 3, False), rule)
    assert ours == expected


def test_the_heaviest_fields_do_not_carry_into_the_obstacles():
    """A weight just below 1 rounds up to 65536 units; so many at a time still fit 24 bits."""
    table = np.full((2, 4 * MOST_FIELDS), 65536, dtype=np.int32)
    chromosome = np.array([[0, 0, 500, 0, 4 * MOST_FIELDS - 1, 1]], dtype=np.int32)
    ours, expected = both(table, chromosome, basis(3, 2, False), 0)
    assert ours == expected == [4 * MOST_FIELDS * 65536]
