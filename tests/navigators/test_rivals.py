"""The rivals: exact planners on what is known, in the same loop."""

import numpy as np
import pytest
from drive_strategies import worlds
from hypothesis import given

from gapath.api import load_map
from gapath.components import build
from gapath.discovery import yaml_names, yaml_values
from gapath.driving.drive import Sensor, drive
from gapath.driving.known_map import KnownMap
from gapath.driving.navigation import Situation
from gapath.driving.world import Changes
from gapath.events import Mode, Outcome
from gapath.grid import GridMap
from gapath.navigators import dstar_lite, replan_astar, straight_astar
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Problem

RIVALS = [dstar_lite.Navigator(), replan_astar.Navigator(), straight_astar.Navigator()]
STATIC = Changes(0, 1, 1)
RULES = list(CornerCutting)
SENSOR = Sensor(4, False)


@pytest.mark.parametrize("rival", RIVALS, ids=lambda rival: rival.__module__)
@given(problem=worlds(RULES))
def test_the_target_is_reached_wherever_it_can_be(rival, problem):
    driven = drive(problem, rival, SENSOR, STATIC, 0, 0, 3000, 0.5)
    reachable = shortest_path(problem).feasible
    assert driven.outcome is (Outcome.REACHED if reachable else Outcome.RETURNED)


def with_floor(problem, weight):
    """The same obstacles; everything else costs the same."""
    grid = GridMap("floor", np.where(problem.map.obstacles, 1.0, weight))
    return Problem(grid, problem.start, problem.target, problem.corner_cutting)


@pytest.mark.parametrize("rival", RIVALS[1:], ids=lambda rival: rival.__module__)
@given(problem=worlds(RULES))
def test_where_nothing_costs_anything_drives_are_those_where_everything_costs_the_same(
    rival, problem
):
    free, usual = (
        drive(with_floor(problem, weight), rival, SENSOR, STATIC, 0, 0, 3000, weight)
        for weight in (0.0, 0.5)
    )
    assert [frame.place for frame in free.frames] == [frame.place for frame in usual.frames]


COMPLETE = [
    name
    for name in yaml_names("navigator")
    if build("navigator", yaml_values("navigator", name), "navigator").complete
]


@pytest.mark.parametrize("unknown", [0.0, 0.5])
@pytest.mark.parametrize("name", COMPLETE)
def test_where_known_fields_cost_nothing_nobody_wanders(name, unknown):
    navigator = build("navigator", yaml_values("navigator", name), "navigator")
    for map_name in ("kg18_map1", "kg18_map4"):
        grid = load_map(map_name)
        problem = Problem(grid, grid.start, grid.target)
        usual = drive(problem, navigator, SENSOR, STATIC, 0, 0, 2000, 0.5)
        free = drive(with_floor(problem, 0.0), navigator, SENSOR, STATIC, 0, 0, 2000, unknown)
        assert free.outcome is usual.outcome is Outcome.REACHED
        assert len(free.frames) < 3 * len(usual.frames)


@given(problem=worlds(RULES))
def test_dstar_lite_is_on_a_cheapest_path_in_every_step(problem):
    """Equal in cost to A* from scratch on what the robot knew when it decided."""
    driven = drive(problem, RIVALS[0], Sensor(2, True), STATIC, 0, 0, 300, 0.5)
    known = KnownMap(problem.map, problem.start, problem.target, 0.5)
    place = problem.start
    for frame, following in zip(driven.frames, driven.frames[1:], strict=False):
        known._table.ravel()[frame.news] = frame.entries
        known._least[0] = 0  # the news came by without `look`
        optimum = shortest_path(Situation(known, place, problem.target, problem.corner_cutting))
        path = following.decision.path
        assert (path is not None) == optimum.feasible
        if path is not None:
            assert known.table[path[:, 1], path[:, 0]].sum() / 65536 == optimum.cost
        place = following.place


def wall_problem():
    values = np.full((30, 60), 0.5)
    values[8:20, 30] = 1.0
    return Problem(GridMap("wall", values), (2, 12), (57, 12))


def test_straight_astar_asks_only_at_the_wall_and_goes_straight_again_behind_it():
    driven = drive(wall_problem(), RIVALS[2], SENSOR, STATIC, 0, 0, 2000, 0.5)
    steps = driven.frames[1:]
    asked = [i for i, frame in enumerate(steps) if frame.decision.calls]
    places = [frame.place for frame in driven.frames]
    assert places[asked[0]][0] >= 25
    assert all(y == 12 for _, y in places[: asked[0] + 1])
    straight = (leg for leg in driven.legs[1:] if leg.decision.moved.memory)
    behind = next(leg for leg in straight if leg.passed[0][0] > 30)
    x, y = behind.decision.path[0]
    n = 57 - x
    line = [y + np.floor(i * (12 - y) / n + 0.5) for i in range(n + 1)]
    assert behind.decision.path[:, 1].tolist() == line


def test_replan_astar_plans_only_when_its_path_is_blocked():
    empty = Problem(GridMap("empty", np.full((30, 60), 0.5)), (2, 12), (57, 12))
    for problem, least in ((empty, 1), (wall_problem(), 2)):
        driven = drive(problem, RIVALS[1], SENSOR, STATIC, 0, 0, 2000, 0.5)
        calls = [frame.decision.calls for frame in driven.frames[1:]]
        assert calls[0] and sum(map(bool, calls)) >= least
        assert sum(map(bool, calls)) < len(calls) / 3
        for before, frame in zip(driven.frames, driven.frames[1:], strict=False):
            if frame.decision.calls:
                assert frame.decision.mode is Mode.REPLAN
            elif before.decision is not None:
                assert frame.decision.path.tolist() == before.decision.path[1:].tolist()
