"""What is drawn of a plan, whoever planned: planners are found, not listed."""

from dataclasses import replace

import numpy as np
import pytest
from gapath_example import bender
from matplotlib.figure import Figure

import gapath
from gapath.discovery import yaml_names
from gapath.kernels import rng
from gapath.problem import Plan, PlanStatus, Problem

WALL = np.full((24, 24), 0.5)
WALL[:, 12] = 1.0
GAP = WALL.copy()
GAP[8:16, 12] = 0.5


INFEASIBLE = PlanStatus.INFEASIBLE
REASONS = {
    True: r"plan\.evolution: got no history, as no path exists, expected a genetic",
    False: r"plan\.evolution: got no history, expected the plan of a genetic algorithm: other",
}
"""Why a plan has no history, by whether there is no path at all."""


@pytest.fixture(params=yaml_names("planner"))
def plans(request):
    """Plans on a map with a wide gap and on one without."""
    grids = gapath.GridMap("gap", GAP), gapath.GridMap("wall", WALL)
    plans = [gapath.plan(grid, (2, 2), (21, 21), planner=request.param) for grid in grids]
    assert not plans[1].feasible
    return plans


def test_a_plot_has_the_map_the_path_and_its_way_points(plans):
    for plan in plans:
        axes = plan.plot(Figure().subplots())
        (image,) = axes.images
        assert np.ma.getdata(image.get_array()).tolist() == plan.problem.map.weights.tolist()
        shown = [line.get_xydata().tolist() for line in axes.lines]
        assert shown == [points for points in (plan.path.tolist(), plan.lines().tolist()) if points]
        assert (plan.status.sentence in axes.get_title()) is not plan.feasible
        assert {text.get_text() for text in axes.texts} == {"S", "T"}


def test_a_convergence_plot_has_every_epoch(plans):
    for plan in plans:
        history = plan.evolution
        if history is None:
            with pytest.raises(gapath.InputError, match=REASONS[plan.status is INFEASIBLE]):
                plan.convergence()
            continue
        best, mean = plan.convergence(Figure().subplots()).lines
        assert [*best.get_xdata()] == [*mean.get_xdata()] == list(range(1, plan.epochs + 1))
        assert np.array_equal(best.get_ydata(), history.best)
        assert np.array_equal(mean.get_ydata(), history.mean)


def test_an_animation_has_the_best_path_of_each_moment(plans):
    for plan in plans:
        history = plan.evolution
        if history is None:
            with pytest.raises(gapath.InputError, match=REASONS[plan.status is INFEASIBLE]):
                plan.animate()
            continue
        animation, axes = plan.animate(), Figure().subplots()
        show = animation.scene(axes)
        for epoch in animation.moments:
            show(epoch)
            assert axes.lines[0].get_xydata().tolist() == history.way_points[epoch].tolist()
        assert epoch == plan.epochs - 1


@pytest.fixture
def bent():
    """A plan whose planner tells what its population took in."""
    ground = GAP * np.where(GAP < 1, np.random.default_rng(1).random(GAP.shape), 1)
    problem = Problem(gapath.GridMap("ground", ground), (2, 2), (21, 21))
    planner = bender.Planner(individuals=3, epochs=40, tries=60)
    return replace(planner.plan(problem, rng.stream(4)), problem=problem)


def test_an_animation_shows_all_individuals_whenever_one_changed(bent):
    population, axes = bent.evolution.population, Figure().subplots()
    animation = bent.animate()
    assert {*(population.epochs - 1).tolist()} <= {*animation.moments}
    show = animation.scene(axes)
    (others,) = axes.collections
    for epoch in animation.moments:
        show(epoch)
        standing = population.standing(bent.epochs)[epoch].tolist()
        expected = [population.polygon(i).tolist() for i in standing if i >= 0]
        assert [segment.tolist() for segment in others.get_segments()] == expected
    assert len(animation.frames) == len(animation.moments)


def test_shares_come_to_the_cost_of_the_path(bent):
    first, *lowered = bent.shares().values()
    assert list(bent.shares()) == list(bender.NAMES)
    assert first - sum(lowered) == bent.cost < first
    assert gapath.plan(bent.problem.map, (2, 2), (21, 21), planner="astar").shares() == {}


def test_a_plan_that_does_not_know_its_problem_says_so():
    plan = Plan(PlanStatus.NOT_FOUND)
    for draw in (plan.plot, plan.animate):
        with pytest.raises(gapath.InputError, match=r"plan\.problem: got None, expected a plan of"):
            draw()
