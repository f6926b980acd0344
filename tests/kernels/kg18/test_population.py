"""Each operator of KG18's algorithm alone, for its definition."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.kernels.jit import JIT
from gapath.kernels.kg18.lanes import GENES, ONE_BY_ONE, SIDE_BY_SIDE, width
from gapath.kernels.kg18.population import (
    InitialPopulation,
    Mixing,
    gene_limits,
    initial_changes,
    initialise,
    rank_best,
    vary,
)
from gapath.kernels.lines import Ends
from gapath.kernels.raster import COORDINATE_LIMIT
from gapath.kernels.rng import fill, probability_threshold, stream

WAYS = (SIDE_BY_SIDE, ONE_BY_ONE) if JIT else (ONE_BY_ONE,)
ROWS, COLS = 50, 100
ENDS = Ends(10, 24, 90, 30)
EVEN = Mixing(0.8, 0.2, 0.5 + 0.25 / 5)


def limits(genes, clip_to_map=False):
    found = np.empty((2, width(genes)), dtype=np.int32)
    gene_limits(found, ENDS, genes, ROWS, COLS, clip_to_map)
    return found


def words(n, seed=0):
    drawn = np.zeros(n + GENES, dtype=np.uint64)
    fill(stream(seed), drawn[:n])
    return drawn


def initial(size=300, k=5, jitter=0.5, margin=4):
    population = np.full((size + 1, width(2 * k)), -7, dtype=np.int32)
    middle = np.empty((3, width(2 * k)), dtype=np.int32)
    changes = np.empty((3, 2, width(2 * k)), dtype=np.int32)
    ranges = InitialPopulation(12, 7, margin)
    initial_changes(middle, changes, ENDS, 2 * k, ROWS, COLS, ranges)
    threshold, drawn = probability_threshold(jitter), words(size * (2 * k - 4))
    initialise(WAYS[0], population, size, limits(2 * k), middle, changes, threshold, drawn)
    assert (population[size] == -7).all()
    return population[:size, 2 : 2 * k - 2].reshape(size, k - 2, 2)


def test_the_first_third_is_the_straight_line_jittered():
    """Start (10, 24), target (90, 30), k = 5: quarters of (80, 6), rounded half up."""
    line = np.array([(30, 26), (50, 27), (70, 29)])
    change = initial()[:100] - line
    assert np.abs(change).max() == 12
    assert 0.4 < (change != 0).mean() < 0.55  # half of them, a 25th of which by 0
    assert (initial(jitter=0.0)[:100] == line).all()


def test_the_second_third_lies_around_the_start():
    offset = initial()[100:200] - (10, 24)
    assert offset.min() == -7
    assert offset.max() == 7


def test_the_last_third_lies_all_over_the_map_but_for_its_margin():
    points = initial(3000)[2000:]
    assert points.reshape(-1, 2).min(axis=0).tolist() == [4, 4]
    assert points.reshape(-1, 2).max(axis=0).tolist() == [COLS - 5, ROWS - 5]


def test_a_margin_leaves_the_middle_of_the_map_at_least():
    """Of an even number of fields two."""
    points = initial(3000, margin=30)[2000:]
    assert points.reshape(-1, 2).min(axis=0).tolist() == [30, 24]
    assert points.reshape(-1, 2).max(axis=0).tolist() == [COLS - 31, 25]


@given(st.lists(st.integers(0, 9), min_size=4, max_size=60), st.data())
def test_rank_selection_is_a_stable_sort(keys, data):
    best = np.empty(data.draw(st.integers(1, len(keys))), dtype=np.int64)
    rank_best(np.array(keys, dtype=np.int64), best)
    assert best.tolist() == np.argsort(keys, kind="stable")[: len(best)].tolist()


def test_start_and_target_have_no_choice():
    least, greatest = limits(8, clip_to_map=True)[:, :8]
    assert least.tolist() == [10, 24, 0, 0, 0, 0, 90, 30]
    assert greatest.tolist() == [10, 24, 99, 49, 99, 49, 90, 30]
    least, greatest = limits(8)[:, :8]
    assert (least[2:6] == -COORDINATE_LIMIT).all()
    assert (greatest[2:6] == COORDINATE_LIMIT).all()


@pytest.fixture(params=WAYS)
def way(request):
    return request.param


def children(way, parents, genes, mixing=EVEN, probability=0.0, half=0, clip=False, seed=0):
    """Breed one child of the first two rows for each other row."""
    parents = np.array(parents, dtype=np.int32)
    matrix = np.zeros((2, width(genes)), dtype=np.int32)
    matrix[:, :genes] = parents
    found = np.full((1, width(genes)), -7, dtype=np.int32)
    changes = np.empty((2, width(genes)), dtype=np.int32)
    changes[0], changes[1] = 2 * half + 1, half
    threshold = probability_threshold(probability)
    drawn = words(genes - 4, seed)
    box = limits(genes, clip)
    vary(way, matrix, 0, 1, mixing, drawn, 0, 0, threshold, changes, box, found, 0, genes)
    if way is ONE_BY_ONE:  # lanes may reach beyond, to what limits give no choice or nobody reads
        assert (found[0, [0, 1, *range(genes - 2, found.shape[1])]] == -7).all()
    return found[0, 2 : genes - 2]


@pytest.mark.parametrize(
    ("fitter", "other", "child"),
    [(10, 20, 12), (20, 10, 18), (0, 1, 0), (0, 2, 0), (0, 3, 1), (-1, 1, -1), (-10, 7, -7)],
)
def test_crossover_by_hand(way, fitter, other, child):
    """0.8 of the fitter parent and 0.2 of the other, rounded to the nearest: eq. (6)."""
    found = children(way, [[fitter] * 8, [other] * 8], 8)
    assert found.tolist() == [child] * 4


def test_mutation_changes_inner_genes_by_at_most_half_the_smaller_side(way):
    same = [[50, 25] * 16] * 2
    change = np.array(
        [children(way, same, 32, probability=0.4, half=25, seed=s) for s in range(600)]
    ) - ([50, 25] * 14)
    assert (change.min(), change.max()) == (-25, 25)
    assert (change != 0).mean() == pytest.approx(0.4 * 50 / 51, abs=0.015)
    assert change.mean() == pytest.approx(0, abs=0.3)


def test_clipping_moves_genes_to_the_border(way):
    ends = [[99, 49] * 4] * 2
    for seed in range(50):
        found = children(way, ends, 8, probability=1.0, half=25, clip=True, seed=seed)
        assert (found[0::2] < COLS).all() and (found[1::2] < ROWS).all()


@given(
    st.integers(3, 32),
    st.tuples(st.integers(0, 10**6), st.integers(1, 10**6)).filter(lambda f: f[0] <= f[1]),
    st.floats(0, 1),
    st.booleans(),
    st.sampled_from([1, 50, COORDINATE_LIMIT]),
    st.integers(0, 2**32 - 1),
)
def test_many_genes_at_once_are_as_one_by_one(k, fraction, probability, upper, far, seed):
    random = np.random.default_rng(seed)
    columns, genes = width(2 * k), 2 * k
    parents = random.integers(-far, far + 1, (4, columns)).astype(np.int32)
    changes = random.integers(0, 2**17, (2, columns)).astype(np.int32)
    changes[0] += 1
    box = np.sort(random.integers(-far, far + 1, (2, columns)).astype(np.int32), axis=0)
    drawn = random.integers(0, 2**64, genes + GENES, dtype=np.uint64)
    numerator, denominator = fraction
    mixing = Mixing(
        numerator / denominator,
        (denominator - numerator) / denominator,
        0.5 + 0.25 / denominator,
    )
    threshold = probability_threshold(probability)
    found = []
    for way in WAYS:
        made = np.full((3, columns), -7, dtype=np.int32)
        given = drawn, 2, 32 * upper, threshold, changes, box, made, 1, genes
        vary(way, parents, 1, 3, mixing, *given)
        assert (made[0] == -7).all() and (made[2] == -7).all()
        assert (made[1, :2] == -7).all()
        found.append(made[1, 2 : genes - 2].tolist())
    assert found[0] == found[-1]
