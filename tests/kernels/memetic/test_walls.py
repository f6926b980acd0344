"""First paths: found where a flood fill joins the ends, proved that there is none elsewhere."""

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from naive_memetic import unpacked, walled_problems

from gapath.grid import GridMap
from gapath.kernels.memetic.walls import BOTH, GIVEN_UP, LEFT, NO_WAY, RIGHT, first_path
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
