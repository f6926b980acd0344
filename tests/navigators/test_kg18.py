"""KG18's step function against its slow twin, its bound against the optimum."""

import naive_drive
import numpy as np
import pytest
from drive_strategies import queries, random_world, worlds
from hypothesis import example, given, settings
from hypothesis import strategies as st
from strategies import planner

from gapath.driving.drive import Sensor, drive
from gapath.driving.world import Changes
from gapath.errors import InputError
from gapath.events import Mode
from gapath.grid import GridMap
from gapath.kernels.units import SCALE
from gapath.navigators.kg18 import Navigator
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Problem

STATIC = Changes(0, 1, 1)
RULES = list(CornerCutting)


def navigator(**values):
    """KG18's step function with small planners, so that they miss now and then."""
    settings = {
        "retreat": planner(population=16, control_points=5, max_epochs=3),
        "explore": planner(population=12, min_epochs=3, max_epochs=3),
        "replan": [
            planner(population=16, control_points=k, min_epochs=2, max_epochs=6) for k in (4, 5)
        ],
        "explore_interval": 2,
        "retreat_interval": [1, 3],
        "return_penalty": 0.0,
    }
    return Navigator(**{**settings, **values})


def told(driven):
    """A drive as its slow twin tells it."""
    steps = []
    for frame in driven.frames[1:]:
        said = frame.decision
        path = None if said.path is None else [tuple(map(int, p)) for p in said.path]
        new = [c.plan.path for c in said.calls if c.adopted]
        new = [tuple(map(int, p)) for p in new[-1]] if new else []
        steps.append((frame.place, frame.heading, said.mode.name.lower(), path, said.past, new))
    return driven.outcome.name, steps


@settings(max_examples=120)
@given(
    worlds(RULES),
    st.integers(0, 10**6),
    st.integers(1, 4),
    st.booleans(),
    st.sampled_from([0.0, 0.4]),
    st.sampled_from([(1, 1), (2, 3), (1, 4)]),
)
# a path passes the target before its end
@example(random_world(829, CornerCutting.ONE_SIDE), 646, 1, False, 0.0, (1, 1))
def test_drives_equal_the_slow_twin(problem, seed, reach, occlusion, penalty, interval):
    pilot = navigator(return_penalty=penalty, retreat_interval=list(interval))
    sensor = Sensor(reach, occlusion)
    driven = drive(problem, pilot, sensor, STATIC, seed, 7, 150, 0.5)
    expected = naive_drive.kg18_drive(problem, pilot, sensor, seed, 7, 150, 0.5)
    assert told(driven) == expected


@given(queries())
def test_the_lower_bound_is_never_above_the_optimum(drawn):
    """So a path that costs no more cannot be beaten, and part B need not look."""
    _, query = drawn
    plan = shortest_path(query)
    if plan.feasible and query.start != query.target:
        assert navigator()._lower_bound(query) <= round(plan.cost * SCALE)


def test_a_drive_into_a_blind_alley_comes_back_out():
    """All three parts in one drive: C fails in the pocket, A goes back and finds a way."""
    values = np.full((40, 60), 0.5)
    values[8:32, 40] = values[8, 12:41] = values[31, 12:41] = 1.0
    problem = Problem(GridMap("pocket", values), (20, 20), (55, 20))
    pilot = navigator(
        replan=[planner(population=16, control_points=4, min_epochs=1, max_epochs=1)],
        retreat=planner(population=100, control_points=5, max_epochs=100),
        retreat_interval=[2, 3],
    )
    driven = drive(problem, pilot, Sensor(4, False), STATIC, 1, 0, 2000, 0.5)
    modes = {frame.decision.mode for frame in driven.frames[1:]}
    parts = {call.part for frame in driven.frames[1:] for call in frame.decision.calls}
    assert modes == set(Mode)
    assert {"A", "C"} <= parts
    waits = [
        i
        for i, frame in enumerate(driven.frames[1:])
        if any(call.part == "A" for call in frame.decision.calls)
    ]
    returning = [f.decision.mode is Mode.RETURN for f in driven.frames[1:]]
    first = returning.index(True)
    assert waits[0] - first in (2, 3)  # it moves back before its first call


@pytest.mark.parametrize(
    ("values", "where"),
    [
        ({"explore_interval": 0}, "explore_interval: got 0, expected an integer from 1 to 1000000"),
        ({"explore_interval": 10**6 + 1}, "explore_interval: got 1000001"),
        ({"retreat_interval": [1, 10**6 + 1]}, "retreat_interval: .* <= most <= 1000000"),
        ({"retreat_interval": [3, 2]}, "retreat_interval"),
        ({"retreat_interval": [0, 2]}, "retreat_interval"),
        ({"retreat_interval": [2]}, "retreat_interval"),
        ({"return_penalty": -1.0}, "return_penalty"),
        ({"return_penalty": float("nan")}, "return_penalty"),
        ({"replan": []}, "replan"),
    ],
)
def test_bad_settings(values, where):
    with pytest.raises(InputError, match=f"navigator.{where}"):
        navigator(**values)
