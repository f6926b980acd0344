"""The memetic navigator: a path that is cut is repaired, and only then."""

from itertools import pairwise

import numpy as np

from gapath.driving.drive import Sensor, drive
from gapath.driving.world import Changes
from gapath.events import Mode, Outcome
from gapath.grid import GridMap
from gapath.navigators.memetic import Navigator
from gapath.problem import Problem


def driven(values, start, target):
    problem = Problem(GridMap("drawn", values), start, target)
    return drive(problem, Navigator(), Sensor(4, False), Changes(0, 1, 1), 0, 0, 2000, 0.5)


def test_it_plans_where_its_path_is_cut_and_keeps_the_rest():
    values = np.full((60, 400), 0.5)
    values[22:40, 60] = 1.0
    found = driven(values, (2, 30), (390, 30))
    assert found.outcome is Outcome.REACHED
    decisions = [leg.decision for leg in found.legs[1:]]
    asked = [decision for decision in decisions if decision.calls]
    assert 2 <= len(asked) <= 10
    assert all(decision.mode is Mode.REPLAN for decision in asked)
    for before, after in pairwise(asked):
        assert after.path[-200:].tolist() == before.path[-200:].tolist()


def test_in_a_blind_alley_it_turns_round_once():
    values = np.full((60, 120), 0.5)
    values[10:50, 80] = values[10, 40:81] = values[49, 40:81] = 1.0
    found = driven(values, (2, 25), (110, 25))
    assert found.outcome is Outcome.REACHED
    columns = np.array([frame.place[0] for frame in found.frames])
    turns = np.diff(np.sign(np.diff(columns)[np.diff(columns) != 0]))
    assert np.count_nonzero(turns) == 2  # back out of it, and on outside
