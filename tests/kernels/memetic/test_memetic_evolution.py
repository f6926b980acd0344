"""The memetic algorithm: what it tells adds up, and no individual ever becomes dearer."""

import itertools
from itertools import pairwise
from typing import NamedTuple

import naive
import naive_memetic as slow
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from naive_memetic import packed, places, unpacked, vertices, walled_problems

from gapath.grid import GridMap
from gapath.kernels.jit import kernel
from gapath.kernels.memetic import evolution
from gapath.kernels.memetic.account import (
    BEST,
    CHANGES,
    CROSSOVER,
    CROWDED,
    EPOCHS,
    EVALUATIONS,
    INDIVIDUAL,
    LOOPS,
    LOWER,
    NEWCOMER,
    NUMBERS,
    OPERATORS,
    POINTS,
    SHARES,
    STATUS,
    UNEVEN,
    UNIT,
    VERTICES,
    WALLS,
)
from gapath.kernels.memetic.evolution import evolve
from gapath.kernels.memetic.population import (
    END,
    EPOCH,
    GAIN,
    OPERATOR,
    ROW,
    TOTAL,
    individuals,
    put,
)
from gapath.kernels.memetic.rerouting import Room
from gapath.kernels.memetic.walls import BOTH, LEFT, NO_WAY, RIGHT
from gapath.kernels.rng import fill, probability_threshold, stream
from gapath.problem import CornerCutting


class Told(NamedTuple):
    """What `evolve` told."""

    numbers: list
    changes: list
    polygons: list
    path: list


def evolved(problem, population=3, hands=BOTH, effort=4.0, tolerance=0.0, chances=(0.3, 0.5),
            seed=0, known=(), ask=False):  # fmt: skip
    settings = [population, hands, round(effort * UNIT), round(tolerance * UNIT)]
    settings += [int(probability_threshold(chance)) for chance in chances] + [int(ask)]
    way = packed(known)
    told, path = evolve(
        problem.map.table, *problem.start, *problem.target, int(problem.corner_cutting),
        problem.map.least_weight(problem.start, problem.target), np.array(settings), way,
        stream(seed),
    )  # fmt: skip
    assert unpacked(way) == list(known)
    numbers = told[:NUMBERS].tolist()
    changes = told[NUMBERS : NUMBERS + 6 * numbers[CHANGES]].reshape(-1, 6).tolist()
    rest = unpacked(told[NUMBERS + 6 * numbers[CHANGES] :])
    assert len(rest) == numbers[POINTS]
    ends = [0, *(change[END] for change in changes)]
    polygons = [rest[a:b] for a, b in pairwise(ends)]
    return Told(numbers, changes, polygons, places(path.reshape(-1, 2)))


SETTINGS = st.fixed_dictionaries(
    {
        "population": st.integers(1, 8),
        "hands": st.sampled_from([LEFT, RIGHT, BOTH]),
        "effort": st.sampled_from([0.0, 0.5, 3.0, 30.0]),
        "tolerance": st.sampled_from([0.0, 0.05, 1.0]),
        "chances": st.sampled_from([(0.0, 0.0), (0.1, 0.5), (1.0, 0.5), (0.0, 1.0)]),
        "seed": st.integers(0, 999),
    }
)


@given(walled_problems(), SETTINGS)
def test_what_it_tells_adds_up(problem, settings):
    weights, name = problem.map.weights, problem.corner_cutting.name.lower()
    told = evolved(problem, **settings)
    numbers, changes = told.numbers, told.changes
    optimum = naive.shortest_cost(weights, problem.start, problem.target, name)
    if optimum == np.inf:
        assert (numbers[STATUS], changes, told.path) == (NO_WAY, [], [])
        return
    optimum = round(optimum * 65536) - slow.weight(weights, problem.start)
    assert numbers[STATUS] > 0
    assert numbers[LOWER] <= optimum <= numbers[BEST]

    standing, polygons = {}, {}
    for number, (change, points) in enumerate(zip(changes, told.polygons, strict=True)):
        row, gain, total = change[ROW], change[GAIN], change[TOTAL]
        assert (points[0], points[-1]) == (problem.start, problem.target)
        assert total == sum(slow.ray_costs(weights, points, name))
        if change[EPOCH] == 1:
            assert (gain, change[OPERATOR]) == (0, NEWCOMER if number else WALLS)
            assert row == len(standing) or total < standing[row]
        else:
            operator = change[OPERATOR]
            assert gain == standing[row] - total and (operator >= CROSSOVER or operator == LOOPS)
            simpler = operator >= VERTICES and len(points) < len(polygons[row])
            assert gain > 0 or (gain == 0 and (simpler or operator == LOOPS))
        standing[row], polygons[row] = total, points
    epochs = [change[EPOCH] for change in changes]
    assert epochs == sorted(epochs) and epochs[-1] <= numbers[EPOCHS]
    assert list(standing) == list(range(len(standing))) and len(standing) <= settings["population"]
    assert numbers[BEST] == min(standing.values()) == standing[numbers[INDIVIDUAL]]
    assert told.path == slow.fields(weights, polygons[numbers[INDIVIDUAL]], name)
    assert numbers[EVALUATIONS] >= max(len(changes), numbers[EPOCHS])

    shares = numbers[SHARES:]
    assert len(shares) == OPERATORS and min(shares) >= 0
    assert shares[WALLS] - sum(shares[WALLS + 1 :]) == numbers[BEST]


@given(walled_problems(), SETTINGS)
def test_the_same_stream_gives_the_same_to_the_last_bit(problem, settings):
    assert evolved(problem, **settings) == evolved(problem, **settings)


@given(slow.paths(most=12), st.sampled_from([0.0, 4.0]))
def test_a_known_path_is_the_first(drawn, effort):
    problem, known = drawn
    problem = slow.Problem(problem.map, problem.start, known[-1], problem.corner_cutting)
    told = evolved(problem, effort=effort, known=known)
    if told.numbers[STATUS] != 2:  # the straight line needs no path
        assert told.numbers[STATUS] == len(known)
        assert told.numbers[SHARES + WALLS] == slow.cost(problem.map.weights, known)
    assert told.numbers[BEST] <= slow.cost(problem.map.weights, known)


@given(walled_problems(most=30), st.integers(0, 99))
def test_who_asks_is_told_of_a_first_path_alone_or_the_same(problem, seed):
    asked, told = (evolved(problem, seed=seed, ask=ask) for ask in (True, False))
    if asked.numbers[STATUS] in (UNEVEN, CROWDED):
        assert told.numbers[STATUS] > 0
        assert asked[1:] == ([], [], [])
    else:
        assert asked == told
    if told.numbers[STATUS] > 2 and asked.numbers[STATUS] != CROWDED:
        least = problem.map.least_weight(problem.start, problem.target)
        evenly = (told.numbers[STATUS] - 2) * least
        evenly += slow.weight(problem.map.weights, problem.target)
        assert (asked.numbers[STATUS] == UNEVEN) == (told.numbers[SHARES + WALLS] > evenly)


def clutter(number):
    """Obstacles to be passed on either side, on hills."""
    random = np.random.default_rng(number)
    y, x = np.mgrid[:60, :90]
    weights = (abs(x % 28 - 14) + abs(y % 20 - 10) + 2) / 64
    for left, top in random.integers(4, 82, (60, 2)):
        weights[top % 56 : top % 56 + 5, left : left + 3] = 1.0
    weights[28:33, :3] = weights[28:33, -3:] = 0.5
    return slow.Problem(GridMap("clutter", weights), (1, 30), (88, 30))


def test_without_effort_there_is_one_individual_and_one_evaluation():
    numbers, changes, _, _ = evolved(clutter(0), effort=0.0)
    assert (numbers[EVALUATIONS], numbers[EPOCHS], len(changes)) == (1, 1, 1)


def gained(told):
    return {change[OPERATOR] for change in told.changes}


@pytest.mark.parametrize(("population", "maps"), [(1, 24), (4, 20)])
def test_all_operators_gain_and_with_one_individual_nothing_is_crossed(population, maps):
    told = [evolved(clutter(i), population, effort=60.0, seed=i) for i in range(maps)]
    everything = {WALLS, *range(NEWCOMER, OPERATORS)}
    if population == 1:
        everything -= {NEWCOMER, CROSSOVER}
    assert set().union(*map(gained, told)) == everything


@pytest.mark.parametrize(("chance", "crosses"), [(0.0, False), (1e-9, True)])
def test_each_pair_is_crossed_though_chance_hardly_has_it_but_not_where_it_never_does(
    chance, crosses
):
    told = [evolved(clutter(i), 4, effort=30.0, chances=(chance, 0.0), seed=i) for i in range(6)]
    assert any(CROSSOVER in gained(each) for each in told) == crosses


@kernel
def crossover(table, row, other, rule, lower, members, room):
    return evolution.crossover(table, row, other, rule, lower, members, room)


@kernel
def pairs(n, words, turns, draws):
    for k in range(len(turns)):
        turns[k, 0], turns[k, 1] = evolution.pair(k, n)
    for k in range(len(draws)):
        draws[k, 0], draws[k, 1] = evolution.drawn_pair(words[k], n)


@pytest.mark.parametrize("n", range(2, 9))
def test_pairs_in_turn_and_by_chance(n):
    """In turn all unordered ones; by chance an individual, and any other one."""
    in_turn = list(itertools.combinations(range(n), 2))
    words = np.empty(900, dtype=np.uint64)
    fill(stream(n), words)
    words = words.reshape(300, 3)
    turns, draws = (np.empty((k, 2), dtype=np.int64) for k in (len(in_turn), len(words)))
    pairs(n, words, turns, draws)
    assert places(turns) == in_turn
    assert set(places(draws)) == set(itertools.permutations(range(n), 2))
    for (one, other), (_, a, b) in zip(places(draws), words.tolist(), strict=True):
        rest = [k for k in range(n) if k != one]
        assert (one, other) == (naive.high(a, n), rest[naive.high(b, n - 1)])


@given(slow.two_polygons())
def test_a_child_takes_the_cheaper_ones_place_if_it_is_cheaper_still(drawn):
    problem, *both = drawn
    weights, name = problem.map.weights, problem.corner_cutting.name.lower()
    costs = [slow.ray_costs(weights, points, name) for points in both]
    paths = [slow.fields(weights, points, name) for points in both]
    for order in ([0, 1], [1, 0]):
        members, totals = individuals(3, 1), [sum(costs[k]) for k in order]
        for row, k in enumerate(order):
            paid = np.array([*costs[k], 0])
            members = put(members, row, vertices(both[k]), paid, len(both[k]), sum(costs[k]))
        room = Room(
            np.full(problem.map.table.size, 1, dtype=np.int32),
            *(np.full(1, 7, dtype=np.uint32) for _ in range(3)),
        )
        row, gain, _, members, _ = crossover(
            problem.map.table, 0, 1, int(problem.corner_cutting), np.int64(0), members, room
        )
        assert row == int(totals[1] < totals[0])
        kept = both[order[1 - row]]
        size = members.sizes[1 - row]
        assert places(members.points[1 - row, :size]) == kept
        assert members.totals[1 - row] == totals[1 - row]
        assert members.totals[row] == totals[row] - max(gain, 0)
        found = places(members.points[row, : members.sizes[row]])
        assert sum(slow.ray_costs(weights, found, name)) == members.totals[row]
        child = slow.cross(weights, paths[order[row]], paths[order[1 - row]])[0]
        assert (gain > 0) == (slow.cost(weights, child) < totals[row])
        assert members.totals[row] <= slow.cost(weights, child)


def test_it_stops_at_a_path_that_is_good_enough():
    even = GridMap("even", np.where(clutter(0).map.obstacles, 1.0, 0.5))
    problem = slow.Problem(even, (1, 30), (88, 30), CornerCutting.NO_DIAGONALS)
    patient, hasty = (evolved(problem, tolerance=t).numbers for t in (0.0, 1.0))
    assert hasty[LOWER] < patient[BEST] < hasty[BEST] <= 2 * hasty[LOWER]
    assert hasty[EVALUATIONS] == 1 < patient[EVALUATIONS]
