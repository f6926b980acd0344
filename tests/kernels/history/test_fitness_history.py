"""The paper's numbers of each epoch, by hand and by eq. (5)."""

from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gapath.kernels.history.epochs import EPOCHS, fitness_history
from gapath.kernels.lines import KEY_BITS

NUMBER = st.integers(0, 1000)


def test_an_epoch_by_hand():
    history = np.array([((2 << KEY_BITS) + 96, 10, 160)], dtype=EPOCHS)
    best, mean = fitness_history(history, 4, 100.0, 64)
    assert (best.tolist(), mean.tolist()) == ([201.5], [250.625])


@given(st.lists(st.tuples(NUMBER, NUMBER, NUMBER, NUMBER), max_size=5), st.integers(1, 9))
def test_numbers_are_those_of_the_equation(epochs, population):
    rows = [((obstacles << KEY_BITS) + cost, o, c) for obstacles, cost, o, c in epochs]
    best, mean = fitness_history(np.array(rows, dtype=EPOCHS), population, 500.0, 64)
    assert best.tolist() == [500 * obstacles + cost / 64 for obstacles, cost, _, _ in epochs]
    exact = [(500 * o + Fraction(c, 64)) / population for _, _, o, c in epochs]
    assert mean.tolist() == [float(number) for number in exact]
