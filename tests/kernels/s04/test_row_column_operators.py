"""Each operator of S04's algorithm alone, for its definition."""

from collections import Counter
from types import SimpleNamespace

import naive
import naive_row_column as twin
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from row_column_strategies import GENOTYPES, as_rows, draw_chromosomes

from gapath.kernels.rng import fill, probability_threshold, stream
from gapath.kernels.s04.evolution import CERTAIN
from gapath.kernels.s04.genotype import Chromosomes, Genotype, empty_chromosomes
from gapath.kernels.s04.operators import RUN, Parents, cross, holder, mutate, pair, rank

NEVER = np.uint64(0)


def words(shape, seed=0):
    drawn = np.empty(shape, dtype=np.uint64)
    fill(stream(seed), drawn.reshape(-1))
    return drawn


def ranked(values):
    values = np.array(values, dtype=np.float64)
    order, spare = np.empty((2, len(values)), dtype=np.int64)
    rank(values, order, spare)
    return order.tolist()


@given(st.lists(st.sampled_from([0.0, 0.1, 1e-9, 50.0, 100.0]), min_size=1, max_size=100))
def test_rank_sorts_by_fitness_then_index(values):
    assert ranked(values) == sorted(range(len(values)), key=lambda i: (-values[i], i))


@pytest.mark.parametrize("size", [1, RUN, RUN + 1, 2 * RUN, 2 * RUN + 1, 1000, 65535])
def test_rank_sorts_populations_of_every_size(size):
    for values in (np.zeros(size), np.arange(size), np.random.default_rng(size).random(size)):
        assert ranked(values) == np.argsort(-values, kind="stable").tolist()


@pytest.mark.parametrize("size", [1, 2, 3, 10, 101])
def test_the_fittest_holds_as_many_tickets_as_there_are_individuals(size):
    order = np.random.default_rng(size).permutation(size)
    tickets = size * (size + 1) // 2
    held = Counter(holder(ticket, order) for ticket in range(tickets))
    assert held == {individual: size - place for place, individual in enumerate(order.tolist())}
    assert [holder(ticket, order) for ticket in range(tickets)] == twin.tickets(order.tolist())


def test_tickets_of_the_largest_population_end_where_they_should():
    """The first and the last ticket of everyone, where a root that is rounded could slip."""
    size = 65535
    order = np.arange(size)
    for last_but in range(size):
        first = last_but * (last_but + 1) // 2
        for ticket in (first, first + last_but):
            assert holder(ticket, order) == size - 1 - last_but


def paired(order, n, threshold, drawn):
    size = len(order)
    parents = Parents(*np.full((3, size), -1, dtype=np.int32))
    pair(np.array(order), n, np.uint64(threshold), drawn, parents)
    return parents


@pytest.mark.parametrize("size", [2, 3, 4, 7, 20])
def test_after_the_elite_come_two_complementary_children_a_pair(size):
    order = np.random.default_rng(size).permutation(size).tolist()
    hat, drawn = twin.tickets(order), words((2, size // 2), size)
    head, tail, cut = paired(order, 9, CERTAIN, drawn)
    assert (head[0], tail[0], cut[0]) == (order[0], order[0], 9)
    for k, (which, where) in enumerate(drawn.T.tolist()):
        a, b = hat[naive.high(which, len(hat))], hat[naive.low(which, len(hat))]
        place = 1 + naive.low(where, 8)
        expected = [(a, b, place), (b, a, place)]
        first = 2 * k + 1
        found = zip(*(part[first : first + 2].tolist() for part in (head, tail, cut)), strict=True)
        assert list(found) == expected[: size - first]


def test_every_place_is_cut_and_none_beyond():
    cut = paired(range(2001), 9, CERTAIN, words((2, 1000))).cut[1:]
    assert Counter(cut.tolist()).keys() == set(range(1, 9))


def test_who_does_not_cross_is_copied():
    assert (paired(range(20), 9, NEVER, words((2, 10))).cut == 9).all()
    half = paired(range(20_001), 9, probability_threshold(0.5), words((2, 10_000))).cut[1::2]
    assert (half < 9).mean() == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("n", [1, 2])
def test_few_genes_have_few_places_to_cut(n):
    assert (paired(range(9), n, CERTAIN, words((2, 4))).cut[1:] == 1).all()


def test_parents_are_drawn_by_rank():
    size, order = 4, [2, 0, 3, 1]
    drawn = words((2, 50_000))
    head = np.concatenate(
        [paired(order, 5, NEVER, drawn[:, i : i + 2]).head[1:] for i in range(0, 50_000, 2)]
    )
    for place, individual in enumerate(order):
        assert (head == individual).mean() == pytest.approx((size - place) / 10, abs=0.01)


@given(st.integers(1, 7), st.integers(2, 9), st.data())
def test_crossover_cuts_locations_and_directions_only(n, size, data):
    population = draw_chromosomes(np.random.default_rng(n * size), size, n)
    who = st.integers(0, size - 1)
    chosen = data.draw(st.lists(st.tuples(who, who, st.integers(1, n)), min_size=1, max_size=6))
    children = empty_chromosomes(len(chosen), n)
    cross(population, Parents(*np.array(chosen, dtype=np.int32).T.copy()), children)
    parents = [twin.Chromosome.of(row) for row in as_rows(population)]
    expected = [twin.crossed(parents[a], parents[b], cut).row for a, b, cut in chosen]
    assert as_rows(children).tolist() == expected


def test_crossover_by_hand():
    population = Chromosomes(
        np.array([0, 1], dtype=np.int32),
        np.array([[0, 5], [1, 6], [2, 7], [3, 8]], dtype=np.int32),
        np.array([[0, 1], [0, 1], [0, 1]], dtype=np.int32),
        np.array([[1, 2], [3, 0]], dtype=np.int32),
    )
    children = empty_chromosomes(3, 4)
    parents = Parents(*np.array([[0, 1, 1], [1, 0, 0], [2, 2, 4]], dtype=np.int32))
    cross(population, parents, children)
    assert as_rows(children).tolist() == [
        [0, *(0, 1, 7, 8), *(0, 0, 1), *(1, 3)],
        [1, *(5, 6, 2, 3), *(1, 1, 0), *(2, 0)],
        [1, *(5, 6, 7, 8), *(1, 1, 1), *(2, 0)],
    ]


def mutated(before, genotype, threshold, first=0, seed=0):
    """The chromosomes after a mutation, and its words."""
    n, size = before.location.shape
    after = Chromosomes(*(part.copy() for part in before))
    drawn = words((n + 2, size), seed)
    mutate(after, first, Genotype(*genotype), np.uint64(threshold), drawn)
    return after, drawn


def same(a, b):
    return [bool((x == y).all()) for x, y in zip(a, b, strict=True)]


@pytest.fixture
def before():
    return draw_chromosomes(np.random.default_rng(0), 2000, 6)


def test_without_probability_nothing_mutates(before):
    assert all(same(before, mutated(before, (True, 2), NEVER)[0]))


def test_with_certainty_every_gene_is_drawn_from_its_whole_range(before):
    after, _ = mutated(before, (True, 2), CERTAIN)
    for part, values in zip(after, (2, 6, 2, 6), strict=True):
        for gene in part.reshape(-1, 2000):
            counts = np.bincount(gene, minlength=values)
            assert len(counts) == values
            assert counts == pytest.approx(2000 / values, rel=0.25)
    assert (
        abs(np.corrcoef([after.flag, *after.location, *after.direction]) - np.eye(12)).max() < 0.1
    )


@pytest.mark.parametrize("first", [1, 7, 2000])
def test_the_first_ones_are_spared(before, first):
    after, _ = mutated(before, (True, 2), CERTAIN, first)
    assert all(same(before.location[:, :first], after.location[:, :first]))
    assert (as_rows(after)[:first] == as_rows(before)[:first]).all()
    assert (as_rows(after)[first:] != as_rows(before)[first:]).any(axis=1).all()


def test_geislers_genotype_keeps_flag_and_switches(before):
    after, _ = mutated(before, GENOTYPES["geisler"], CERTAIN)
    assert same(before, after) == [True, False, False, True]


def test_hermanus_genotype_keeps_the_switches(before):
    after, _ = mutated(before, GENOTYPES["hermanu"], CERTAIN)
    assert same(before, after) == [False, False, False, True]


def test_a_genotype_of_one_switch_keeps_the_other(before):
    after, _ = mutated(before, (True, 1), CERTAIN)
    assert same(before.switch, after.switch) == [False, True]


@pytest.mark.parametrize("genotype", GENOTYPES.values(), ids=GENOTYPES)
def test_each_gene_mutates_with_its_own_chance(before, genotype):
    """A mutated gene has a new location and direction, its chromosome a new flag."""
    column_wise, switches = genotype
    after, drawn = mutated(before, genotype, probability_threshold(0.3))
    hit = (drawn >> np.uint64(32)) < probability_threshold(0.3)
    assert hit.mean() == pytest.approx(0.3, abs=0.02)
    assert not (after.location != before.location)[~hit[:6]].any()
    assert not (after.direction != before.direction)[~hit[:5]].any()
    assert (after.location != before.location)[hit[:6]].mean() == pytest.approx(5 / 6, abs=0.03)
    assert (after.direction != before.direction)[hit[:5]].mean() == pytest.approx(0.5, abs=0.03)
    assert not (after.switch != before.switch)[~hit[6:]].any()
    assert not (after.switch != before.switch)[switches:].any()
    any_gene = hit[:6].any(axis=0)
    assert not (after.flag != before.flag)[~any_gene].any()
    expected = 0.5 if column_wise else 0
    assert (after.flag != before.flag)[any_gene].mean() == pytest.approx(expected, abs=0.05)


@given(st.integers(1, 6), st.integers(2, 9), st.sampled_from([0.0, 0.2, 1.0]), st.integers(0, 99))
def test_mutation_equals_the_twin(n, size, probability, seed):
    before = draw_chromosomes(np.random.default_rng(seed), size, n)

    expected = [twin.Chromosome.of(row) for row in as_rows(before)]
    sedighi = SimpleNamespace(column_wise=True, switches=2)
    twin.mutate(expected, 1, probability, sedighi, naive.Words(seed))
    after, _ = mutated(before, (True, 2), probability_threshold(probability), 1, seed)
    assert as_rows(after).tolist() == [chromosome.row for chromosome in expected]
