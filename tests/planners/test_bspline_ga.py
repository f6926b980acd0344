"""KG18's planner against its naive twin: the same epochs, chromosomes and costs."""

import naive
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import planner, planners, problems

from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels import rng
from gapath.kernels.jit import JIT
from gapath.kernels.kg18 import evolution
from gapath.mapio.reconstructed import generate
from gapath.planning.acceleration import Accelerated
from gapath.planning.flaw import flaw
from gapath.problem import PlanStatus, Problem


def same_as_twin(problem, ga, seed, trial):
    plan = ga.plan(problem, rng.stream(seed, trial))
    epochs, evaluations = naive.evolve(
        problem.map.weights,
        problem.start,
        problem.target,
        ga,
        naive.Words(seed, trial),
        problem.corner_cutting.name.lower(),
    )
    evolution = plan.evolution
    assert plan.epochs == len(epochs)
    assert plan.evaluations == evaluations
    assert evolution.chromosomes.tolist() == [epoch["chromosome"] for epoch in epochs]
    number = [epoch["best"][0] * ga.vln + epoch["best"][1] / 65536 for epoch in epochs]
    assert evolution.best.tolist() == number
    mean = [(e["obstacles"] * ga.vln + e["cost"] / 65536) / ga.population for e in epochs]
    assert evolution.mean.tolist() == mean
    points = naive.way_points(epochs[-1]["chromosome"], ga.way_points, ga.sampling == "span")
    assert evolution.way_points[-1].tolist() == [list(point) for point in points]
    assert plan.cost == number[-1]
    assert plan.feasible == (epochs[-1]["best"][0] == 0)
    assert plan.path.tolist() == (
        [list(field) for field in naive.polyline(points)] if plan.feasible else []
    )
    if plan.feasible:
        assert flaw(problem, plan.path) is None


@settings(max_examples=120)
@given(problems(), planners(), st.integers(0, 2**64 - 1), st.integers(0, 10**6))
def test_evolution_equals_the_naive_twin(problem, ga, seed, trial):
    same_as_twin(problem, ga, seed, trial)


@pytest.mark.parametrize("map_class", ["kg18_test1", "kg18_test2", "kg18_test3", "kg18_test4"])
@pytest.mark.parametrize(("population", "k"), [(40, 4), (100, 4), (100, 5)])
def test_table1_settings_equal_the_naive_twin(map_class, population, k):
    grid = generate(map_class, 0)
    ga = planner(population=population, control_points=k, max_epochs=6)
    same_as_twin(Problem(grid, grid.start, grid.target), ga, 7, 1)


def test_many_plans_in_one_call_are_those_of_many_calls():
    grid = generate("kg18_test3", 0)
    problem, ga = Problem(grid, grid.start, grid.target), planner(max_epochs=30)
    streams = np.array([rng.stream(7, trial) for trial in range(9)])
    alone = [ga.plan(problem, row) for row in streams.copy()]
    together = ga.plan_many(problem, streams)
    assert len({plan.epochs for plan in alone}) > 1
    for a, b in zip(alone, together, strict=True):
        assert (a.status, a.cost, a.epochs, a.evaluations) == (
            b.status,
            b.cost,
            b.epochs,
            b.evaluations,
        )
        assert a.path.tolist() == b.path.tolist()
        assert a.evolution.chromosomes.tolist() == b.evolution.chromosomes.tolist()
        assert a.evolution.mean.tolist() == b.evolution.mean.tolist()
    advanced = rng.stream(7, 8)
    ga.plan(problem, advanced)
    assert streams[8].tolist() == advanced.tolist()


needs_jit = pytest.mark.skipif(not JIT, reason="vectors need the compiler")


@needs_jit
@given(problems(), planners(), st.integers(0, 2**64 - 1))
def test_all_kernels_plan_the_same(problem, ga, seed):
    assert isinstance(ga, Accelerated) and ga.kernels == ("vectors", "scalar")
    vectors, scalar = (ga.using(name) for name in ga.kernels)
    assert vectors.evolve is ga.evolve is not scalar.evolve
    assert vectors == ga == scalar
    one, other = (each.plan(problem, rng.stream(seed)) for each in (vectors, scalar))
    assert (one.cost, one.path.tolist()) == (other.cost, other.path.tolist())
    assert one.evolution.mean.tolist() == other.evolution.mean.tolist()
    assert one.evolution.chromosomes.tolist() == other.evolution.chromosomes.tolist()


def test_kernels_that_do_not_run_here_are_refused(monkeypatch):
    with pytest.raises(InputError, match=r"kernels: got cuda, expected one of .*scalar"):
        planner().using("cuda")
    monkeypatch.setattr(evolution, "JIT", False)
    assert planner().kernels == ("scalar",)
    assert planner().evolve is evolution.KERNELS["scalar"]
    with pytest.raises(InputError, match="kernels: got vectors, expected one of scalar"):
        planner().using("vectors")


def test_a_planner_may_be_given_kernels_of_ones_own():
    def evolve(*arguments):
        called.append(len(arguments))
        evolution.KERNELS["scalar"](*arguments)

    called = []
    problem = Problem(GridMap("empty", np.full((9, 9), 0.5)), (0, 4), (8, 4))
    ga = planner(min_epochs=1)
    own = ga.using(evolve).plan(problem, rng.stream(0))
    assert called == [10]
    assert own.path.tolist() == ga.plan(problem, rng.stream(0)).path.tolist()


def test_long_histories_are_not_kept_many_at_a_time():
    assert planner(max_epochs=500).most_at_once == 64
    assert planner(max_epochs=10**6).most_at_once == 1
    assert planner(max_epochs=500, population=10**4).most_at_once == 2  # so that threads share them


def test_it_never_stops_before_min_epochs():
    grid = GridMap("empty", np.full((9, 9), 0.5))
    plan = planner(min_epochs=4).plan(Problem(grid, (0, 4), (8, 4)), rng.stream(0))
    assert plan.epochs == 4
    assert plan.status is PlanStatus.FOUND


def test_the_best_individual_never_gets_worse():
    grid = generate("kg18_test4", 0)
    ga = planner(population=40, max_epochs=60)
    plan = ga.plan(Problem(grid, grid.start, grid.target), rng.stream(3))
    assert (np.diff(plan.evolution.best) <= 0).all()
    assert plan.status is PlanStatus.NOT_FOUND
    assert plan.cost >= ga.vln
    assert plan.evaluations == 40 + 59 * 30


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("population", 3),
        ("population", -5),
        ("population", 10**7),
        ("control_points", 2),
        ("control_points", 33),
        ("min_epochs", 0),
        ("min_epochs", 501),
        ("max_epochs", 0),
        ("way_points", 1),
        ("sampling", "everywhere"),
        ("mixing", 1.1),
        ("mixing", float("nan")),
        ("mutation_probability", -0.1),
        ("line_jitter", -1),
        ("line_jitter_probability", 2.0),
        ("neighbourhood", -1),
        ("margin", -1),
        ("vln", 0.5),
        ("vln", float("inf")),
    ],
)
def test_settings_out_of_range_are_refused(field, value):
    with pytest.raises(InputError, match=f"planner.{field}: got {value}"):
        planner(**{field: value})


def test_settings_that_need_too_much_memory_are_refused():
    with pytest.raises(InputError, match=r"planner.population, planner.max_epochs: .* GiB"):
        planner(population=10**6, max_epochs=10**6, control_points=32)


def test_a_margin_that_is_too_wide_leaves_the_middle_of_the_map():
    grid = GridMap("small", np.full((9, 9), 0.5))
    ga = planner(margin=100, population=9, line_jitter=0, neighbourhood=0)
    plan = ga.plan(Problem(grid, (4, 4), (4, 4)), rng.stream(0))
    assert plan.path.tolist() == [[4, 4]]


def test_paths_far_outside_the_map_are_no_solutions():
    """More obstacle fields than a key can count must not pass for none."""
    weights = np.full((300, 300), 0.5)
    weights[range(300), range(299, -1, -1)] = 1.0
    weights[range(1, 300), range(299, 0, -1)] = 1.0
    problem = Problem(GridMap("wall", weights), (0, 0), (299, 299))
    ga = planner(
        neighbourhood=65536, control_points=12, way_points=16, sampling="span", max_epochs=5
    )
    plan = ga.plan(problem, rng.stream(0))
    assert plan.status is PlanStatus.NOT_FOUND
    assert plan.cost >= ga.vln
