"""M22's fitness by hand, and the steps of its generations one by one."""

import collections

import naive
import naive_visibility as twin
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from visibility_strategies import ga

from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.m22.evolution import INDEX_BITS, path_length, run_evolution, select
from gapath.kernels.rng import stream
from gapath.kernels.units import SCALE
from gapath.planners.visibility_ga import PROFILES
from gapath.problem import Problem

X = -1  # a line that is not free
LENGTHS = np.array(
    [
        # start, end, two keypoints, a keypoint in an obstacle
        [0, X, 5, 7, X],
        [X, 0, X, 4, X],
        [5, X, 0, 3, X],
        [7, 4, 3, 0, X],
        [X, X, X, X, X],
    ],
    dtype=np.int64,
)


@pytest.mark.parametrize(
    ("chromosome", "length"),
    [
        ([3], 7 + 4),
        ([2, 3], 5 + 3 + 4),
        ([2], -1),  # no free line from the first keypoint to the end
        ([3, 1], 7 + 4),
        ([3, 1, 4], 7 + 4),  # what follows the end does not count
        ([3, 1, 2, 0], 7 + 4),
        ([0, 0, 3], 7 + 4),  # standing still costs nothing
        ([3, 3, 3], 7 + 4),
        ([2, 0, 3], 5 + 5 + 7 + 4),  # back to the start is allowed
        ([1], -1),  # the straight line is blocked
        ([3, 4], -1),  # a keypoint in an obstacle
        ([4, 4], -1),
        ([3, 2], -1),
    ],
)
def test_lengths_of_turns_by_hand(chromosome, length):
    assert path_length(LENGTHS, np.array(chromosome, dtype=np.int32), False) == length


@pytest.mark.parametrize(
    ("chromosome", "length"),
    [
        ([0, 3, 1], 7 + 4),
        ([0, 2, 3, 1], 12),
        ([0, 3, 1, 4, 2], 7 + 4),  # eq. (6): the end comes early
        ([0, 0, 3, 3, 1, 1], 7 + 4),
        ([3, 1, 0], -1),  # eq. (8): it does not begin at the start
        ([2, 0, 3, 1], -1),
        ([0, 2, 3], -1),  # it never reaches the end
        ([0, 0, 0], -1),
        ([0, 2, 1], -1),  # a blocked line
        ([0, 1], -1),
        ([1, 1], -1),
        ([0], -1),
    ],
)
def test_lengths_with_the_ends_as_genes_by_hand(chromosome, length):
    assert path_length(LENGTHS, np.array(chromosome, dtype=np.int32), True) == length


def random_lengths(random, n, density):
    """Lengths of free lines between any n points; some points have none, not even to themselves."""
    lengths = random.integers(1, 300, (n, n)) * SCALE // 7
    lengths = np.triu(lengths, 1) + np.triu(lengths, 1).T
    blocked = random.random((n, n)) > density
    lengths[blocked | blocked.T] = -1
    np.fill_diagonal(lengths, 0)
    inside = random.random(n) < 0.1
    lengths[inside] = lengths[:, inside] = -1
    return lengths


@given(st.integers(0, 2**32 - 1), st.integers(2, 8), st.integers(1, 6), st.booleans())
def test_lengths_equal_the_twin(seed, n, genes, ends_are_genes):
    random = np.random.default_rng(seed)
    lengths = random_lengths(random, n, 0.7)
    expected = [[None if v < 0 else v for v in row] for row in lengths.tolist()]
    for chromosome in random.integers(0, n, (50, genes)).astype(np.int32):
        chromosome[random.random(genes) < 0.2] = 1
        if random.random() < 0.5:
            chromosome[0] = 0
        found = path_length(lengths, chromosome, ends_are_genes)
        length = twin.path_length(expected, chromosome.tolist(), ends_are_genes)
        assert found == (-1 if length is None else length)


@st.composite
def planners(draw):
    """M22's planner with every version and reading, and any settings that go together."""
    values = {
        "ga2_profile": draw(st.sampled_from(PROFILES)),
        "genes": draw(st.sampled_from(["obstacles", "obstacles_and_ends"])),
        "population": draw(st.integers(4, 40)),
        "max_epochs": draw(st.sampled_from([1, 2, 12, 30])),
        "max_stagnation": draw(st.sampled_from([None, 1, 2, 5, 20])),
        "mutation_probability": draw(st.sampled_from([0.1, 0.0, 1.0, 0.5])),
        "elite_portion": draw(st.sampled_from([0.01, 0.0, 0.1, 0.3])),
        "parents_portion": draw(st.sampled_from([0.3, 0.5, 0.8])),
        "crossover_probability": draw(st.sampled_from([0.5, 0.05, 1.0, 0.9])),
    }
    try:
        return ga(**values)
    except InputError:  # too few parents, or no room for offspring
        return ga(**values | {"population": 40, "parents_portion": 0.5})


FLOOR = Problem(GridMap("floor", np.full((30, 20), 0.5)), (0, 0), (19, 29))
"""Its perimeter is 100 pixels."""


def run(lengths, planner, genes, keys):
    return run_evolution(lengths, genes, planner.kernel_settings(FLOOR, 1), stream(*keys))


def same_as_twin(planner, lengths, genes, keys):
    result = run(lengths, planner, genes, keys)
    expected = [[None if v < 0 else v for v in row] for row in lengths.tolist()]
    epochs, _ = twin.evolve(expected, planner, genes, 100 * SCALE, naive.Words(*keys))
    assert result.epochs["best"].tolist() == [epoch["best"] for epoch in epochs]
    assert result.epochs["sum"].tolist() == [epoch["sum"] for epoch in epochs]
    assert result.chromosomes.tolist() == [epoch["chromosome"] for epoch in epochs]
    return len(epochs)


@settings(max_examples=300)
@given(
    planners(),
    st.integers(2, 12),
    st.integers(1, 8),
    st.sampled_from([0.5, 0.9]),
    st.integers(0, 2**64 - 1),
    st.integers(0, 10**6),
)
def test_generations_equal_the_naive_twin(planner, n, genes, density, seed, trial):
    lengths = random_lengths(np.random.default_rng(seed), n, density)
    same_as_twin(planner, lengths, genes, (seed, trial))


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize(("reading", "genes"), [("obstacles", 6), ("obstacles_and_ends", 8)])
def test_generations_of_table_1_equal_the_naive_twin(profile, reading, genes):
    """Paths of three or more lines: it takes a while to find one, and longer for the shortest."""
    planner = ga(ga2_profile=profile, genes=reading, population=200, max_epochs=120)
    epochs = []
    for trial in range(6):
        lengths = random_lengths(np.random.default_rng(trial), 16, 0.99)
        place = np.array([0, 15, *range(1, 15)])  # along a line, the end farthest from the start
        far = np.abs(np.subtract.outer(place, place)) > 8
        lengths[far] = -1
        epochs.append(same_as_twin(planner, lengths, genes, (7, trial)))
    assert max(epochs) > 30


def test_a_place_on_the_wheel_is_as_wide_as_its_fitness_says():
    """So many spins that some balls lie just at the border of two places."""
    parents, pixels = 300_000, np.array([2, 0, 3, 3])
    settings = ga(elite_portion=0.0).kernel_settings(FLOOR, 1)
    settings["parents"] = parents
    scores = pixels * SCALE
    keys = np.sort((scores << INDEX_BITS) + np.arange(4))
    words, sums = np.empty(parents, dtype=np.uint64), np.empty(4, dtype=np.int64)
    chosen = np.empty((parents, 1), dtype=np.int32)
    chosen_scores = np.empty(parents, dtype=np.int64)
    population = np.arange(4, dtype=np.int32).reshape(4, 1)
    random = stream(0)
    select(population, scores, keys, settings[0], random, words, sums, chosen, chosen_scores)
    balls = words % np.uint64(8 * SCALE)
    wheel = np.array([1, 1, 1, 1, 0, 0, 2, 3])  # 4, 2, 1 and 1 pixels, by rank
    assert (chosen[:, 0] == wheel[balls // np.uint64(SCALE)]).all()
    assert (chosen_scores == scores[chosen[:, 0]]).all()
    assert set((balls[balls % np.uint64(SCALE) == 0] // np.uint64(SCALE)).tolist()) & {4, 6, 7}


@pytest.mark.parametrize("profile", PROFILES)
def test_it_stops_after_so_many_generations_without_a_better_path(profile):
    """Where all are alike none is better: the first one, one more than that, the last."""
    lengths = np.zeros((5, 5), dtype=np.int64)
    for patience in (1, 5, 20):
        planner = ga(ga2_profile=profile, max_stagnation=patience, max_epochs=100)
        assert len(run(lengths, planner, 3, (1, 2)).epochs) == patience + 2
    assert len(run(lengths, ga(max_stagnation=None, max_epochs=57), 3, (1, 2)).epochs) == 57
    assert len(run(lengths, ga(max_epochs=1), 3, (1, 2)).epochs) == 1


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("seed", range(20))
def test_the_elite_stays(profile, seed):
    lengths = random_lengths(np.random.default_rng(seed), 20, 0.6)
    planner = ga(ga2_profile=profile, max_epochs=80, max_stagnation=None)
    best = run(lengths, planner, 6, (seed, 0)).epochs["best"]
    assert (np.diff(best) <= 0).all()
    without = ga(ga2_profile=profile, max_epochs=80, max_stagnation=None, elite_portion=0.0)
    assert len(run(lengths, without, 6, (seed, 0)).epochs) == 80


def test_a_path_longer_than_the_perimeter_is_less_fit_than_a_broken_restriction():
    """f(P)max = 2 Ax + 2 Ay, as printed."""
    lengths = np.array([[0, 101 * SCALE], [101 * SCALE, 0]], dtype=np.int64)
    planner = ga(genes="obstacles_and_ends", max_epochs=5)
    result = run(lengths, planner, 2, (0, 0))
    assert (result.epochs["best"] == 100 * SCALE).all()


def test_without_mutation_genes_come_from_the_parents():
    """Uniform crossover: every gene of later generations was in its place in the first one."""
    lengths = random_lengths(np.random.default_rng(3), 30, 0.9)
    planner = ga(mutation_probability=0.0, population=4, parents_portion=0.5, max_stagnation=None)
    genes = run(lengths, planner, 4, (9, 9)).chromosomes
    for place in range(4):
        assert len(collections.Counter(genes[:, place].tolist())) <= 4
