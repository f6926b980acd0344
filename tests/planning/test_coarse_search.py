"""Search from coarse to fine: paths that are free, seldom much dearer than the cheapest."""

import numpy as np
import pytest

from gapath.grid import GridMap
from gapath.planning import coarse_search
from gapath.planning.coarse_search import coarse_path
from gapath.planning.flaw import flaw
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, PlanStatus, Problem


def hills(number, rows=90, cols=130, share=0.1):
    """Smooth ground with obstacles strewn on it."""
    random = np.random.default_rng(number)
    y, x = np.mgrid[:rows, :cols]
    weights = 0.4 + 0.35 * np.sin(x / 9 + number) * np.cos(y / 7)
    weights[random.random((rows, cols)) < share] = 1.0
    weights[2, 3] = weights[-3, -4] = 0.5
    return Problem(
        GridMap("hills", weights), (3, 2), (cols - 4, rows - 3), CornerCutting(number % 4)
    )


def test_a_map_of_few_fields_is_searched_as_it_is():
    for number in range(4):
        problem = hills(number)
        plan = coarse_path(problem)
        assert plan.cost == shortest_path(problem).cost
        assert flaw(problem, plan.path, plan.cost) is None


@pytest.mark.parametrize("large", [100, 800])
def test_from_coarse_to_fine_paths_are_free_and_hardly_dearer(monkeypatch, large):
    monkeypatch.setattr(coarse_search, "LARGE", large)
    ratios, fields = [], []
    for number in range(12):
        problem = hills(number)
        plan, best = coarse_path(problem), shortest_path(problem)
        assert plan.feasible and best.feasible
        assert flaw(problem, plan.path, plan.cost) is None
        ratios.append(plan.cost / best.cost)
        fields.append(plan.expansions / best.expansions)
    assert min(ratios) >= 1 and np.mean(ratios) < 1.1
    assert np.mean(fields) < 0.9


def test_where_nothing_leads_along_the_coarse_path_nothing_is_found(monkeypatch):
    monkeypatch.setattr(coarse_search, "LARGE", 100)
    weights = np.full((80, 80), 0.5)
    weights[:, 40] = 1.0  # a wall that blocks do not show, with its door far away
    weights[79, 40] = 0.5
    problem = Problem(GridMap("wall", weights), (2, 2), (77, 2))
    assert coarse_path(problem).status is PlanStatus.NOT_FOUND
    assert shortest_path(problem).feasible


def test_ends_in_blocks_of_obstacles_are_left(monkeypatch):
    monkeypatch.setattr(coarse_search, "LARGE", 64)
    weights = np.full((48, 48), 0.5)
    weights[0:4, 0:4] = weights[44:48, 44:48] = 1.0
    weights[3, 3] = weights[44, 44] = 0.5
    plan = coarse_path(Problem(GridMap("ends", weights), (3, 3), (44, 44)))
    assert plan.feasible
