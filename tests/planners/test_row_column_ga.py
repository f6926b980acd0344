"""S04's planners against their naive twin: the same epochs, chromosomes, paths and costs."""

import itertools

import naive
import naive_row_column as twin
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from row_column_strategies import GENOTYPES, planner, planners
from strategies import problems

import gapath
from gapath.discovery import yaml_values
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels import rng
from gapath.kernels.s04.genotype import MAX_SIDE, Genotype
from gapath.mapio.drawn import SEARCH_SPACES, Reader
from gapath.planning.flaw import flaw
from gapath.problem import CornerCutting, PlanStatus, Problem
from gapath.survey.row_column import express


def same_as_twin(problem, ga, seed, trial):
    plan = ga.plan(problem, rng.stream(seed, trial))
    epochs = twin.evolve(
        problem.map.weights, problem.start, problem.target, ga, naive.Words(seed, trial)
    )
    evolution = plan.evolution
    assert plan.epochs == len(epochs)
    assert plan.evaluations == ga.population * len(epochs)
    assert evolution.genotype == "row_column"
    assert evolution.chromosomes.tolist() == [epoch["chromosome"] for epoch in epochs]
    points = [[list(point) for point in epoch["points"]] for epoch in epochs]
    assert evolution.way_points.tolist() == points
    best = [epoch["best"][0] * ga.vln + epoch["best"][1] / 65536 for epoch in epochs]
    assert evolution.best.tolist() == best
    mean = [(e["obstacles"] * ga.vln + e["cost"] / 65536) / ga.population for e in epochs]
    assert evolution.mean.tolist() == mean
    assert plan.cost == best[-1]
    found = epochs[-1]["best"][0] == 0
    assert plan.status is (PlanStatus.FOUND if found else PlanStatus.NOT_FOUND)
    fields = twin.walk(epochs[-1]["points"]) if found else []
    assert plan.path.tolist() == [list(field) for field in fields]
    return plan


@settings(max_examples=300)
@given(problems(most=8, least=1), planners(), st.integers(0, 2**64 - 1), st.integers(0, 10**6))
def test_evolution_equals_the_naive_twin(problem, ga, seed, trial):
    same_as_twin(problem, ga, seed, trial)


@pytest.mark.parametrize("name", GENOTYPES)
@pytest.mark.parametrize("drawing", SEARCH_SPACES)
def test_search_spaces_equal_the_naive_twin(name, drawing):
    values = yaml_values("planner", name) | {"max_epochs": 4}
    del values["kind"]
    grid = Reader(drawing).read()
    same_as_twin(Problem(grid, grid.start, grid.target), planner(**values), 7, 1)


@settings(max_examples=200)
@given(problems(most=8), planners(), st.integers(0, 2**64 - 1))
def test_paths_are_horizontal_and_vertical(problem, ga, seed):
    plan = ga.plan(problem, rng.stream(seed))
    for rule in CornerCutting:
        posed = Problem(problem.map, problem.start, problem.target, rule)
        again = ga.plan(posed, rng.stream(seed))
        assert again.path.tolist() == plan.path.tolist()
        assert not plan.feasible or flaw(posed, plan.path, plan.cost) is None
    if plan.feasible:
        assert (np.abs(np.diff(plan.path, axis=0)).sum(axis=1) == 1).all()
        genotype = Genotype(ga.column_wise, ga.switches)
        assert express(problem, genotype) is not None


@pytest.mark.parametrize(
    ("start", "target"), [*itertools.permutations([(1, 1), (8, 1), (1, 8), (8, 8)], 2)]
)
@pytest.mark.parametrize("name", GENOTYPES)
def test_it_goes_in_every_direction(start, target, name):
    weights = np.full((10, 10), 0.5)
    weights[4:6, 3:7] = 1.0
    problem = Problem(GridMap("block", weights), start, target)
    column_wise, switches = GENOTYPES[name]
    ga = planner(column_wise=column_wise, switches=switches, population=60, max_epochs=60)
    plan = ga.plan(problem, rng.stream(0))
    assert flaw(problem, plan.path, plan.cost) is None


@pytest.mark.parametrize("drawing", SEARCH_SPACES)
def test_each_genotype_keeps_to_what_it_can_be(drawing):
    grid = Reader(drawing).read()
    n = grid.cols
    for name, (column_wise, switches) in GENOTYPES.items():
        plan = gapath.plan(grid, planner=name, seed=3, population=50, max_epochs=50)
        genes = plan.evolution.chromosomes
        assert genes[:, :-2].min() >= 0 and genes[:, 0].max() <= column_wise
        assert genes[:, 1 : n + 1].max() < n and genes[:, n + 1 : 2 * n].max() <= 1
        if not switches:
            assert (genes[:, -2:] == n - 1).all()
        if express(Problem(grid, grid.start, grid.target), Genotype(column_wise, switches)) is None:
            assert plan.status is PlanStatus.NOT_FOUND


def problem_of(rows, cols):
    return Problem(GridMap("free", np.full((rows, cols), 0.5)), (0, 0), (cols - 1, rows - 1))


def test_it_can_stop_at_the_first_feasible_path():
    at_once = planner(stop_when_feasible=True).plan(problem_of(9, 9), rng.stream(1))
    assert at_once.feasible and at_once.epochs == 1
    grid = Reader("s04_sp06").read()
    plan = gapath.plan(grid, planner="sedighi", stop_when_feasible=True, seed=1)
    assert plan.feasible and 1 < plan.epochs < 1000
    assert (plan.evolution.best[:-1] >= 100_000).all()  # VLN: with obstacles


def test_without_change_the_fittest_stays():
    """No crossover, no mutation: copies of the first generation, the elite among them."""
    ga = planner(crossover_probability=0, mutation_probability=0, max_epochs=60)
    grid = Reader("s04_sp03").read()
    plan = ga.plan(Problem(grid, grid.start, grid.target), rng.stream(0))
    assert len({tuple(row) for row in plan.evolution.chromosomes[-20:].tolist()}) == 1


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("switches", -1),
        ("switches", 3),
        ("population", 1),
        ("population", -5),
        ("population", 65536),
        ("max_epochs", 0),
        ("max_epochs", 10**6 + 1),
        ("crossover_probability", -0.1),
        ("crossover_probability", float("nan")),
        ("mutation_probability", 1.1),
        ("mutation_probability", float("nan")),
        ("length_weight", -1.0),
        ("length_weight", float("inf")),
        ("length_weight", float("nan")),
        ("turns_weight", -1.0),
        ("turns_weight", 1e7),
        ("vln", 0.5),
        ("vln", float("inf")),
    ],
)
def test_settings_out_of_range_are_refused(field, value):
    with pytest.raises(InputError, match=f"^planner.{field}: got {value}, expected "):
        planner(**{field: value})


def test_settings_that_do_not_go_together_are_refused():
    with pytest.raises(InputError, match=r"^planner.switches: got 1, expected 0, as planner.col"):
        planner(column_wise=False, switches=1)
    with pytest.raises(InputError, match=r"^planner.turns_weight: got 0.0, expected more than 0"):
        planner(length_weight=0.0, turns_weight=0.0)


def test_a_map_that_is_not_square_is_refused_unless_it_is_padded():
    with pytest.raises(InputError) as caught:
        planner().check(problem_of(4, 6))
    assert str(caught.value) == (
        "map: got 6 x 4 fields, expected a square grid (S04), or planner.pad_to_square=true: "
        "what it lacks counts as obstacles"
    )
    planner().check(problem_of(6, 6))
    padded = planner(pad_to_square=True, max_epochs=60)
    padded.check(problem_of(4, 6))
    plan = gapath.plan(problem_of(4, 6).map, (0, 0), (5, 3), padded)
    assert flaw(problem_of(4, 6), plan.path, plan.cost) is None


def test_what_needs_too_much_memory_is_refused():
    planner().check(problem_of(MAX_SIDE, MAX_SIDE))
    side = MAX_SIDE + 1
    for ga, sides in ((planner(), (side, side)), (planner(pad_to_square=True), (1, side))):
        with pytest.raises(InputError, match=f"^map: got {side} fields a side, expected at most"):
            ga.check(problem_of(*sides))
    with pytest.raises(InputError, match=r"^planner.population, planner.max_epochs: .*: 15.7 GiB"):
        planner(max_epochs=10**6).check(problem_of(MAX_SIDE, MAX_SIDE))
