"""What the Rerun recording of a drive holds, read back from its file."""

import dataclasses
import math

import numpy as np
import pytest
import rerun as rr
from log_events import example_drives, logged
from matplotlib.path import Path as Polygon
from recordings import centres, read, record, rerun_command

from gapath.driving.followed import followed
from gapath.driving.sensed import sensed
from gapath.events import (
    NEVER_LEFT,
    Called,
    DriveFinished,
    DriveStarted,
    Mode,
    Outcome,
    PathsChanged,
    Stepped,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.kernels.field_of_view import HEADING_X, HEADING_Y, sense
from gapath.problem import Answer, PlanStatus, Problem
from gapath.recorders.rerun import drive_scene


@pytest.fixture(autouse=True)
def strict():
    rr.set_strict_mode(True)  # errors are only warnings otherwise
    yield
    rr.set_strict_mode(False)


@pytest.fixture(scope="module")
def events():
    """The events of the first drive, and what is recorded of it at which step."""
    return example_drives(trials=1)


@pytest.fixture
def found(tmp_path, events):
    assert record(tmp_path, events) == ["trial-0.rrd"]
    return read(tmp_path / "trial-0.rrd")


def of(events, kind):
    return [event for event in events if isinstance(event, kind)]


def test_the_known_map_grows(found, events):
    grid = events[0].problem.map
    expected = [[0] * 9 for _ in range(7)]

    def see(x, y):
        weight = grid.weights[y, x]
        expected[y][x] = 101 if weight == 1 else 1 + math.floor(100 * round(weight * 65536) / 65536)

    see(0, 0)
    see(8, 6)
    pictures = found["/map/known", "SegmentationImage:buffer"]
    for step, (shown_at, picture) in zip(of(events, Stepped), pictures, strict=True):
        for x, y in step.fields.tolist():
            see(x, y)
        assert shown_at == step.step
        assert np.array(picture, dtype=np.uint8).reshape(7, 9).tolist() == expected
    context = found["/map/known", "AnnotationContext:context"][0]
    assert len(context) == 102


def test_large_known_maps_have_fewer_pictures(tmp_path, events, monkeypatch):
    monkeypatch.setattr(drive_scene, "_PICTURES", 63 * 3)
    record(tmp_path, events)
    shown = read(tmp_path / "trial-0.rrd")["/map/known", "SegmentationImage:buffer"]
    assert [step for step, _ in shown] == [0, 4, 8, 10]


def test_the_robot_and_its_trail(found, events):
    steps = of(events, Stepped)
    places = [list(step.place) for step in steps]
    at = found["/map/robot", "Points2D:positions"]
    assert at == [(step.step, centres([step.place])) for step in steps]
    before = [places[0], *places[:-1]]
    pieces = [[centres(pair)] for pair in zip(before, places, strict=True)]
    assert [row for _, row in found["/map/trail", "LineStrips2D:strips"]] == pieces
    arrows = [row[0] for _, row in found["/map/robot/heading", "Arrows2D:vectors"]]
    directions = [(HEADING_X[step.heading], HEADING_Y[step.heading]) for step in steps]
    assert np.sign(arrows).tolist() == [list(direction) for direction in directions]


@pytest.mark.parametrize("heading", range(8))
@pytest.mark.parametrize("layers", [0, 1, 4])
def test_the_outline_holds_what_the_sensor_sees(heading, layers):
    table, seen = np.zeros((15, 15), dtype=np.int32), np.zeros((15, 15), dtype=np.bool_)
    news, least = np.empty((2, (layers + 1) ** 2), dtype=np.int64), np.zeros(1, dtype=np.int64)
    count = sense(table, table.copy(), seen, 7, 7, heading, layers, False, news, 0, least)
    outline = sensed(layers, heading) + 7.5
    y, x = np.mgrid[0:15, 0:15]
    inside = Polygon(outline).contains_points(np.stack([x.ravel(), y.ravel()], axis=1) + 0.5)
    assert np.flatnonzero(inside).tolist() == sorted(news[0, :count].tolist())


def test_it_looks_from_where_it_was(found, events):
    steps = of(events, Stepped)
    views = found["/map/field_of_view", "LineStrips2D:strips"]
    for before, step, (_, (outline,)) in zip(steps[:-1], steps[1:], views[1:], strict=True):
        outline = np.array(outline)
        gap = np.abs(outline - (np.array(before.place) + 0.5)).max(axis=1).min()
        assert gap == 0.5 and np.ptp(outline, axis=0).max() in (2, 3), step


def test_paths_where_they_change(found, events):
    changed = {event.step: event.past.tolist() for event in of(events, PathsChanged)}
    follows = followed(events[0].problem, events)
    now = [each.path.tolist() for each in follows]
    again = {*changed, *(step for step, each in enumerate(follows) if each.cut)}
    assert again > {*changed}  # what it sees cuts the first path
    for entity, paths in (
        ("/map/current_path", [(step, now[step]) for step in sorted(again)]),
        ("/map/past_path", list(changed.items())),
    ):
        expected = [(step, [centres(path)] if len(path) > 1 else []) for step, path in paths]
        assert found[entity, "LineStrips2D:strips"] == expected


def test_an_answer_is_shown_in_its_step_only(found, events):
    first, *_, last = [call for call in of(events, Called) if call.adopted]
    assert (first.part, last.part) == ("C", "A")
    for call in (first, last):
        shown = found[f"/map/calls/{call.part}/adopted", "LineStrips2D:strips"]
        assert shown == [(call.step, [centres(call.answer.path.tolist())]), (call.step + 1, [])]
    assert not any(entity.endswith("not_adopted") for entity, _ in found)  # none had a path
    texts = [(step, text[0]) for step, text in found["/calls", "TextLog:text"]]
    assert texts == [
        (1, "#1 C0 found: 2 in 3 epochs, adopted"),
        (2, "#2 B0 not found: 300000 in 9 epochs"),
        (4, "#4 C0 not found: 300000 in 9 epochs"),
        (4, "#4 C1 not found: 300000 in 9 epochs"),
        (5, "#5 A0 found: 3.5 in 2 epochs, adopted"),
    ]


def test_a_call_that_comes_again_step_by_step_is_listed_once(tmp_path, events):
    path = np.array([[0, 0], [1, 1]], dtype=np.int32)
    along = [Answer(PlanStatus.FOUND, path, cost) for cost in (7.5, 7.5, 7.5, 7.0, 7.0)]
    calls = [Called(step, 0, "C", 0, True, answer)
             for step, answer in zip((1, 2, 3, 4, 6), along, strict=True)]  # fmt: skip
    others = [event for event in events if not isinstance(event, Called)]
    record(tmp_path, [*others[:-2], *calls, *others[-2:]])
    found = read(tmp_path / "trial-0.rrd")["/calls", "TextLog:text"]
    assert [(step, text[0]) for step, text in found] == [
        (1, "#1 C0 found: 7.5, adopted, 3 steps in a row"),
        (4, "#4 C0 found: 7, adopted"),
        (6, "#6 C0 found: 7, adopted"),
    ]


def test_modes_as_a_band(found):
    assert found["/mode", "StateChange:state"] == [
        (0, ["explore"]), (1, ["replan"]), (2, ["explore"]), (4, ["return"]), (5, ["explore"]),
    ]  # fmt: skip


def test_cost_left(found, events):
    expected = [each.left for each in followed(events[0].problem, events)]
    drawn = [row[0] for _, row in found["/cost/left", "Scalars:scalars"]]
    np.testing.assert_array_equal(drawn, expected)
    assert np.isnan(expected).tolist().count(False) > 5


def test_time_where_it_is_known(found, events, tmp_path):
    seconds = [step.seconds for step in of(events, Stepped)]
    drawn = [row[0] for _, row in found["/time/step", "Scalars:scalars"]]
    np.testing.assert_allclose(drawn, np.array(seconds) * 1000)
    record(tmp_path, map(logged, events))  # as they come from a log
    again = read(tmp_path / "trial-0.rrd")
    assert set(found) - set(again) == {key for key in found if key[0] == "/time/step"}


def test_text(found):
    text = found["/text", "TextDocument:text"][0]
    for part in ("kg18 on", "The robot reached the target", "| outcome | reached |",
                 "| steps | 10 |", "| calls of part C | 3 |", "| seed, trial | 7, 0 |",
                 "navigator.kind: "):  # fmt: skip
        assert part in text


def test_a_drive_that_knows_no_way_and_never_calls(tmp_path, events):
    run, nothing = events[0], np.empty((0, 2), dtype=np.int32)
    first = dataclasses.replace(of(events, Stepped)[0], seconds=math.nan)
    enclosed = dataclasses.replace(run, optimal_path=nothing, optimal_cost=math.inf)
    start, end = DriveStarted(0, 0, 1, 0.5, 100), DriveFinished(0, 0, Outcome.OVERRAN, 0, 0)
    record(tmp_path, [enclosed, TrialStarted(0, 0, 7), start, first, end])
    found = read(tmp_path / "trial-0.rrd")
    assert "| shortest | no way |" in found["/text", "TextDocument:text"][0]
    assert "The robot used up its steps" in found["/text", "TextDocument:text"][0]
    stayed = DriveFinished(0, 0, Outcome.RETURNED, 3, 3)
    record(tmp_path, [enclosed, TrialStarted(0, 0, 7), start, first, stayed])
    text = read(tmp_path / "trial-0.rrd")["/text", "TextDocument:text"][0]
    assert f"The robot {NEVER_LEFT}" in text


def test_events_that_no_other_scene_fits_show_the_map_and_the_way(tmp_path, events):
    record(tmp_path, [event for event in events if not isinstance(event, DriveStarted)])
    found = read(tmp_path / "trial-0.rrd")
    places = [step.place for step in of(events, Stepped)]
    assert found["/map/way", "LineStrips2D:strips"] == [centres(places)]
    assert [row for _, row in found["/map/robot", "Points2D:positions"]] == [
        centres([place]) for place in places
    ]
    assert "| ended | reached |" in found["/text", "TextDocument:text"][0]
    assert ("/map", "Image:buffer") in found
    record(tmp_path, [event for event in events if not isinstance(event, DriveStarted | Stepped)])
    found = read(tmp_path / "trial-0.rrd")
    last = of(events, PathsChanged)[-1].path.tolist()
    assert found["/map/way", "LineStrips2D:strips"] == [centres(last)]


def test_the_files_are_verified_and_equal_for_equal_events(tmp_path, events):
    for name in "ab":
        (tmp_path / name).mkdir()
        record(tmp_path / name, events)
    a, b = (tmp_path / name / "trial-0.rrd" for name in "ab")
    verified = rerun_command("rrd", "verify", a)
    assert verified.returncode == 0, verified.stderr
    assert repr(read(a)) == repr(read(b))  # `rrd compare` tells NaN from NaN


def test_steps_begin_at_0_in_every_drive(tmp_path):
    record(tmp_path, example_drives(), trials=[1])
    found = read(tmp_path / "trial-1.rrd")
    assert [step for step, _ in found["/map/robot", "Points2D:positions"]] == list(range(8))


def long_drive(steps=500):
    """A drive through a map of 100 x 50 with a new path every fourth step."""
    rng = np.random.default_rng(3)
    weights = np.full((50, 100), 0.5)
    weights[rng.random((50, 100)) < 0.3] = 1.0
    weights[0, 0] = weights[49, 99] = 0.0
    grid = GridMap("long", weights)
    run = dataclasses.replace(example_drives(1)[0], problem=Problem(grid, (0, 0), (99, 49)))
    yield run
    yield TrialStarted(0, 0, 7)
    yield DriveStarted(0, 0, 1, 0.5, 2000)
    for step in range(steps):
        x, y = int(50 + 40 * math.cos(step / 80)), int(25 + 20 * math.sin(step / 50))
        if step % 4 == 0:
            across = np.arange(x, 100, dtype=np.int32)
            path = np.stack([across, (across * 7 + step) % 50], axis=1).astype(np.int32)
            part, adopted, found = "ABC"[step % 3], step % 8 == 0, PlanStatus.FOUND
            answer = Answer(found, path, 40.0, epochs=10, evaluations=400)
            yield Called(step, 0, part, 0, adopted, answer)
            yield PathsChanged(step, 0, path, path[::-1])
        fields = np.array([[x + i - 3, y + j - 3] for i in range(4) for j in range(4)], np.int32)
        entries = grid.table[fields[:, 1], fields[:, 0]]
        yield Stepped(step, 0, (x, y), step % 8, Mode(step // 9 % 3), fields, entries, 1e-4)
    yield DriveFinished(steps - 1, 0, Outcome.REACHED, steps - 1, 0)


def test_long_drives_are_small(tmp_path):
    events = list(long_drive())
    record(tmp_path, events)
    assert (tmp_path / "trial-0.rrd").stat().st_size < 1_000_000
