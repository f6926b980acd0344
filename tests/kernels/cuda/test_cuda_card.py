"""The GPU's evolution on a GPU, `make test-cuda`: many runs come to what the processor's do."""

import evolving
import numpy as np
import pytest
from simulator import needs_numba_cuda
from strategies import RULES, planner

from gapath.errors import InputError
from gapath.kernels.rng import stream
from gapath.mapio.reconstructed import CLASSES, generate
from gapath.problem import CornerCutting, Problem

RUNS, DRAWN = 300, 200

pytestmark = needs_numba_cuda


@pytest.fixture
def card():
    """A GPU; without one the test is skipped, and says why."""
    from gapath.kernels.cuda.compiler import card

    try:
        found = card()
    except InputError as error:
        pytest.skip(str(error))
    if found.name == "simulator":
        pytest.skip("the simulator is no GPU")
    return found


def same(card, ga, problem, runs, seed=11):
    """Do runs on the processor, and twice on the GPU."""
    begun = np.array([stream(seed, trial) for trial in range(runs)])
    expected = evolving.processed(ga, problem, begun.copy())
    for _ in range(2):
        assert evolving.launched(card, ga, problem, begun.copy()) == expected


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize(("population", "k"), [(40, 4), (100, 4), (100, 5)])
def test_table_1_comes_to_what_the_processor_does(card, population, k, rule):
    for name in CLASSES:
        grid = generate(name, 0)
        problem = Problem(grid, grid.start, grid.target, CornerCutting[rule.upper()])
        same(card, planner(population=population, control_points=k, max_epochs=120), problem, RUNS)


def test_settings_drawn_at_random_come_to_what_the_processor_does(card):
    for seed in range(DRAWN):
        same(card, *drawn(seed), 60)


def drawn(seed):
    """Draw a planner and a problem."""
    random = np.random.default_rng(seed)
    most = int(random.choice([3, 40, 130, 300]))  # 110 x 110 fields are the most that are shared
    rows, cols = (int(side) for side in random.integers(1, most, 2))
    rule = str(random.choice(RULES))
    problem = evolving.posed(rows, cols, random.random() / 3, rule, seed)
    far = 65536 if rule == "allow" else 300  # corners are counted field by field, off the map too
    ga = planner(
        population=int(random.choice([4, 7, 30, 120])),
        control_points=int(random.integers(3, 33)),
        max_epochs=int(random.integers(1, 25)),
        way_points=int(random.integers(2, 12)),
        sampling=str(random.choice(["curve", "span"])),
        mixing=float(random.choice([0.0, 0.5, 0.8, 0.123456, random.random(), 1.0])),
        mutation_probability=float(random.random()),
        line_jitter=int(random.choice([0, 12, far])),
        line_jitter_probability=float(random.random()),
        neighbourhood=int(random.choice([0, 12, far])),
        margin=int(random.choice([0, 3, 65536])),
        clip_to_map=bool(random.integers(2)),
    )
    return ga, problem


@pytest.mark.parametrize(("rows", "cols"), [(1, 60_000), (1501, 2503), (4000, 4000)])
def test_large_maps_come_to_what_the_processor_does(card, rows, cols):
    problem = evolving.posed(rows, cols, 0.0001, "allow", 5)
    same(card, planner(max_epochs=9), problem, 50)


def test_a_large_population_comes_to_what_the_processor_does(card):
    problem = evolving.posed(40, 60, 0.4, "allow", 5)
    same(card, planner(population=100_000, max_epochs=2), problem, 4)


def test_more_runs_than_a_launch_takes_come_to_what_the_processor_does(card):
    from gapath.kernels.cuda.evolution import MOST_RUNS

    problem = evolving.posed(20, 30, 0.2, "allow", 6)
    same(card, planner(population=4, max_epochs=2), problem, MOST_RUNS + 77)
