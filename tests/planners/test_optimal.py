"""Planners that call themselves optimal, found, not listed: no path is better than theirs."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import problems

from gapath.components import build
from gapath.discovery import yaml_names, yaml_values
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.rng import stream
from gapath.planning.path import octile_length
from gapath.planning.planner import Optimal, Particular
from gapath.planning.shortest_path import shortest_path
from gapath.problem import PlanStatus

PLANNERS = {name: build("planner", yaml_values("planner", name), "planner")
            for name in yaml_names("planner")}  # fmt: skip
OPTIMAL = [name for name, planner in PLANNERS.items()
           if isinstance(planner, Optimal) and planner.optimal]  # fmt: skip


def test_there_are_some():
    assert {"astar", "dijkstra", "astar_length", "jps"} <= set(OPTIMAL)


@pytest.mark.parametrize("name", OPTIMAL)
@settings(max_examples=50)
@given(problems(), st.booleans())
def test_what_an_optimal_planner_finds_is_the_least(name, problem, even):
    planner = PLANNERS[name]
    if even:
        weights = np.where(problem.map.obstacles, 1.0, 0.25)
        problem = replace(problem, map=GridMap("even", weights))
    if isinstance(planner, Particular):
        try:
            planner.check(problem)
        except InputError:
            return
    by_length = {"weights": False, "length": True}[planner.minimises]
    best, plan = shortest_path(problem, by_length=by_length), planner.plan(problem, stream(0))
    assert plan.feasible == best.feasible
    if by_length and best.feasible:
        assert octile_length(plan.path) == pytest.approx(octile_length(best.path))
    else:
        assert plan.cost == best.cost
    if plan.feasible:  # the least length is no proof of the least cost
        assert plan.status is (PlanStatus.FOUND if by_length else PlanStatus.OPTIMAL)
