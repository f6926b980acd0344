"""A drive as its events tell it."""

import math

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.path import Path as Polygon

import gapath
from gapath.components import build
from gapath.discovery import yaml_values
from gapath.driving.drive import Sensor, drive
from gapath.driving.followed import followed
from gapath.driving.retold import Drive
from gapath.driving.told import drive_events
from gapath.driving.world import Changes
from gapath.errors import InputError
from gapath.events import Called, Outcome, Stepped
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.problem import Problem


class Watching:
    """A navigator that hands on, and remembers what its robot knew."""

    complete = True

    def __init__(self, name):
        self.inner = build("navigator", yaml_values("navigator", name), "navigator")
        self.tables = []

    def begin(self, query):
        self.map = query.map
        return self.inner.begin(query)

    def step(self, state, query, news, streams):
        self.tables.append(query.map.table.copy())
        return self.inner.step(state, query, news, streams)._replace(fields=1)


CASES = {
    "straight on": ("kg18_map1", "replan_astar", Changes(0, 1, 1), None, 2000),
    "blind alleys": ("kg18_map4", "kg18", Changes(0, 1, 1), None, 2000),
    "a map that changes": ("kg18_map2", "replan_astar", Changes(3, 20, 6), None, 2000),
    "walls known before": ("kg18_map3", "replan_astar", Changes(0, 1, 1), "kg18_map3", 2000),
    "along walls": ("kg18_map4", "memetic", Changes(0, 1, 1), None, 2000),
    "too few steps": ("kg18_map3", "kg18", Changes(0, 1, 1), None, 30),
}


@pytest.fixture(params=CASES.values(), ids=CASES)
def case(request):
    name, navigator, changes, before, limit = request.param
    grid = gapath.load_map(name)
    problem, watching = Problem(grid, grid.start, grid.target), Watching(navigator)
    before = gapath.load_map(before) if before else None
    driven = drive(problem, watching, Sensor(4, False), changes, 5, 0, limit, 0.5, before)
    return Drive(problem, tuple(drive_events(driven, grid.cols, 5, 0, 17))), driven, watching


def test_it_tells_what_was_driven(case):
    told, driven, _ = case
    places = [frame.place for frame in driven.frames]
    assert [tuple(place) for place in told.places.tolist()] == places
    moved = [place for i, place in enumerate(places) if i == 0 or place != places[i - 1]]
    assert [tuple(place) for place in told.path.tolist()] == moved
    assert (told.outcome, told.steps) == (driven.outcome, len(places) - 1)
    assert told.reached == (driven.outcome is Outcome.REACHED)
    calls = [call for frame in driven.frames[1:] for call in frame.decision.calls]
    assert len(told.calls) == len(calls)
    assert all(isinstance(call, Called) for call in told.calls)


def weights_of(table):
    return np.where(table >= OBSTACLE, 1.0, table / SCALE)


def test_what_was_known_at_a_step_is_what_the_navigator_was_shown(case):
    told, _, watching = case
    tables = [*watching.tables, watching.map.table]
    assert len(tables) == told.steps + 1
    for step in {0, 1, told.steps // 2, told.steps}:
        known = told.known(step)
        unknown = np.isnan(known)
        table = weights_of(tables[step])
        assert unknown.any()
        assert (table[~unknown] == known[~unknown]).all()
        assert (table[unknown] == 0.5).all()
    assert np.array_equal(told.known(), told.known(told.steps), equal_nan=True)


def test_what_it_follows_ends_where_it_has_seen_the_path_cut(case):
    told, driven, watching = case
    tables = [*watching.tables, watching.map.table]
    every = followed(told.problem, told.events)
    assert len(every) == told.steps + 1
    assert every[0].path.tolist() == [] and math.isnan(every[0].left)
    for step, (now, frame) in enumerate(zip(every[1:], driven.frames[1:], strict=True), 1):
        path = frame.decision.path
        if path is None:
            assert now.path.tolist() == [] and not now.cut and math.isnan(now.left)
            continue
        path = path[int(tuple(path[1].tolist()) == frame.place) :]
        assert tuple(path[0].tolist()) == frame.place
        x, y = path.T
        assert now.left == weights_of(tables[step - 1])[y, x].sum()
        blocked = np.flatnonzero(tables[step][y, x] >= OBSTACLE)
        assert now.cut == (len(blocked) > 0)
        assert now.path.tolist() == path[: blocked[0] if now.cut else None].tolist()


def test_a_step_that_there_was_not_is_refused(case):
    told = case[0]
    for step in (-1, told.steps + 1):
        with pytest.raises(InputError, match=f"step: got {step}, expected an integer from 0 to"):
            told.known(step)


def test_it_draws_the_way_and_tints_what_was_never_seen(case):
    told = case[0]
    axes = told.plot(Figure().subplots())
    (line,) = axes.lines
    assert line.get_xydata().tolist() == told.path.tolist()
    grid, tint = axes.images
    weights = told.problem.map.weights
    assert np.ma.getdata(grid.get_array()).tolist() == weights.tolist()
    assert (tint.get_array()[..., 3] > 0).tolist() == np.isnan(told.known()).tolist()
    assert told.outcome.name.lower() in axes.get_title()
    html = told._repr_html_()
    assert "data:image/png" in html and str(told.steps) in html


def test_its_animation_shows_every_chosen_moment_as_it_was(case):
    told = case[0]
    animation = told.animate()
    axes = Figure().subplots()
    show = animation.scene(axes)
    assert list(animation.moments)[:: len(animation.moments) - 1] == [0, told.steps]
    for step in (0, told.steps // 2, told.steps):
        show(step)
        path, way, robot, seen = (line.get_xydata() for line in axes.lines)
        fields = [event for event in told.events if isinstance(event, Stepped)][step].fields
        near = np.abs(fields - robot[-1]).max(axis=1) <= 4  # others were known before
        assert Polygon(seen).contains_points(fields[near].tolist()).all()
        assert near.all() or step == 0
        assert way.tolist() == told.places[: step + 1].tolist()
        assert robot.tolist() == told.places[step : step + 1].tolist()
        tint = axes.images[1].get_array()[..., 3] > 0
        assert tint.tolist() == np.isnan(told.known(step)).tolist()
        if len(path):  # the path on which it goes on begins there
            assert told.places[step].tolist() == path.astype(int).tolist()[0]
        assert f"step {step} of {told.steps}" in axes.get_title()
