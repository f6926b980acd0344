"""What is drawn of a plan, whoever planned: planners are found, not listed."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import gapath
from gapath.discovery import yaml_names
from gapath.problem import Plan, PlanStatus

WALL = np.full((24, 24), 0.5)
WALL[:, 12] = 1.0
GAP = WALL.copy()
GAP[8:16, 12] = 0.5


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
            with pytest.raises(gapath.InputError, match=r"plan\.evolution: got no history"):
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
            with pytest.raises(gapath.InputError, match=r"plan\.evolution: got no history"):
                plan.animate()
            continue
        animation, axes = plan.animate(), Figure().subplots()
        show = animation.scene(axes)
        for epoch in animation.moments:
            show(epoch)
            assert axes.lines[0].get_xydata().tolist() == history.way_points[epoch].tolist()
        assert epoch == plan.epochs - 1


def test_a_plan_that_does_not_know_its_problem_says_so():
    plan = Plan(PlanStatus.NOT_FOUND)
    for draw in (plan.plot, plan.animate):
        with pytest.raises(gapath.InputError, match=r"plan\.problem: got None, expected a plan of"):
            draw()
