"""The memetic navigator: a path that is cut is repaired, and only then."""

from itertools import pairwise

import numpy as np

from gapath.driving.drive import Sensor, drive
from gapath.driving.known_map import KnownMap
from gapath.driving.navigation import Situation
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


def test_it_goes_back_without_asking_until_a_wall_vanishes():
    values = np.full((20, 60), 0.5)
    values[6:13, 40] = values[6:13, 46] = values[6, 40:47] = values[12, 40:47] = 1.0
    problem = Problem(GridMap("enclosed", values), (2, 9), (43, 9))
    navigator = Navigator()
    found = drive(problem, navigator, Sensor(4, False), Changes(0, 1, 1), 0, 0, 2000, 0.5)
    assert found.outcome is Outcome.RETURNED
    back = [leg.decision for leg in found.legs[1:] if leg.decision.mode is Mode.RETURN]
    assert len(back) > 20
    assert [len(decision.calls) for decision in back] == [1] + [0] * (len(back) - 1)

    known = KnownMap(problem.map, problem.start, problem.target, 0.5, problem.map)
    query = Situation(known, (20, 9), problem.target, problem.corner_cutting)
    news = np.empty(0, dtype=np.int64)
    gone = navigator.step(navigator.begin(query), query, news, None)
    assert gone.mode is Mode.RETURN and len(gone.calls) == 1
    for x, goes in ((30, False), (40, True)):  # an unknown field, one of the wall
        open_map = values.copy()
        open_map[9, x] = 0.5
        seen = known.look(GridMap("open", open_map).table, (x - 2, 9), 0, 3, False).news[0]
        assert len(seen)
        said = navigator.step(gone.stood, query, seen, None)
        assert (said.mode is not Mode.RETURN) == goes == (len(said.calls) > 0)
