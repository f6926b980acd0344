"""The memetic planner: never a false proof, settings in range, the same however it is compiled."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from naive_memetic import walled_problems

from gapath.api import load_map
from gapath.components import build
from gapath.discovery import yaml_values
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.rng import stream
from gapath.planners import memetic
from gapath.planning.flaw import flaw
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Plan, PlanStatus, Problem

NAMES = ["memetic_quick", "memetic_quality"]


@pytest.fixture(autouse=True, scope="module")
def walls_on_small_maps():
    """The algorithm is what is tested, on maps that would be searched."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(memetic, "SMALL", 0)
        yield


@given(problem=walled_problems(most=30))
def test_a_small_map_is_searched(problem):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(memetic, "SMALL", 30 * 30)
        plan = make().plan(problem, stream(1))
    best = shortest_path(problem)
    assert (plan.status, plan.cost, plan.expansions) == (best.status, best.cost, best.expansions)
    assert plan.path.tolist() == best.path.tolist()
    if plan.feasible:
        assert flaw(problem, plan.path, plan.cost) is None
        assert plan.shares() == dict.fromkeys(memetic.NAMES, 0.0) | {"search": plan.cost}
        assert fields(plan.lines()) == plan.path.tolist()
        assert plan.evolution.best.tolist() == [plan.cost]


def fields(points):
    """The fields of straight lines, each along a row, a column or a diagonal."""
    path = points[:1].tolist()
    for x, y in points[1:].tolist():
        while path[-1] != [x, y]:
            u, v = path[-1]
            path.append([u + (x > u) - (x < u), v + (y > v) - (y < v)])
    return path


def make(name="memetic", **values):
    return build("planner", yaml_values("planner", name) | values, "planner")


@pytest.mark.parametrize("name", NAMES)
@given(problem=walled_problems(most=30), seed=st.integers(0, 1000))
def test_it_finds_what_astar_finds_and_proves_nothing_false(name, problem, seed):
    plan, best = make(name).plan(problem, stream(seed)), shortest_path(problem)
    assert plan.feasible == best.feasible
    if not plan.feasible:
        assert plan.status is PlanStatus.INFEASIBLE
        return
    assert flaw(problem, plan.path, plan.cost) is None
    assert plan.cost >= best.cost
    assert plan.status is not PlanStatus.OPTIMAL or plan.cost == best.cost


@pytest.mark.parametrize("hands", ["left", "right", "both"])
@pytest.mark.parametrize("rule", list(CornerCutting), ids=lambda rule: rule.name.lower())
def test_each_hand_finds_a_path_and_proves_that_there_is_none(hands, rule):
    weights = np.full((30, 30), 0.5)
    weights[5:25, 15], weights[5, 5:16], weights[24, 5:16] = 1.0, 1.0, 1.0
    for open_at_left in (True, False):
        weights[5:25, 5] = 0.5 if open_at_left else 1.0
        problem = Problem(GridMap("bay", weights), (10, 15), (20, 15), rule)
        assert make(hands=hands).plan(problem, stream(1)).feasible == open_at_left


@pytest.mark.parametrize("rule", list(CornerCutting), ids=lambda rule: rule.name.lower())
def test_a_straight_way_is_proved_optimal(rule):
    weights = np.full((9, 20), 0.5)
    weights[3, 5:9] = 1.0
    plan = make().plan(Problem(GridMap("way", weights), (1, 4), (18, 4), rule), stream(0))
    assert (plan.status, plan.cost, plan.evaluations) == (PlanStatus.OPTIMAL, 9.0, 1)
    assert plan.lines().tolist() == [[1, 4], [18, 4]]


def blocks(number, rows=60, cols=90):
    """Even ground with blocks on it."""
    random = np.random.default_rng(number)
    weights = np.full((rows, cols), 0.5)
    for _ in range(rows * cols // 150):
        x, y = random.integers(0, (cols - 4, rows - 4))
        weights[y : y + random.integers(2, 9), x : x + random.integers(2, 9)] = 1.0
    weights[0, 0] = weights[-1, -1] = 0.5
    rule = CornerCutting(number % 4)
    return Problem(GridMap("blocks", weights), (0, 0), (cols - 1, rows - 1), rule)


def test_more_effort_pays():
    problems = [problem for problem in map(blocks, range(24)) if shortest_path(problem).feasible]
    best, quick, quality = (
        [planner.plan(problem, stream(1)).cost for problem in problems]
        for planner in (build("planner", yaml_values("planner", "astar"), "planner"),
                        *map(make, NAMES))
    )  # fmt: skip
    assert len(problems) > 6
    assert sum(best) < sum(quality) < sum(quick)


@pytest.mark.parametrize(
    ("name", "value", "right"),
    [
        ("population", 0, "an integer from 1 to 8"),
        ("population", 9, "an integer from 1 to 8"),
        ("population", 2.5, "a value of type int"),
        ("hands", "", "one of left, right, both"),
        ("hands", "Left", "one of left, right, both"),
        ("effort", -0.5, "a number from 0 to 1000000"),
        ("effort", 1e7, "a number from 0 to 1000000"),
        ("effort", float("nan"), "a number from 0 to 1000000"),
        ("tolerance", -0.01, r"a number in \[0, 1\]"),
        ("tolerance", 1.5, r"a number in \[0, 1\]"),
        ("crossover_probability", 1.01, r"a number in \[0, 1\]"),
        ("crossover_probability", float("nan"), r"a number in \[0, 1\]"),
        ("reroute_probability", -1.0, r"a number in \[0, 1\]"),
        ("reroute_probability", float("inf"), r"a number in \[0, 1\]"),
    ],
)
def test_settings_out_of_range_are_refused(name, value, right):
    with pytest.raises(InputError, match=rf"planner\.{name}: got '?{value}'?, expected {right}"):
        make(**{name: value})


def test_settings_at_the_ends_of_their_ranges_plan():
    """Probabilities of one, no time, and all the time that there can be, on a tiny map."""
    weights = np.full((4, 4), 0.5)
    weights[1, 1] = 1.0
    problem = Problem(GridMap("tiny", weights), (0, 1), (3, 1))
    for population in (1, 8):
        for effort in (0.0, 100.0):
            for chance in (0.0, 1.0):
                plan = make(
                    population=population, effort=effort, tolerance=0.0,
                    crossover_probability=chance, reroute_probability=chance,
                ).plan(problem, stream(2))  # fmt: skip
                assert plan.cost == shortest_path(problem).cost


def small():
    """What must not depend on how kernels are compiled: plans, and how they came about."""
    told = []
    for number in range(12):
        plan = make("memetic_quality").plan(blocks(number), stream(number))
        population = plan.evolution.population if plan.feasible else None
        told.append([plan.status.name, plan.cost, plan.evaluations, plan.path.tolist()])
        told[-1] += [part.tolist() for part in population[:7]] if population else []
    return told


def test_plans_are_the_same_without_the_compiler():
    code = "import conftest, json, test_memetic_planner as t; print(json.dumps(t.small()))"
    here, above = Path(__file__).parent, Path(__file__).parents[1]
    there = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": f"{above}{os.pathsep}{here}"},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert there.returncode == 0, there.stderr
    plans = json.loads(json.dumps(small()))
    assert json.loads(there.stdout) == plans
    assert max(plan[2] for plan in plans) > 50


def comb(rows=99, cols=99):
    """One corridor of a field that goes there and back: hands give up, and A* is asked."""
    weights = np.full((rows, cols), 0.5)
    weights[:-1, 1::4] = weights[1:, 3::4] = 1.0
    return weights


def test_shares_are_at_one_with_the_path_where_hands_gave_up():
    problem = Problem(GridMap("comb", comb()), (0, 0), (98, 50), CornerCutting.FORBID)
    plan = make().plan(problem, stream(1))
    shares = list(plan.shares().values())
    assert plan.status is PlanStatus.OPTIMAL and plan.expansions > 0
    assert plan.cost == shortest_path(problem).cost == shares[0] - sum(shares[1:])
    assert min(shares) >= 0 and began_with(plan) == "search"


def began_with(plan):
    """Say what a plan tells of its first path, in its history and its shares alike."""
    population = plan.evolution.population
    (told,) = {next(iter(plan.shares())), population.names[population.operators[0]]}
    return told


def test_memetic_first_does_what_memetic_does_first():
    rooms = load_map("field_rooms", width=200, height=100)
    problem = Problem(rooms, rooms.start, rooms.target)
    whole, first = make().plan(problem, stream(1)), make("memetic_first").plan(problem, stream(2))
    assert whole.evaluations > first.evaluations == 1
    assert np.array_equal(whole.evolution.population.polygon(0), first.lines())


@pytest.mark.parametrize("name", NAMES)
def test_a_first_path_is_what_found_it(name):
    hill = np.full((40, 60), 0.5)
    hill[10:30, 20:40] = 0.75
    wall = np.full((40, 60), 0.5)
    wall[:30, 30] = 1.0
    for weights, expected in ((hill, "search"), (wall, "wall following")):
        problem = Problem(GridMap("one", weights), (0, 20), (59, 20))
        plan = make(name).plan(problem, stream(1))
        assert began_with(plan) == expected and (plan.expansions > 0) == (expected == "search")
        first, *lowered = plan.shares().values()
        assert first - sum(lowered) == plan.cost


def test_no_way_is_proved_where_hands_gave_up():
    weights = comb()
    weights[60, 97:] = weights[62, 97:] = weights[60:63, 97] = 1.0
    problem = Problem(GridMap("comb", weights), (0, 0), (98, 61), CornerCutting.FORBID)
    assert make().plan(problem, stream(1)).status is PlanStatus.INFEASIBLE


def test_a_coarse_path_that_is_dearer_than_the_walls_is_not_taken(monkeypatch):
    weights = np.full((40, 60), 0.5)
    weights[10:30, 20:40] = 0.75
    problem = Problem(GridMap("dear", weights), (0, 20), (59, 20))
    dear = [(x, 20) for x in range(20)] + [(20, 20 - i % 2) for i in range(200)]
    dear += [(x, 20) for x in range(21, 60)]
    path = np.array(dear, dtype=np.int32)
    cost = float(weights[path[:, 1], path[:, 0]].sum())
    monkeypatch.setattr(memetic, "LARGE", 100)
    monkeypatch.setattr(memetic, "coarse_path", lambda _: Plan(PlanStatus.FOUND, path, cost))
    plan = make().plan(problem, stream(1))
    assert plan.cost < cost and min(plan.shares().values()) >= 0
    assert began_with(plan) == "wall following"
