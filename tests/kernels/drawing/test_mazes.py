"""Mazes: passage by passage against the twin, and that they are perfect."""

import naive
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy import ndimage

from gapath.kernels.drawing.mazes import carve
from gapath.kernels.rng import fill, stream

SIDES = st.integers(1, 12)


def carved(rows, cols, seed):
    words = np.empty(rows * cols - 1, dtype=np.uint64)
    fill(stream(seed), words)
    right, below = np.zeros((2, rows, cols), dtype=np.bool_)
    carve(words, right, below)
    return words, right, below


@given(SIDES, SIDES, st.integers(0, 2**32))
def test_passages_are_the_twins(rows, cols, seed):
    words, right, below = carved(rows, cols, seed)
    passages = {((y, x), (y, x + 1)) for y, x in np.argwhere(right).tolist()}
    passages |= {((y, x), (y + 1, x)) for y, x in np.argwhere(below).tolist()}
    assert passages == naive.maze(words, rows, cols)


@given(SIDES, SIDES, st.integers(0, 2**32))
def test_a_maze_is_perfect(rows, cols, seed):
    """One passage fewer than cells, all of them joined: a tree."""
    _, right, below = carved(rows, cols, seed)
    assert right.sum() + below.sum() == rows * cols - 1
    drawn = np.zeros((2 * rows, 2 * cols), dtype=np.bool_)
    drawn[::2, ::2] = True
    drawn[::2, 1::2], drawn[1::2, ::2] = right, below
    assert ndimage.label(drawn)[1] == 1
