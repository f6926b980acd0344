"""Hypothesis strategies for drives."""

import numpy as np
from hypothesis import strategies as st
from strategies import problems

from gapath.driving.known_map import KnownMap
from gapath.driving.navigation import Situation
from gapath.grid import GridMap
from gapath.kernels.units import OBSTACLE
from gapath.problem import CornerCutting, Problem

UNKNOWN = 0.5


@st.composite
def queries(draw, most=16):
    """A robot somewhere on a map of which it has seen a part."""
    problem = draw(problems(most))
    known = KnownMap(problem.map, problem.start, problem.target, UNKNOWN)
    x, y = st.integers(0, known.cols - 1), st.integers(0, known.rows - 1)
    for _ in range(draw(st.integers(0, 6))):
        known.look(
            problem.map.table, (draw(x), draw(y)), draw(st.integers(0, 7)), 3, draw(st.booleans())
        )
    free = np.argwhere(known.table < OBSTACLE)
    v, u = free[draw(st.integers(0, len(free) - 1))]
    place = draw(st.sampled_from([(int(u), int(v)), problem.start]))
    return problem, Situation(known, place, problem.target, problem.corner_cutting)


def random_world(seed, rule=CornerCutting.ALLOW):
    """A map of bars, pockets and single obstacles; start and target lie apart."""
    random = np.random.default_rng(seed)
    rows, cols = int(random.integers(8, 31)), int(random.integers(16, 51))
    values = np.full((rows, cols), 0.5)
    if random.random() < 0.4:
        values = random.choice([0.0, 0.25, 0.5, 0.75], (rows, cols))
    values[random.random((rows, cols)) < random.choice([0.0, 0.05, 0.2])] = 1.0
    for _ in range(random.integers(0, 9)):
        x, y = random.integers(0, cols), random.integers(0, rows)
        length = random.integers(2, 14)
        values[y : y + length, x] = 1.0
        if random.random() < 0.7:  # a corner; with a second one a pocket
            values[y, max(x - length, 0) : x + 1] = 1.0
        if random.random() < 0.5:
            values[min(y + length, rows - 1), max(x - length, 0) : x + 1] = 1.0
    left, right = random.integers(0, cols // 4), random.integers(3 * cols // 4, cols)
    start, target = (
        (int(x), int(random.integers(0, rows))) for x in random.permutation([left, right])
    )
    for x, y in (start, target):
        values[y, x] = random.choice([0.0, 0.5])
    return Problem(GridMap("random", values), start, target, rule)


def worlds(rules=(CornerCutting.ALLOW,)):
    """Worlds to drive through; some targets cannot be reached."""
    return st.builds(random_world, st.integers(0, 2**32 - 1), st.sampled_from(rules))
