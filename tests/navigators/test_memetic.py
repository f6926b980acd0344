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


def test_it_plans_only_where_its_path_is_cut():
    values = np.full((60, 400), 0.5)
    values[22:40, 60] = 1.0
    found = driven(values, (2, 30), (390, 30))
    assert found.outcome is Outcome.REACHED
    decisions = [leg.decision for leg in found.legs[1:]]
    assert len(decisions) > 2
    assert all(len(now.calls) == 1 and now.mode is Mode.REPLAN for now in decisions)
    for before, now in pairwise(decisions):
        (x, y), path = now.path[0], before.path
        at = np.flatnonzero((path == (x, y)).all(axis=1))[0]
        ahead = path[at : at + 6]  # one step further than it sees
        assert (values[ahead[:, 1], ahead[:, 0]] == 1.0).any()


def test_in_a_blind_alley_it_turns_round_once():
    values = np.full((60, 120), 0.5)
    values[10:50, 80] = values[10, 40:81] = values[49, 40:81] = 1.0
    found = driven(values, (2, 25), (110, 25))
    assert found.outcome is Outcome.REACHED
    columns = np.array([frame.place[0] for frame in found.frames])
    turns = np.diff(np.sign(np.diff(columns)[np.diff(columns) != 0]))
    assert np.count_nonzero(turns) == 2  # back out of it, and on outside
