"""The log as other people's readers understand it."""

import dataclasses
import math
import subprocess
import sys

import numpy as np
import pytest
from log_events import example, example_drives, write
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from gapath.events import (
    Called,
    DriveFinished,
    Evolved,
    Mode,
    Outcome,
    PathsChanged,
    Stepped,
    TrialFinished,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.problem import PlanStatus, Problem
from gapath.recorders.mcap import format as log_format
from gapath.recorders.mcap.messages import Messages
from gapath.store.settings import of_text

FORM = log_format.Form(log_format.LOG_VERSION, 100_000_000)

TYPES = log_format.TYPES
OWN = "gapath_msgs/msg/"


def test_a_foreign_reader_understands_it(tmp_path):
    run, *events = example()
    log = write([run, *events], tmp_path, chunk_messages=5)
    grid, found = run.problem.map, {}
    with log.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        for _, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            found.setdefault(channel.topic, []).append((message, decoded))
            assert message.log_time == message.publish_time
            if hasattr(decoded, "header"):
                assert decoded.header.frame_id == "map"
                stamp = decoded.header.stamp
                assert stamp.sec * 10**9 + stamp.nanosec == message.log_time

    shown = found["/map"][0][1]
    data = np.array(shown.data).reshape(shown.info.height, shown.info.width)
    assert data[-1, 1] == round(100 * grid.weights[0, 1])  # the last row is the top
    assert (data[::-1] == 100).tolist() == grid.obstacles.tolist()
    origin = shown.info.origin
    assert (origin.position.x, origin.position.y) == (1.0, -2.0)
    assert 2 * math.atan2(origin.orientation.z, origin.orientation.w) == pytest.approx(0.5)
    assert shown.info.resolution == pytest.approx(0.05)

    start = found["/start"][0][1].pose.position
    assert (start.x, start.y) == tuple(grid.to_metres(np.array([[0, 0]]))[0])
    optimal = found["/optimal_path"][0][1].poses
    metres = grid.to_metres(run.optimal_path).tolist()
    assert [[p.pose.position.x, p.pose.position.y] for p in optimal] == metres

    ends = [event for event in events if isinstance(event, TrialFinished)]
    assert len(found["/path"]) == sum(end.answer.feasible for end in ends)
    for end, (message, result) in zip(ends, found["/result"], strict=True):
        assert message.log_time == end.step * FORM.step_ns
        answer = end.answer
        assert (result.status, result.feasible) == (answer.status, answer.feasible)
        assert list(result.path) == answer.path.ravel().tolist()
        shown = (answer.obstacles, answer.weights, answer.vln, answer.cost)
        assert (result.obstacles, result.weights, result.vln, result.cost) == shown
    evolved = [event.evolution for event in events if isinstance(event, Evolved)]
    for evolution, (_, run_of_ga) in zip(evolved, found["/ga_run"], strict=True):
        assert list(run_of_ga.best) == evolution.best.tolist()
        assert list(run_of_ga.way_points) == evolution.way_points.ravel().tolist()
        assert run_of_ga.genotype == "control_points"
    texts = [(line.level, line.msg) for _, line in found["/log"]]
    assert [level for level, _ in texts] == [20, 30, 30, 20]  # two trials found nothing
    assert texts[1][1].startswith("trial 0: ")
    assert of_text(found["/trial_start"][0][1].settings) == run.settings
    assert found["/run_end"][0][1].found == 4

    (frame,) = found["/tf_static"][0][1].transforms
    assert (frame.header.frame_id, frame.child_frame_id) == ("world", "map")
    turn, shift = frame.transform.rotation, frame.transform.translation
    assert (turn.x, turn.y, turn.z, turn.w, shift.x, shift.y, shift.z) == (0, 0, 0, 1, 0, 0, 0)


def test_a_field_that_can_be_passed_never_shows_as_an_obstacle(tmp_path):
    run = example()[0]
    grid = GridMap("almost", np.array([[0.0, 0.999, 1.0, 0.0]]))
    problem = Problem(grid, (0, 0), (3, 0))
    run = dataclasses.replace(run, problem=problem)
    data = next(Messages(run, FORM).records(run)).data
    assert TYPES.deserialize_cdr(data, "nav_msgs/msg/OccupancyGrid").data.tolist() == [
        0,
        99,
        100,
        0,
    ]


def decoded(path):
    found = {}
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for _, channel, message, value in reader.iter_decoded_messages(log_time_order=False):
            found.setdefault(channel.topic, []).append((message.log_time // FORM.step_ns, value))
    return found


def test_a_foreign_reader_understands_drives(tmp_path):
    events = example_drives()
    grid, found = events[0].problem.map, decoded(write(events, tmp_path))
    steps = [event for event in events if isinstance(event, Stepped)]
    true = np.minimum(np.rint(100 * grid.weights), 99) + grid.obstacles * (100 - 99)

    def shown_at(step):
        """The known map as it should be: only what this drive has seen until now."""
        began = max(e.step for e in events if isinstance(e, TrialStarted) and e.step <= step)
        known = np.full(true.shape, -1)
        known[0, 0], known[6, 8] = true[0, 0], true[6, 8]
        for event in steps:
            if began <= event.step <= step:
                x, y = event.fields.T
                known[y, x] = true[y, x]
        return known

    with_news = [event.step for event in steps if len(event.fields)]
    assert [step for step, _ in found["/known_map"]] == with_news
    for step, shown in found["/known_map"]:
        data = np.array(shown.data).reshape(shown.info.height, shown.info.width)
        assert data[::-1].tolist() == shown_at(step).tolist()
        stamp = shown.header.stamp
        assert stamp.sec * 10**9 + stamp.nanosec == step * FORM.step_ns

    assert [step for step, _ in found["/pose"]] == [event.step for event in steps]
    for event, (_, shown) in zip(steps, found["/pose"], strict=True):
        position, turn = shown.pose.position, shown.pose.orientation
        assert (position.x, position.y) == tuple(grid.to_metres(np.array([event.place]))[0])
        yaw = 2 * math.atan2(turn.z, turn.w) - grid.origin[2]
        seen = math.cos(yaw), -math.sin(yaw)  # y down, as headings have it
        assert seen == pytest.approx(
            (math.cos(event.heading * math.pi / 4), math.sin(event.heading * math.pi / 4))
        )

    changes = [event for event in events if isinstance(event, PathsChanged)]
    assert any(not len(event.path) for event in changes)  # no current path: an empty message
    for topic, name in (("/current_path", "path"), ("/past_path", "past")):
        for event, (_, shown) in zip(changes, found[topic], strict=True):
            metres = grid.to_metres(getattr(event, name)).tolist()
            assert [[p.pose.position.x, p.pose.position.y] for p in shown.poses] == metres
    calls = [event for event in events if isinstance(event, Called)]
    for event, (_, call) in zip(calls, found["/planner_call"], strict=True):
        assert (call.part, call.index, call.adopted) == (event.part, event.index, event.adopted)
    assert [(end.outcome, end.steps) for _, end in found["/drive_end"]] == [(0, 10), (2, 7)]
    texts = [(line.level, line.msg) for _, line in found["/log"]]
    assert texts[1] == (20, "trial 0: going back, no path was found")
    assert texts[2] == (20, "trial 0: reached after 10 steps")
    assert texts[4] == (30, "trial 1: overran after 7 steps")
    assert texts[5][1] == "run finished: 1 of 2 trials succeeded"
    assert "/ga_run" not in found


def test_outcomes_are_named_as_they_are_defined():
    for name, kind in (("DriveEnd", Outcome), ("DriveStep", Mode), ("PlannerCall", PlanStatus)):
        text = log_format.schema(OWN + name)
        for member in kind:
            assert f"uint8 {member.name}={member.value}\n" in text.decode()


def test_large_known_maps_are_shown_less_often(tmp_path):
    grid = GridMap("large", np.full((256, 256), 0.5))
    run = dataclasses.replace(example_drives()[0], problem=Problem(grid, (0, 0), (255, 255)))
    events = [run, TrialStarted(0, 0, 7)]
    for step in range(10):
        fields = np.array([[step, 1]], dtype=np.int32)
        entries = np.array([1 << 15], dtype=np.int32)
        events.append(Stepped(step, 0, (0, 0), 0, Mode.EXPLORE, fields, entries, 0.0))
    events.append(DriveFinished(9, 0, Outcome.OVERRAN, 9, 9))
    shown = decoded(write(events, tmp_path))["/known_map"]
    assert [step for step, _ in shown] == [0, 4, 8, 9]
    assert [np.count_nonzero(np.array(known.data) == 50) for _, known in shown] == [3, 7, 11, 12]


@pytest.mark.parametrize(("topics", "events"), [(12, example), (17, example_drives)])
def test_rerun_accepts_it(topics, events, tmp_path):
    checked = subprocess.run(
        [sys.executable, "-m", "rerun_cli", "mcap", "check", "--full", write(events(), tmp_path)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert checked.returncode == 0, checked.stderr
    rows = [line for line in checked.stdout.splitlines() if "/" in line and "run.mcap" not in line]
    assert len(rows) == topics
    assert all(row.startswith("ok") for row in rows)
