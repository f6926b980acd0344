"""Coarse maps against NumPy, and fences against what they have to keep out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.grid import GridMap
from gapath.kernels.coarse import FACTOR, fence, pool
from gapath.kernels.units import OBSTACLE


def tables(seed, rows, cols, share):
    random = np.random.default_rng(seed)
    weights = random.integers(0, 64, (rows, cols)) / 64
    weights[random.random((rows, cols)) < share] = 1.0
    return GridMap("drawn", weights).table


def shape(rows, cols):
    return -(-rows // FACTOR), -(-cols // FACTOR)


@given(st.integers(0, 999), st.integers(1, 19), st.integers(1, 19), st.floats(0, 1))
def test_a_block_weighs_what_its_free_fields_do_and_more_with_obstacles(seed, rows, cols, share):
    table = tables(seed, rows, cols, share)
    coarse = np.empty(shape(rows, cols), dtype=np.int32)
    pool(table, coarse)
    for v, u in np.ndindex(coarse.shape):
        block = table[v * FACTOR : (v + 1) * FACTOR, u * FACTOR : (u + 1) * FACTOR]
        free = block[block < OBSTACLE].tolist()
        n, blocked = block.size, block.size - len(free)
        if blocked >= 0.8 * n:
            assert coarse[v, u] == OBSTACLE
        else:
            assert coarse[v, u] == sum(free) // len(free) * (n + 3 * blocked) // n


def test_a_block_with_the_dearest_fields_and_obstacles_is_no_obstacle():
    table = np.full((4, 4), OBSTACLE - 1, dtype=np.int32)
    table[0, :3] = OBSTACLE
    coarse = np.empty((1, 1), dtype=np.int32)
    pool(table, coarse)
    assert coarse[0, 0] == OBSTACLE - 1


@pytest.mark.parametrize(("rows", "cols"), [(40, 40), (37, 22), (5, 30)])
def test_a_fence_is_around_the_blocks_of_a_path_and_their_neighbours(rows, cols):
    height, width = shape(rows, cols)
    path = np.array(
        [(min(i, width - 1), min(i // 2, height - 1)) for i in range(5)], dtype=np.int32
    )
    states = np.zeros(rows * cols, dtype=np.int64)
    fence(path, rows, cols, states)
    away = np.array([
        [min(max(abs(u - x), abs(v - y)) for x, y in path.tolist()) for u in range(width)]
        for v in range(height)
    ])  # fmt: skip
    away = away.repeat(FACTOR, 0).repeat(FACTOR, 1)[:rows, :cols]
    assert (states.reshape(rows, cols) == np.where(away == 2, -1, 0)).all()
