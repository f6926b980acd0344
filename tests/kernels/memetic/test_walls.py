"""First paths: found where a flood fill joins the ends, proved that there is none elsewhere."""

import itertools

import naive
import naive_memetic as slow
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from naive_memetic import plus, unpacked, walled_problems

from gapath.grid import GridMap
from gapath.kernels.memetic.steps import may_step, towards, wall_of, wall_step
from gapath.kernels.memetic.walls import (
    BOTH,
    GIVEN_UP,
    LEFT,
    NO_WAY,
    RIGHT,
    STRIDE,
    first_path,
    is_narrow,
)
from gapath.kernels.rng import stream
from gapath.planning.flaw import flaw
from gapath.problem import CornerCutting, Problem

UNTIRED = 1 << 40
HANDS = st.sampled_from([(LEFT, False), (RIGHT, False), (BOTH, False), (BOTH, True)])


def walked(problem, hands=BOTH, varied=False, budget=UNTIRED, seed=0, room=1):
    """What came of it, the steps, and the path."""
    count, steps, path = first_path(
        problem.map.table, *problem.start, *problem.target, int(problem.corner_cutting), hands,
        budget, varied, np.empty(room, dtype=np.uint32), stream(seed),
    )  # fmt: skip
    return count, steps, unpacked(path[: max(count, 0)])


def check_walk(problem, count, path):
    """Raise AssertionError unless it is a path where there is one, and none else."""
    rule = problem.corner_cutting.name.lower()
    if naive.shortest_cost(problem.map.weights, problem.start, problem.target, rule) == np.inf:
        assert (count, path) == (NO_WAY, [])
    else:
        assert count == len(path) > 0
        assert flaw(problem, np.array(path, dtype=np.int32)) is None


@given(walled_problems(), HANDS, st.integers(0, 100))
def test_a_path_is_found_wherever_there_is_one(problem, hands, seed):
    count, steps, path = walked(problem, *hands, seed=seed)
    check_walk(problem, count, path)
    assert walked(problem, *hands, seed=seed, room=4 * len(path) + 1) == (count, steps, path)


@given(walled_problems(), HANDS, st.integers(0, 100), st.floats(0, 1))
def test_it_gives_up_only_where_its_steps_are_spent(problem, hands, seed, share):
    count, steps, path = walked(problem, *hands, seed=seed)
    assert count != GIVEN_UP
    assert walked(problem, *hands, seed=seed, budget=steps) == (count, steps, path)
    if steps:
        fewer = int(share * (steps - 1))
        assert walked(problem, *hands, seed=seed, budget=fewer) == (GIVEN_UP, fewer, [])


SHAPES = {
    "spiral": """
        S............
        ############.
        ...........#.
        .#########.#.
        .#.......#.#.
        .#.#####.#.#.
        .#.#T....#.#.
        .#.#######.#.
        .#.........#.
        .###########.
        .............""",
    "rings": """
        S............
        .#####.#####.
        .#.........#.
        .#.#######.#.
        .#.#.....#.#.
        .#...###.#.#.
        .#.#.#T..#.#.
        .#.#.###.#.#.
        .#.#.....#.#.
        .#.#######.#.
        .#.........#.
        .###########.
        .............""",
    "comb": """
        .....#.....#...T
        .#.#.#.#.#.#.#..
        .#.#.#.#.#.#.#..
        .#.#.#.#.#.#.#..
        .#.#...#.#...#..
        S#...#...#.#.#..""",
    "pocket": """
        ................
        ..########......
        .........#......
        .........#......
        ......S..#.....T
        .........#......
        .........#......
        ##########......
        ................""",
    "border": """
        ......#......
        .####.#.####.
        ....#.#.#....
        ###.#.#.#.###
        S...#...#...T""",
}
CHAINS = {
    "diagonal": """
        S....#
        ....#.
        ...#..
        ..#...
        .#....
        #....T""",
    "diamond": """
        ....#....
        ...#.#...
        ..#...#..
        .#.....#.
        #...T...#
        .#.....#.
        ..#...#..
        ...#.#...
        S...#....""",
    "checkerboard": """
        S#.#.#.
        #.#.#.#
        .#.#.#.
        #.#.#.#
        .#.#.#T""",
}
NOWHERE = {
    "sealed": """
        S.......
        ..####..
        ..#..#..
        ..#.T#..
        ..####..
        ........""",
    "sealed by the border": """
        S.......
        ...#####
        ...#....
        .#.#....
        .#.#...T
        .#.#....
        ...#####""",
    "start in a corner": """
        S#......
        ##....#.
        ......#T""",
    "alone": """
        S#.
        ##T""",
}


def turned(text):
    """The map as drawn, mirrored, and turned by quarters; start and target both ways."""
    drawn = np.array([list(line.strip()) for line in text.strip().splitlines()])
    for one in (drawn, drawn[::-1]):
        for quarters in range(4):
            fields = np.rot90(one, quarters)
            grid = GridMap("drawn", np.where(fields == "#", 1.0, 0.5))
            ends = [tuple(np.argwhere(fields == mark)[0, ::-1].tolist()) for mark in "ST"]
            yield grid, *ends
            yield grid, *ends[::-1]


def ways(text, rule):
    """Whether a path was found, by all hands from both ends."""
    for grid, start, target in turned(text):
        problem = Problem(grid, start, target, rule)
        for hands, varied in ((LEFT, False), (RIGHT, False), (BOTH, False), (BOTH, True)):
            count, _, path = walked(problem, hands, varied)
            check_walk(problem, count, path)
            yield count > 0


@pytest.mark.parametrize("rule", list(CornerCutting), ids=lambda rule: rule.name.lower())
@pytest.mark.parametrize(
    ("shapes", "found"),
    [(SHAPES, (True, True)), (CHAINS, (True, False)), (NOWHERE, (False, False))],
    ids=["shapes", "chains", "nowhere"],
)
def test_shapes_that_lead_hands_astray(shapes, found, rule):
    """Found where corners may be cut, and where not; obstacles that touch at corners are chains."""
    for name, text in shapes.items():
        assert {*ways(text, rule)} == {found[rule is not CornerCutting.ALLOW]}, name


def paces(hands, varied, random):
    if varied:
        word = random.take()
        return STRIDE << naive.low(word, 4), STRIDE << naive.high(word, 4)
    return STRIDE * (hands != RIGHT), STRIDE * (hands != LEFT)


def followed(problem, place, step, turns):
    """Follow a wall: the steps of both hands, and where on it the path goes on, if it does."""
    table, rule, target = problem.map.table, int(problem.corner_cutting), problem.target

    def distance(place):
        return (place[0] - target[0]) ** 2 + (place[1] - target[1]) ** 2

    sides, met = (1, -1), distance(place)
    states = [(*place, wall_of(table, *place, *step, side, rule)) for side in sides]
    walks, came = ([], []), ([], [])
    count = 0
    while True:
        hand = 0 if count % sum(turns) < turns[0] else 1
        count += 1
        states[hand] = tuple(map(int, wall_step(table, *states[hand], sides[hand], rule)))
        at, walk = states[hand][:2], walks[hand]
        walk.append(at)
        if states[hand] in came[hand][:1]:
            nearest, walk = min(
                ((min([met, *map(distance, walk)]), walk) for walk in walks),
                key=lambda each: each[0],
            )
            return count, walk[: [*map(distance, walk), met].index(nearest) + 1] * (nearest < met)
        came[hand].append(states[hand])
        there = plus(at, towards(*at, *target)) if at != target else at
        if distance(at) < met and (at == target or may_step(table, *at, *there, rule)):
            return count, walk


def first_path_of_twin(problem, hands, varied, seed):
    """Count, steps and path."""
    weights, name = problem.map.weights, problem.corner_cutting.name.lower()
    path, steps, random = [problem.start], 0, naive.Words(seed)
    while True:
        line = naive.polyline([path[-1], problem.target])
        blocked, way = slow.ray(weights, path[-1], problem.target, name)
        path += way[1:]
        if not blocked:
            return len(path), steps, path
        step = tuple(np.subtract(line[blocked], path[-1]).tolist())
        count, way = followed(problem, path[-1], step, paces(hands, varied, random))
        path, steps = path + way, steps + count
        if not way:
            return NO_WAY, steps, []
        if path[-1] == problem.target:
            return len(path), steps, path


@given(walled_problems(), HANDS, st.integers(0, 100))
def test_hands_lead_where_those_of_the_slow_twin_do(problem, hands, seed):
    assert walked(problem, *hands, seed=seed) == first_path_of_twin(problem, *hands, seed)


@pytest.mark.parametrize("name", [*SHAPES, *CHAINS, *NOWHERE])
def test_hands_are_the_slow_twins_at_shapes(name):
    for grid, start, target in turned((SHAPES | CHAINS | NOWHERE)[name]):
        for rule, (hands, varied) in itertools.product(
            CornerCutting, [(LEFT, False), (BOTH, True)]
        ):
            problem = Problem(grid, start, target, rule)
            assert walked(problem, hands, varied, seed=1) == first_path_of_twin(
                problem, hands, varied, 1
            )


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.2, 0.4, 0.5, 0.6, 0.7, 1.0]))
def test_a_map_of_as_many_fields_as_are_looked_at_is_narrow_if_most_of_it_is(seed, share):
    blocked = np.random.default_rng(seed).random((16, 16)) < share
    around = np.pad(blocked, 1, constant_values=True)
    free = sum(~around[1 + y : 17 + y, 1 + x : 17 + x] for x, y in slow.STEPS)[~blocked]
    table = GridMap("noise", np.where(blocked, 1.0, 0.5)).table
    assert is_narrow(table) == (np.count_nonzero(free <= 3) > len(free) / 2)


@pytest.mark.parametrize("every", [2, 3, 4, 5, 8])
def test_corridors_of_large_maps_are_narrow_wherever_their_walls_are(every):
    """Of one field; where two fit beside each other, a field has five free neighbours."""
    y, x = np.mgrid[:80, :112]
    for first, along in itertools.product(range(every), (x, y)):
        table = GridMap("stripes", np.where(along % every == first, 1.0, 0.5)).table
        assert is_narrow(table) == (every < 3)
