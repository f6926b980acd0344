"""What every planner keeps to that tells what its population took in; planners are found."""

from itertools import pairwise

import numpy as np
import pytest
from gapath_example import bender

from gapath import components
from gapath.discovery import yaml_names, yaml_values
from gapath.grid import GridMap
from gapath.kernels import rng
from gapath.kernels.raster import polyline
from gapath.planning.flaw import flaw
from gapath.planning.path import path_weights
from gapath.problem import CornerCutting, Problem

EXAMPLE = bender.Planner(individuals=4, epochs=30, tries=80)


def problems():
    """Give a wall with a gap under each rule, all weights, no way to go, and no wall."""
    wall = np.full((24, 40), 0.5)
    wall[:16, 20] = 1.0
    ground = np.random.default_rng(2).integers(0, 60, (24, 40)) / 64
    ground[4:20, 14:17] = 1.0
    for rule in CornerCutting:
        yield Problem(GridMap("wall", wall), (4, 12), (34, 12), rule)
    yield Problem(GridMap("ground", ground), (2, 12), (36, 10), CornerCutting.FORBID)
    yield Problem(GridMap("empty", np.full((9, 9), 0.25)), (4, 4), (4, 4))
    yield Problem(GridMap("empty", np.full((9, 9), 0.25)), (1, 1), (7, 7))


def check_population(problem, plan):
    """Raise AssertionError if a plan's history is at odds with itself or with the plan."""
    evolution, population = plan.evolution, plan.evolution.population
    epochs, m = len(evolution.best), len(population.epochs)
    assert plan.feasible
    assert evolution.genotype == "polygon"
    of_changes = (population.individuals, population.operators, population.gains,
                  population.costs, population.ends)  # fmt: skip
    assert {len(part) for part in of_changes} == {m}
    assert len(population.vertices) == population.ends[-1]
    kinds = ["int32", "int32", "int32", "float64", "float64", "int32", "int32"]
    assert [part.dtype.name for part in population[:7]] == kinds
    assert population.epochs[0] == 1
    assert (np.diff(population.epochs) >= 0).all() and population.epochs[-1] <= epochs
    assert (population.operators >= 0).all()
    assert (population.operators < len(population.names)).all()
    assert len(set(population.names)) == len(population.names) == len(population.shares)
    assert population.shares[0] - sum(population.shares[1:]) == plan.cost
    assert min(population.shares) >= 0
    assert population.operators[0] == 0  # what found the first path, whose cost is shares[0]

    before = {}
    for i, individual in enumerate(population.individuals.tolist()):
        polygon = population.polygon(i)
        path = polyline(polygon)
        assert tuple(polygon[0]) == problem.start and tuple(polygon[-1]) == problem.target
        assert flaw(problem, path) is None
        assert population.costs[i] == path_weights(problem.map, path)
        if population.epochs[i] == 1:
            assert population.gains[i] == 0
        elif individual in before:
            assert population.gains[i] == before[individual] - population.costs[i] >= 0
        before[individual] = population.costs[i]
    assert min(before.values()) == plan.cost

    standing = population.standing(epochs)
    for epoch in range(epochs):
        now = [i for i in standing[epoch].tolist() if i >= 0]
        costs = population.costs[now]
        assert evolution.best[epoch] == costs.min()
        assert evolution.mean[epoch] == pytest.approx(costs.mean())
        row = evolution.way_points[epoch]
        best = [population.polygon(i) for i in now if population.costs[i] == costs.min()]
        padded = [np.concatenate([p, p[-1:].repeat(len(row) - len(p), 0)]) for p in best
                  if len(p) <= len(row)]  # fmt: skip
        assert any((each == row).all() for each in padded)
    assert (evolution.chromosomes == evolution.way_points.reshape(epochs, -1)).all()
    assert polyline(evolution.way_points[-1]).tolist() == plan.path.tolist()


@pytest.mark.parametrize("name", [None, *yaml_names("planner")])
def test_a_population_is_at_one_with_its_plan(name):
    values = yaml_values("planner", name) if name else {}
    planner = components.build("planner", values, "planner") if name else EXAMPLE
    plan = planner.plan(list(problems())[-1], rng.stream(11))
    if plan.evolution is None or plan.evolution.population is None:
        return
    checked = 0
    for number, problem in enumerate(problems()):
        for trial in range(3):
            plan = planner.plan(problem, rng.stream(11, number, trial))
            if plan.evolution:
                check_population(problem, plan)
                checked += 1
    assert checked > 10


LIES = {
    "a share more": lambda e, p: (e, p._replace(shares=(p.shares[0] + 1, *p.shares[1:]))),
    "a dearer change": lambda e, p: (e, p._replace(costs=p.costs + 1)),
    "another polygon": lambda e, p: (e, p._replace(vertices=p.vertices[::-1].copy())),
    "a larger gain": lambda e, p: (e, p._replace(gains=p.gains + 1)),
    "longer integers": lambda e, p: (e, p._replace(operators=p.operators.astype(np.int64))),
    "an epoch too late": lambda e, p: (e, p._replace(epochs=p.epochs + len(e.best))),
    "epochs that fall": lambda e, p: (e, p._replace(epochs=p.epochs[::-1].copy())),
    "another best": lambda e, p: (e._replace(best=e.best + 1), p),
    "another mean": lambda e, p: (e._replace(mean=e.mean + 1), p),
    "another path": lambda e, p: (e._replace(way_points=e.way_points[::-1].copy()), p),
    "other genes": lambda e, p: (e._replace(chromosomes=e.chromosomes + 1), p),
}


@pytest.mark.parametrize("lie", LIES.values(), ids=LIES)
def test_a_population_that_lies_is_found_out(lie):
    problem = next(problems())
    plan = EXAMPLE.plan(problem, rng.stream(11))
    check_population(problem, plan)
    evolution, population = lie(plan.evolution, plan.evolution.population)
    plan.__dict__["evolution"] = evolution._replace(population=population)
    with pytest.raises(AssertionError):
        check_population(problem, plan)


def test_standing_is_what_the_changes_left_so_far():
    plan = EXAMPLE.plan(next(problems()), rng.stream(5))
    population, epochs = plan.evolution.population, len(plan.evolution.best)
    standing = population.standing(epochs)
    for epoch in range(1, epochs + 1):
        latest = {}
        for i, (when, who) in enumerate(
            zip(population.epochs.tolist(), population.individuals.tolist(), strict=True)
        ):
            if when <= epoch:
                latest[who] = i
        everyone = sorted(set(population.individuals.tolist()))
        assert standing[epoch - 1].tolist() == [latest.get(who, -1) for who in everyone]
    assert any((a != b).any() for a, b in pairwise(standing))
