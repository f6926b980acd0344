"""How times grow: maps of any size pose the same problem, and every size is timed fairly."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.measure import MAPS, SETTINGS, make_planner, make_problem
from benchmarks.questions.kg18 import growth, growth_settings
from gapath.kernels.rng import stream
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem


@pytest.mark.parametrize("name", MAPS)
def test_a_map_of_the_same_size_is_the_same_map(name):
    problem = make_problem(name)
    same = growth.enlarged(problem, 100, 50)
    assert (same.start, same.target) == (problem.start, problem.target)
    assert np.array_equal(same.map.weights, problem.map.weights)


def test_an_enlarged_map_has_the_same_obstacles():
    problem = make_problem("kg18_test3")
    large = growth.enlarged(problem, 400, 100)
    assert (large.map.cols, large.map.rows) == (400, 100)
    assert large.start == (2, 49) and large.target == (394, 49)
    blocks = large.map.obstacles.reshape(50, 2, 100, 4)
    assert np.array_equal(blocks.all(axis=(1, 3)), problem.map.obstacles)
    assert np.array_equal(blocks.any(axis=(1, 3)), problem.map.obstacles)
    assert (large.map.weights == 0).sum() == 2
    assert large.map.least_weight(large.start, large.target) > 0  # A* keeps its heuristic


def test_a_map_builds_its_table_each_time(monkeypatch):
    problem, built = make_problem("kg18_test1"), []

    def timed(call):
        built.append(call())
        return float(len(built)), built[-1]

    monkeypatch.setattr(growth, "timed", timed)
    assert growth.time_tables(problem, 2) == ([1.0, 3.0], [2.0, 4.0])
    first, least, second, _ = built
    assert np.array_equal(first, problem.map.table) and np.array_equal(first, second)
    assert len({id(table) for table in (first, second, problem.map.table)}) == 3
    assert least == problem.map.least_weight(problem.start, problem.target)


def test_every_class_and_size_is_timed(monkeypatch):
    monkeypatch.setattr(growth, "SIZES", {(100, 50): 5, (200, 100): 5})
    rows = growth.measure(quick=True)
    assert [(row["class"], row["size"], row["planner"]) for row in rows] == [
        (name, size, planner)
        for name in MAPS
        for size in ("100 x 50", "200 x 100")
        for planner in SETTINGS
    ]
    for row in rows:
        assert row["seeds"] == 2
        assert row["found"] == {"kg18_test1": 1, "kg18_test4": 0}.get(row["class"], row["found"])
        for name in ("GA us", "A* us", "table us", "least weight us", "A* / GA"):
            assert 0 < row[name].lower <= row[name].upper


def test_a_first_query_counts_what_has_to_be_built(monkeypatch):
    def interleaved(rounds):
        found = [{name: call() for name, call in calls.items()} for calls in rounds[1:]]
        times = {"ga1": [10.0, 20.0], "ga2": [1.0, 1.0], "ga3": [1.0, 1.0], "astar": [30.0, 40.0]}
        return times, found

    monkeypatch.setattr(growth, "SIZES", {(100, 50): 2})
    monkeypatch.setattr(growth, "interleave", interleaved)
    monkeypatch.setattr(growth, "time_tables", lambda problem, times: ([2.0, 2.0], [5.0, 6.0]))
    row = growth.measure(quick=False)[0]
    assert row["A* / GA, table built"].median == (30 / 10 + 40 / 20) / 2
    assert row["A* / GA"].median == ((30 + 2 + 5) / (10 + 2) + (40 + 2 + 6) / (20 + 2)) / 2


def test_a_path_cheaper_than_a_stars_is_noticed():
    problem = make_problem("kg18_test1")
    exact = shortest_path(problem)
    plan = make_planner("ga1").plan(problem, stream(0))
    growth.check_least(exact, plan)
    with pytest.raises(RuntimeError, match=r"A\* does not find the least cost"):
        growth.check_least(replace(exact, weights=plan.cost + 1), plan)
    weights = problem.map.weights.copy()
    weights[:, 50] = 1.0
    walled = Problem(replace(problem.map, weights=weights), problem.start, problem.target)
    with pytest.raises(RuntimeError, match=r"A\* does not find the least cost"):
        growth.check_least(shortest_path(walled), plan)


def test_every_setting_is_timed_over_the_same_epochs(monkeypatch):
    made = []

    def noted(name, **settings):
        made.append(make_planner(name, **settings))
        return made[-1]

    monkeypatch.setattr(growth_settings, "make_planner", noted)
    rows = growth_settings.measure(quick=True)
    assert [(row["setting"], row["value"]) for row in rows] == [
        (setting, value) for setting, values in growth_settings.VARIED.items() for value in values
    ]
    assert all(row["us an epoch"].lower > 0 for row in rows)
    for row, planner in zip(rows, made, strict=True):
        assert getattr(planner, row["setting"]) == row["value"]
        assert planner.min_epochs == planner.max_epochs == growth_settings.EPOCHS
