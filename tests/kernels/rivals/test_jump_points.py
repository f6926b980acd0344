"""Jump point search against A*, a slow twin, and the definition of what it leaves out."""

import itertools

import naive_jumps
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import RULES, problems

from gapath.components import build
from gapath.discovery import yaml_values
from gapath.grid import GridMap
from gapath.kernels.graph_search import DIAGONAL, NO_PATH, STRAIGHT
from gapath.kernels.rivals.bits import COLUMNS, ROWS, make_tile, no_tiles
from gapath.kernels.rivals.jump_points import jump_search
from gapath.kernels.rivals.jumps import worth_after
from gapath.kernels.rng import stream
from gapath.planning.flaw import flaw
from gapath.planning.path import octile_length
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Problem

LENGTHS = {"weights": (1, 1), "length": (STRAIGHT, DIAGONAL)}


def jps(minimise="weights"):
    return build("planner", yaml_values("planner", "jps") | {"minimise": minimise}, "planner")


@st.composite
def even_problems(draw, most=24, least=1):
    """Obstacles on an even floor, which start and target need not be part of."""
    drawn = draw(problems(most, least))
    weights = np.where(drawn.map.obstacles, 1.0, draw(st.sampled_from([0.0, 0.3, 0.5])))
    for x, y in (drawn.start, drawn.target):
        weights[y, x] = draw(st.sampled_from([0.0, 0.5, 0.75]))
    return Problem(GridMap("even", weights), drawn.start, drawn.target, drawn.corner_cutting)


@pytest.mark.parametrize("least", [1, 60])
@given(data=st.data())
def test_costs_equal_astar(least, data):
    """Small maps, and those larger than a tile of bits."""
    problem = data.draw(even_problems(24 if least == 1 else 150, least))
    plan, best = jps().plan(problem, stream(0)), shortest_path(problem)
    assert (plan.status, plan.cost, len(plan.path)) == (best.status, best.cost, len(best.path))
    if best.feasible:
        assert flaw(problem, plan.path, plan.cost) is None
    plan, best = jps("length").plan(problem, stream(0)), shortest_path(problem, by_length=True)
    assert plan.status == best.status
    if best.feasible:
        assert flaw(problem, plan.path, plan.cost) is None
        assert octile_length(plan.path) == pytest.approx(octile_length(best.path), rel=1e-12)


@given(problems(most=20))
def test_by_length_the_weights_of_fields_do_not_count(problem):
    plan, best = jps("length").plan(problem, stream(0)), shortest_path(problem, by_length=True)
    assert plan.status == best.status
    if best.feasible:
        assert flaw(problem, plan.path, plan.cost) is None
        assert octile_length(plan.path) == pytest.approx(octile_length(best.path), rel=1e-12)


@pytest.mark.parametrize("lengths", LENGTHS.values(), ids=LENGTHS)
@given(problem=even_problems(most=16))
def test_it_turns_where_the_slow_twin_does(lengths, problem):
    cost, turns, expanded = naive_jumps.search(problem, *lengths)
    found, counts = np.empty(problem.map.table.size, dtype=np.int64), np.zeros(1, dtype=np.int64)
    ends, rule = (*problem.start, *problem.target), int(problem.corner_cutting)
    count = jump_search(problem.map.table, *ends, rule, *lengths, found, counts)
    assert counts[0] == expanded
    if cost is None:
        assert count == NO_PATH
    else:
        cols = problem.map.cols
        assert [(t % cols, t // cols) for t in found[:count][::-1].tolist()] == turns


def test_hundreds_of_fields_are_reached_and_wait():
    """More than there is room for at first, in the table of those reached and in the queue."""
    weights = np.where(np.random.default_rng(2).random((150, 150)) < 0.3, 1.0, 0.5)
    weights[70:80, 70:80] = 0.5
    weights[149, 149], weights[148, 148] = 0.5, 1.0
    weights[147:150, 147] = weights[147, 147:150] = 1.0
    for rule in CornerCutting:
        problem = Problem(GridMap("noise", weights), (75, 75), (149, 149), rule)
        plan = jps().plan(problem, stream(0))
        assert plan.expansions == naive_jumps.search(problem, *LENGTHS["weights"])[2]
        assert plan.status == shortest_path(problem).status


@pytest.mark.parametrize("rule", list(CornerCutting), ids=RULES)
def test_what_is_worth_a_try_is_what_no_better_way_leads_to(rule):
    """All surroundings of a field, all steps to it."""
    around = [(x, y) for y in range(3) for x in range(3) if (x, y) != (1, 1)]
    for walls in itertools.product([0.5, 1.0], repeat=8):
        weights = np.full((3, 3), 0.5)
        for (x, y), weight in zip(around, walls, strict=True):
            weights[y, x] = weight
        words, across, down = no_tiles(3, 3)
        make_tile(GridMap("around", weights).table, words, across, down, 0)
        for number, step in enumerate(naive_jumps.STEPS):
            before = (1 - step[0], 1 - step[1])
            possible = naive_jumps.may(weights, before, step, RULES[rule])
            if weights[before[::-1]] == 1 or not possible:
                continue
            if rule is CornerCutting.NO_DIAGONALS and step[0]:
                continue  # such a step ends at the target only
            bits = worth_after(words, across, 1, 1, number, int(rule))
            worth = {s for i, s in enumerate(naive_jumps.STEPS) if bits >> i & 1}
            assert worth == naive_jumps.worth(weights, (1, 1), step, RULES[rule])
            possible = {s for s in worth if naive_jumps.may(weights, (1, 1), s, RULES[rule])}
            assert possible == naive_jumps.worth_by_definition(weights, (1, 1), step, RULES[rule])


@given(st.integers(1, 140), st.integers(1, 140), st.integers(0, 2**32 - 1))
def test_bits_are_the_obstacles_and_the_border(rows, cols, seed):
    weights = np.random.default_rng(seed).choice([0.5, 1.0], (rows, cols))
    words, across, down = no_tiles(rows, cols)
    for tile in range(across * down):
        make_tile(GridMap("noise", weights).table, words, across, down, tile)
    expected = np.ones((64 * down, 64 * across), dtype=bool)
    expected[1 : rows + 1, 1 : cols + 1] = weights == 1
    for lines, fields in ((ROWS, expected), (COLUMNS, expected.T)):
        own = words[fields.size // 64 * lines :][: fields.size // 64]
        bits = np.unpackbits(own.astype("<u8").view(np.uint8), bitorder="little")
        assert (bits.reshape(fields.shape) == fields).all()
    assert (words[128 * across * down :] == 1).all()
