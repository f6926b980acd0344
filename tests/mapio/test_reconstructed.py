"""The classes of reconstructed maps: frozen, of their kind, and as hard as KG18 says."""

import numpy as np
import pytest
from scale import whole
from strategies import planner

from gapath.errors import InputError
from gapath.kernels import rng
from gapath.kernels.links import link_distances
from gapath.mapio.reconstructed import CLASSES, Reader, generate
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem

INSTANCES = range(30)
SOME = whole(INSTANCES[::10], INSTANCES)  # on which a search for straight pieces takes its time
GA = {
    "ga1": planner(population=40),
    "ga2": planner(population=100),
    "ga3": planner(population=100, control_points=5),
}

# Epochs of KG18's three executions a cell: seconds over the seconds of one epoch.
PAPER = {
    ("kg18_test1", "ga1"): [1, 1, 1],
    ("kg18_test1", "ga2"): [1, 1, 1],
    ("kg18_test1", "ga3"): [1, 1, 1],
    ("kg18_test2", "ga1"): [7, 3, 6],
    ("kg18_test2", "ga2"): [1, 2, 2],
    ("kg18_test2", "ga3"): [2, 2, 2],
    ("kg18_test3", "ga1"): [37, 26],
    ("kg18_test3", "ga2"): [49, 30, 11],
    ("kg18_test3", "ga3"): [7, 7, 17],
}


def problem(name, instance=0):
    grid = generate(name, instance)
    return Problem(grid, grid.start, grid.target)


@pytest.mark.parametrize("name", CLASSES)
def test_the_committed_map_is_the_canonical_instance(name):
    read, drawn = Reader(name, 0).read(), generate(name, 0)
    assert read.digest == drawn.digest
    assert (read.name, read.start, read.target, read.source) == (
        name,
        (0, 24),
        (98, 24),
        "reconstructed",
    )


@pytest.mark.parametrize("name", CLASSES)
def test_instances_differ_and_can_be_solved(name):
    problems = [problem(name, i) for i in INSTANCES]
    assert len({p.map.digest for p in problems}) == len(INSTANCES)
    for p in problems:
        assert p.map.weights.shape == (50, 100)
        assert p.map.weights[24, 0] == p.map.weights[24, 98] == 0
        assert set(np.unique(p.map.weights)) == {0.0, 0.5, 1.0}
        assert shortest_path(p).feasible


@pytest.mark.parametrize(
    ("name", "pieces"), [("kg18_test1", 2), ("kg18_test2", 2), ("kg18_test3", 3)]
)
def test_classes_need_so_many_straight_pieces(name, pieces):
    for i in SOME:
        p = problem(name, i)
        distances = link_distances(p.map.table, p.start, pieces)
        assert distances[p.target[1], p.target[0]] == pieces


def test_no_polyline_of_four_pieces_joins_start_and_target_in_class_4():
    """Five way points make four straight pieces, so neither k = 4 nor k = 5 can succeed.

    Two pieces ahead from the start and two back from the target share no field.
    """
    for i in SOME:
        p = problem("kg18_test4", i)
        ahead = link_distances(p.map.table, p.start, 2) >= 0
        behind = link_distances(p.map.table, p.target, 2) >= 0
        assert not (ahead & behind).any()


def test_success_over_many_seeds_has_the_pattern_of_table_1():
    """Maps 1 and 2 always, map 3 more often the better the setting, map 4 never."""
    rates = {}
    for name, seeds in [("1", 1000), ("2", 1000), ("3", 1000), ("4", 40)]:
        p = problem(f"kg18_test{name}")
        for setting, ga in GA.items():
            plans = (ga.plan(p, rng.stream(0, trial)) for trial in range(seeds))
            rates[name, setting] = 100 * sum(plan.feasible for plan in plans) / seeds
    easy = {rates[name, setting] for name in "12" for setting in GA}
    assert easy == {100}, rates
    assert 60 <= rates["3", "ga1"] < rates["3", "ga2"] < rates["3", "ga3"] <= 99.9, rates
    assert {rates["4", setting] for setting in GA} == {0}, rates


@pytest.mark.parametrize(("name", "setting"), PAPER)
def test_the_canonical_map_is_as_hard_as_the_papers(name, setting):
    """Each of the paper's executions lies in the central 95 % of ours."""
    p = problem(name)
    plans = [GA[setting].plan(p, rng.stream(0, trial)) for trial in range(200)]
    epochs = [plan.epochs for plan in plans if plan.feasible]
    low, high = np.percentile(epochs, [2.5, 97.5])
    assert all(low <= e <= high for e in PAPER[name, setting])


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (("kg18_test9", 0), "map.map_class"),
        (("kg18_test1", -1), "map.instance: got -1, expected an integer from 0 to 4294967295"),
        (("kg18_test1", 2**32), "map.instance: got 4294967296, expected an integer from 0 to "),
    ],
)
def test_unknown_classes_and_instances_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        Reader(*values)
