"""What must hold in every drive, for every navigator: they are found, not listed."""

from importlib.resources import files

import numpy as np
import pytest
from drive_strategies import worlds
from hypothesis import given, settings
from hypothesis import strategies as st

from gapath.components import build
from gapath.discovery import kinds, yaml_values
from gapath.driving.drive import Sensor, drive
from gapath.driving.navigation import Navigator
from gapath.driving.world import Changes, World
from gapath.errors import InputError
from gapath.events import Mode, Outcome
from gapath.grid import GridMap
from gapath.kernels.lines import cuts_corner
from gapath.kernels.units import OBSTACLE
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Problem

STATIC = Changes(0, 1, 1)
LIMIT = 2000
RULES = list(CornerCutting)

YAMLS = sorted(
    path.name[:-5]
    for path in (files("gapath.conf") / "navigator").iterdir()
    if path.name.endswith(".yaml")
)
NAVIGATORS = {
    name: build("navigator", yaml_values("navigator", name), "navigator") for name in YAMLS
}

sensors = st.builds(Sensor, st.integers(1, 5), st.booleans())
every_navigator = pytest.mark.parametrize("name", YAMLS)


def examples(percent):
    """Draw so many per cent of the examples that the profile asks for."""
    return settings(max_examples=settings.default.max_examples * percent // 100)


def broken_rules(problem, driven, changes=STATIC, keys=(0, 0)):
    """Replay a drive on the true map and give all that should not have happened."""
    world = World(problem.map, changes, (problem.start, problem.target), *keys)
    known = np.full(problem.map.table.shape, -1, dtype=np.int32)
    place, mode = problem.start, Mode.EXPLORE
    rule = int(problem.corner_cutting)
    wrong = []
    for i, frame in enumerate(driven.frames):
        if i:
            if place == problem.target or (place == problem.start and mode is Mode.RETURN):
                wrong.append(f"step {i} after the end")
            world.advance(i - 1, place)
            mode = frame.decision.mode
        known.ravel()[frame.news] = frame.entries
        (x, y), (u, v) = place, frame.place
        if world.table[v, u] >= OBSTACLE:
            wrong.append(f"step {i} enters the obstacle {u, v}")
        if max(abs(u - x), abs(v - y)) > 1:
            wrong.append(f"step {i} jumps from {x, y} to {u, v}")
        if (u, v) != (x, y):
            if frame.decision.place != (u, v):
                wrong.append(f"step {i} goes where it was not sent")
            if cuts_corner(world.table, x, y, u, v, rule):
                wrong.append(f"step {i} cuts a corner from {x, y} to {u, v}")
        if i and frame.decision.past[-1] != place:
            wrong.append(f"step {i}: the past path does not end at the robot")
        if i and frame.decision.path is not None and tuple(frame.decision.path[0]) != place:
            wrong.append(f"step {i}: the path does not begin at the robot")
        place = (u, v)
    if not changes.every and (known[known >= 0] != problem.map.table[known >= 0]).any():
        wrong.append("a known field is not as it is")
    returned = place == problem.start and mode is Mode.RETURN
    ends = {
        Outcome.REACHED: place == problem.target,
        Outcome.RETURNED: returned and place != problem.target,
        Outcome.OVERRAN: place != problem.target and not returned,
    }
    if not ends[driven.outcome]:
        wrong.append(f"{driven.outcome.name} at {place}")
    return wrong


def test_every_navigator_has_a_yaml_and_every_yaml_a_navigator():
    assert {yaml_values("navigator", name)["kind"] for name in YAMLS} == set(kinds("navigator"))
    assert all(isinstance(navigator, Navigator) for navigator in NAVIGATORS.values())


@every_navigator
@examples(60)
@given(worlds(RULES), sensors, st.integers(0, 999))
def test_drives_keep_the_rules(name, problem, sensor, seed):
    driven = drive(problem, NAVIGATORS[name], sensor, STATIC, seed, 0, LIMIT, 0.5)
    assert not broken_rules(problem, driven)
    assert driven.outcome is not Outcome.OVERRAN
    assert len(driven.frames) <= LIMIT + 1
    reachable = shortest_path(problem).feasible
    if not reachable:
        assert driven.outcome is Outcome.RETURNED
        assert driven.frames[-1].place == problem.start
    elif NAVIGATORS[name].complete:
        assert driven.outcome is Outcome.REACHED


@every_navigator
@examples(25)
@given(
    worlds(RULES),
    sensors,
    st.builds(Changes, st.integers(1, 6), st.integers(1, 25), st.integers(1, 5)),
    st.integers(0, 999),
)
def test_drives_through_a_changing_map_keep_the_rules(name, problem, sensor, changes, seed):
    driven = drive(problem, NAVIGATORS[name], sensor, changes, seed, 2, 150, 0.5)
    assert not broken_rules(problem, driven, changes, (seed, 2))


@every_navigator
def test_an_enclosed_target_ends_at_the_start(name):
    values = np.full((20, 30), 0.5)
    values[6:13, 20] = values[6:13, 26] = values[6, 20:27] = values[12, 20:27] = 1.0
    problem = Problem(GridMap("enclosed", values), (2, 9), (23, 9))
    driven = drive(problem, NAVIGATORS[name], Sensor(4, False), STATIC, 0, 0, 2000, 0.5)
    assert driven.outcome is Outcome.RETURNED
    assert driven.frames[-1].place == problem.start
    assert len(driven.frames) > 30  # it went and looked
    assert not broken_rules(problem, driven)


@every_navigator
@examples(15)
@given(worlds(), st.integers(0, 99), st.sampled_from([STATIC, Changes(3, 9, 2)]))
def test_same_seed_same_drive(name, problem, seed, changes):
    def tell():
        driven = drive(problem, NAVIGATORS[name], Sensor(4, False), changes, seed, 5, 100, 0.5)
        return driven.outcome, [(f.place, f.heading, f.news.tolist()) for f in driven.frames]

    first = tell()
    drive(problem, NAVIGATORS[name], Sensor(2, True), changes, seed + 1, 6, 20, 0.5)
    assert tell() == first


@every_navigator
def test_a_drive_that_is_cut_short_overran(name):
    problem = Problem(GridMap("empty", np.full((20, 30), 0.5)), (2, 9), (27, 9))
    driven = drive(problem, NAVIGATORS[name], Sensor(4, False), STATIC, 0, 0, 7, 0.5)
    assert driven.outcome is Outcome.OVERRAN
    assert len(driven.frames) == 8
    nowhere = Problem(problem.map, (2, 9), (2, 9))
    driven = drive(nowhere, NAVIGATORS[name], Sensor(4, False), STATIC, 0, 0, 7, 0.5)
    assert (driven.outcome, len(driven.frames)) == (Outcome.REACHED, 1)


@every_navigator
def test_what_is_known_before_the_drive_is_not_driven_into(name):
    values = np.full((20, 30), 0.5)
    values[2:18, 15] = 1.0
    grid = GridMap("wall", values)
    problem = Problem(grid, (2, 9), (27, 9))
    knowing, learning = (
        drive(problem, NAVIGATORS[name], Sensor(4, False), STATIC, 3, 0, 500, 0.5, before)
        for before in (grid, None)
    )
    first = knowing.frames[1].decision.path
    if first is not None:
        assert not grid.obstacles[first[:, 1], first[:, 0]].any()
    assert not broken_rules(problem, knowing) and not broken_rules(problem, learning)


@pytest.mark.parametrize("reach", [-1, 0, 1001])
def test_bad_range(reach):
    with pytest.raises(InputError, match=r"sensor\.range"):
        Sensor(reach, False)
