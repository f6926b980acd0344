"""What varies in an experiment is found from the settings of its runs."""

import numpy as np
import pytest

from gapath.pipelines.sweeps.grids import find_grids
from gapath.pipelines.sweeps.varied import cases_of, find_sweeps

from .made import Tried, grid, planned

POPULATION, POINTS, MUTATION = (
    "planner.population",
    "planner.control_points",
    "planner.mutation_probability",
)
RANDOM = np.random.default_rng(1)


def ga(changes, **more):
    return [Tried(changes=each, **more) for each in changes]


def found(tried):
    """Give the names and numbers of values of each sweep's factors, and how many methods."""
    _, runs = planned(tried)
    sweeps = find_sweeps(cases_of(runs), "planner")
    covered = {key for sweep in sweeps for key in sweep.cases.index}
    assert covered == {run.folder.name for run in runs}
    return [
        ({factor.name: len(factor.levels) for factor in sweep.factors}, len(sweep.methods))
        for sweep in sweeps
    ]


ONE_AT_A_TIME = [
    *grid(population=[20, 40, 60, 80]),
    *grid(mutation_probability=[0.1, 0.2, 0.6, 0.8]),
]
SCATTERED = [
    {POPULATION: int(p), POINTS: int(c), MUTATION: float(m)}
    for p, c, m in zip(
        RANDOM.permutation(200)[:12] + 10,
        RANDOM.integers(4, 9, 12),
        RANDOM.random(12),
        strict=True,
    )
]
CASES = {
    "one": (ga(grid(population=range(10, 610, 10))), [({POPULATION: 60}, 60)]),
    "two": (
        ga(grid(population=[20, 50, 80], control_points=[5, 6])),
        [({POINTS: 2, POPULATION: 3}, 6)],
    ),
    "two, some missing": (
        ga(grid(population=[20, 50, 80], control_points=[5, 6, 7])[:7]),
        [({POINTS: 3, POPULATION: 3}, 7)],
    ),
    "three": (
        ga(grid(population=[20, 50], control_points=[5, 6], mixing=[0.1, 0.5, 0.9])),
        [({POINTS: 2, "planner.mixing": 3, POPULATION: 2}, 12)],
    ),
    "words": (ga(grid(sampling=["curve", "span"])), [({"planner.sampling": 2}, 2)]),
    "truth": (ga(grid(clip_to_map=[True, False])), [({"planner.clip_to_map": 2}, 2)]),
    "one at a time": (
        ga(ONE_AT_A_TIME),
        [({MUTATION: 5}, 5), ({POPULATION: 4}, 4)],
    ),
    "scattered": (ga(SCATTERED), [({POINTS: 5, MUTATION: 12, POPULATION: 12}, 12)]),
    "methods": (
        [Tried(preset=name) for name in ("ga1", "ga2", "astar")],
        [({"planner": 3}, 3)],
    ),
    "methods and a setting": (
        [Tried(preset=p, changes={POPULATION: v}) for p in ("ga1", "ga3") for v in (20, 50, 70)],
        [({"planner": 2, POPULATION: 3}, 6)],
    ),
    "a sweep and odds and ends": (
        [
            *ga(grid(population=[20, 50, 80])),
            Tried(preset="astar", map="kg18_test1"),
            Tried(preset="ga3", map="kg18_test2"),
        ],
        [({POPULATION: 3}, 3), ({}, 2)],
    ),
    "odds and ends": (
        [Tried(preset=name, map=f"kg18_test{i}") for i, name in enumerate(("ga1", "ga2", "ga3"))],
        [({}, 3)],
    ),
    "a default on another map": (
        [*ga(grid(population=[20, 50, 80])), Tried(changes={POPULATION: 50}, map="kg18_test1")],
        [({POPULATION: 3}, 3), ({}, 1)],
    ),
    "lists": (
        ga([{"planner.w[0]": 1, "planner.w[1]": 2}, {"planner.w[0]": 3}, {"planner.w[]": None}]),
        [({"planner.w": 3}, 3)],
    ),
    "null": (ga(grid(limit=[None, 100, 200])), [({"planner.limit": 3}, 3)]),
    "a setting that some lack": (
        [Tried(), *ga(grid(extra=[1, 2]))],
        [({"planner.extra": 3}, 3)],
    ),
    "changed together": (
        ga([{POPULATION: p, "planner.max_epochs": 1000 // p} for p in (10, 20, 50, 100)]),
        [({"planner.max_epochs": 4}, 4)],
    ),
    "nothing": ([Tried()], [({}, 1)]),
    "seeds": ([Tried(seed=seed) for seed in range(5)], [({}, 1)]),
    "instances": ([Tried(instance=i) for i in range(5)], [({}, 1)]),
    "maps": ([Tried(map=f"kg18_test{i}") for i in (1, 2, 3)], [({}, 1)]),
}


@pytest.mark.parametrize(("tried", "expected"), CASES.values(), ids=CASES)
def test_what_varies_is_found(tried, expected):
    assert found(tried) == expected


@pytest.mark.parametrize(("tried", "expected"), CASES.values(), ids=CASES)
def test_the_order_of_runs_changes_nothing(tried, expected):
    assert found(tried[::-1]) == expected


def sweeps_of(tried):
    return find_sweeps(cases_of(planned(tried)[1]), "planner")


def test_values_stand_in_their_order():
    (sweep,) = sweeps_of(ga(grid(limit=[200, None, 1000, 30])))
    assert sweep.factors[0].levels == (30, 200, 1000, None)
    assert not sweep.factors[0].numeric
    (sweep,) = sweeps_of(ga(grid(population=[200, 1000, 30])))
    assert sweep.factors[0].levels == (30, 200, 1000) and sweep.factors[0].numeric
    (sweep,) = sweeps_of([Tried(preset=name) for name in ("dijkstra", "astar", "ga2", "ga1")])
    assert sweep.factors[0].levels == ("ga1", "ga2", "astar", "dijkstra")


def test_what_is_the_same_here_but_not_elsewhere_is_kept():
    first, second = sweeps_of(ga(ONE_AT_A_TIME))
    assert first.fixed == ((POPULATION, 40),)
    assert second.fixed == ((MUTATION, 0.4),)


def test_what_all_methods_change_is_no_part_of_their_names():
    common = {"corner_cutting": "forbid"}
    (sweep,) = sweeps_of([Tried("ga1", common), Tried("astar", common)])
    assert sweep.fixed == (("corner_cutting", "forbid"),)
    assert list(sweep.methods["planner"]) == ["ga1", "astar"]
    (sweep,) = sweeps_of(ga([{**common, **each} for each in grid(population=[20, 50, 80])]))
    assert sweep.fixed == (("corner_cutting", "forbid"),)


def test_settings_that_changed_together_are_named():
    (sweep,) = sweeps_of(CASES["changed together"][0])
    assert sweep.together == ((POPULATION, "planner.max_epochs"),)


def test_rows_of_a_scenario_are_problems_of_one_map():
    tried = [
        Tried(name, map=f"arena[start={i}]", start=f"({i}, 0)", path="maps/arena.map")
        for name in ("ga1", "astar")
        for i in range(6)
    ]
    cases = cases_of(planned(tried)[1])
    assert set(cases["place"]) == {"arena"}
    assert cases["problem"].nunique() == 6
    (sweep,) = find_sweeps(cases, "planner")
    assert [factor.name for factor in sweep.factors] == ["planner"]


def test_two_maps_of_one_name_are_two():
    tried = [Tried(map="arena", path=f"{folder}/arena.map") for folder in ("one", "two")]
    assert cases_of(planned(tried)[1])["place"].nunique() == 2


def test_a_grid_with_a_point_beside_it_is_a_grid():
    codes = np.array([(i, j, 0) for i in range(4) for j in range(3)] + [(0, 0, 1)])
    assert find_grids(codes) == [((0, 1), list(range(12)))]


def test_a_triangle_is_one_sweep():
    codes = np.array([(i, j) for i in range(6) for j in range(i)])
    assert find_grids(codes) == [((0, 1), list(range(15)))]
