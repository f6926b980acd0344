"""Each operator of KG18's algorithm alone, for its definition."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.kernels.population import (
    Ends,
    InitialPopulation,
    cross,
    gene_limits,
    initialise,
    mutate,
    rank_best,
)
from gapath.kernels.raster import COORDINATE_LIMIT
from gapath.rng import fill, probability_threshold, stream

ROWS, COLS = 50, 100
ENDS = Ends(10, 24, 90, 30)


def limits(genes, clip_to_map=False):
    found = np.empty((2, genes), dtype=np.int32)
    gene_limits(found, ENDS, genes, ROWS, COLS, clip_to_map)
    return found


def words(n, seed=0):
    drawn = np.empty(n, dtype=np.uint64)
    fill(stream(seed), drawn)
    return drawn


def initial(size=300, k=5, jitter=0.5, margin=4):
    population = np.empty((size, 2 * k), dtype=np.int32)
    settings = InitialPopulation(12, probability_threshold(jitter), 7, margin)
    drawn = words(size * (2 * k - 4))
    initialise(population, ENDS, ROWS, COLS, limits(2 * k), settings, drawn)
    return population.reshape(size, k, 2)


def test_every_individual_joins_start_and_target():
    population = initial()
    assert (population[:, 0] == (10, 24)).all()
    assert (population[:, -1] == (90, 30)).all()


def test_the_first_third_is_the_straight_line_jittered():
    """Start (10, 24), target (90, 30), k = 5: quarters of (80, 6), rounded half up."""
    line = np.array([(30, 26), (50, 27), (70, 29)])
    change = initial()[:100, 1:-1] - line
    assert np.abs(change).max() == 12
    assert 0.4 < (change != 0).mean() < 0.55  # half of them, a 25th of which by 0
    assert (initial(jitter=0.0)[:100, 1:-1] == line).all()


def test_the_second_third_lies_around_the_start():
    offset = initial()[100:200, 1:-1] - (10, 24)
    assert offset.min() == -7
    assert offset.max() == 7


def test_the_last_third_lies_all_over_the_map_but_for_its_margin():
    points = initial(3000)[2000:, 1:-1]
    assert points.reshape(-1, 2).min(axis=0).tolist() == [4, 4]
    assert points.reshape(-1, 2).max(axis=0).tolist() == [COLS - 5, ROWS - 5]


@given(st.lists(st.integers(0, 9), min_size=4, max_size=60), st.data())
def test_rank_selection_is_a_stable_sort(keys, data):
    best = np.empty(data.draw(st.integers(1, len(keys))), dtype=np.int64)
    rank_best(np.array(keys, dtype=np.int64), best)
    assert best.tolist() == np.argsort(keys, kind="stable")[: len(best)].tolist()


@pytest.mark.parametrize(
    ("fitter", "other", "child"),
    [(10, 20, 12), (20, 10, 18), (0, 1, 0), (0, 2, 0), (0, 3, 1), (-1, 1, -1), (-10, 7, -7)],
)
def test_crossover_by_hand(fitter, other, child):
    """0.8 of the fitter parent and 0.2 of the other, rounded to the nearest: eq. (6)."""
    result = np.empty(1, dtype=np.int32)
    cross(np.array([fitter], np.int32), np.array([other], np.int32), result, (4, 5))
    assert result[0] == child


def test_start_and_target_have_no_choice():
    least, greatest = limits(8, clip_to_map=True)
    assert least.tolist() == [10, 24, 0, 0, 0, 0, 90, 30]
    assert greatest.tolist() == [10, 24, 99, 49, 99, 49, 90, 30]
    least, greatest = limits(8)
    assert (least[2:6] == -COORDINATE_LIMIT).all()
    assert (greatest[2:6] == COORDINATE_LIMIT).all()


def test_mutation_changes_inner_genes_by_at_most_half_the_smaller_side():
    middle = np.array([10, 24, 50, 25, 50, 25, 90, 30], dtype=np.int32)
    child = np.tile(middle, (20_000, 1))
    drawn = words(child.size).reshape(child.shape)
    for genes, row in zip(child, drawn, strict=True):
        mutate(genes, limits(8), ROWS // 2, probability_threshold(0.4), row)
    change = child - middle
    assert not change[:, :2].any()
    assert not change[:, -2:].any()
    inner = change[:, 2:-2]
    assert (inner.min(), inner.max()) == (-25, 25)
    assert (inner != 0).mean() == pytest.approx(0.4 * 50 / 51, abs=0.01)
    assert inner.mean() == pytest.approx(0, abs=0.2)


def test_clipping_moves_genes_to_the_border():
    child = np.array([10, 24, 99, 49, 0, 0, 90, 30], dtype=np.int32)
    for seed in range(50):
        mutate(child, limits(8, True), ROWS // 2, probability_threshold(1.0), words(8, seed))
        x, y = child[2:-2:2], child[3:-2:2]
        assert (x >= 0).all() and (x < COLS).all() and (y >= 0).all() and (y < ROWS).all()
