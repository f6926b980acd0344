"""The log: what goes in comes out, for us and for other people's readers."""

import dataclasses
import math
import subprocess
import sys
import tempfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from log_events import example, plain, write
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from gapath.errors import InputError
from gapath.events import (
    Evolved,
    Recorder,
    RunFinished,
    RunStarted,
    TrialFinished,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.problem import CornerCutting, Evolution, PlanStatus, Problem
from gapath.recorders import _log_format, _messages, mcap, none

TYPES = _log_format.TYPES
counts = st.integers(0, 2**63)
int32 = st.integers(-(2**31), 2**31 - 1)


@st.composite
def grid_maps(draw):
    shape = draw(st.tuples(st.integers(1, 6), st.integers(1, 6)))
    weights = draw(arrays(np.float64, shape, elements=st.floats(0, 1)))
    weights[0, 0] = weights[-1, -1] = 0.25  # start and target are free
    finite = st.floats(-1e6, 1e6)
    place = st.none() | st.tuples(int32, int32)
    return GridMap(
        draw(st.text()),
        weights,
        draw(place),
        draw(place),
        draw(st.integers(0, 99)),
        draw(st.text()),
        draw(st.floats(1e-3, 1e3)),
        draw(st.tuples(finite, finite, finite)),
    )


def paths(least=0):
    shape = st.tuples(st.integers(least, 5), st.just(2))
    return arrays(np.int32, shape, elements=int32)


@st.composite
def evolutions(draw):
    epochs = draw(st.integers(0, 4))
    genes, count = draw(st.integers(0, 5)), draw(st.integers(0, 3))
    return Evolution(
        draw(arrays(np.float64, epochs)),
        draw(arrays(np.float64, epochs)),
        draw(arrays(np.int32, (epochs, genes))),
        draw(arrays(np.int32, (epochs, count, 2))),
        draw(st.text()),
    )


@st.composite
def runs(draw):
    """Give the events of a run that need not make sense as one."""
    grid = draw(grid_maps())
    target = (grid.cols - 1, grid.rows - 1)
    problem = Problem(grid, (0, 0), target, draw(st.sampled_from(CornerCutting)))
    events = [
        RunStarted(
            draw(st.text()),
            draw(st.text()),
            problem,
            draw(counts),
            draw(counts),
            draw(st.text()),
            draw(st.dictionaries(st.text(), st.text(), max_size=3)),
            draw(paths()),
            draw(st.floats()),
        )
    ]
    steps = st.integers(0, 10**12)
    for _ in range(draw(st.integers(0, 3))):
        step, trial = draw(steps), draw(counts)
        events.append(TrialStarted(step, trial, draw(counts)))
        for call in range(draw(st.integers(0, 2))):
            events.append(Evolved(step, trial, call, draw(evolutions())))
        status, cost, numbers = draw(st.sampled_from(PlanStatus)), draw(st.floats()), draw(counts)
        events.append(TrialFinished(step, trial, status, cost, numbers, 2, 3, draw(paths())))
    if draw(st.booleans()):
        events.append(RunFinished(draw(steps), draw(counts), draw(counts)))
    return events


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    return write(example(), tmp_path_factory.mktemp("log"), flush_every=5)


@settings(max_examples=60, deadline=None)
@given(runs(), st.integers(1, 5))
def test_events_come_back(events, flush_every):
    with tempfile.TemporaryDirectory() as folder:
        path = write(events, folder, flush_every)
        assert list(map(plain, mcap.read_events(path))) == list(map(plain, events))
        assert list(map(plain, mcap.read_prefix(path))) == list(map(plain, events))


@settings(max_examples=60, deadline=None)
@given(runs())
def test_every_message_is_what_rosbags_would_write(events):
    for event in events:
        for topic, _, data in _messages.records(event, events[0]):
            name = _log_format.TOPICS[topic]
            message = TYPES.deserialize_cdr(data, name)
            assert bytes(TYPES.serialize_cdr(message, name, little_endian=True)) == data


@given(
    st.integers(0, 10**12),
    arrays(np.float64, st.tuples(st.integers(1, 9), st.just(2)), elements=st.floats()),
)
def test_path_equals_one_built_pose_by_pose(step, metres):
    make = {name.split("/")[-1]: cls for name, cls in TYPES.types.items()}
    stamp = make["Time"](step // 1000, step % 1000 * 10**6)
    header = TYPES.types["std_msgs/msg/Header"](stamp, "map")
    turn = make["Quaternion"](0.0, 0.0, 0.0, 1.0)
    poses = [
        make["PoseStamped"](header, make["Pose"](make["Point"](x, y, 0.0), turn)) for x, y in metres
    ]
    name = "nav_msgs/msg/Path"
    slow = TYPES.serialize_cdr(TYPES.types[name](header, poses), name, little_endian=True)
    assert _messages.path_cdr(step, metres) == bytes(slow)


def test_same_events_same_bytes(log, tmp_path):
    assert write(example(), tmp_path, flush_every=5).read_bytes() == log.read_bytes()


def test_a_foreign_reader_understands_it(log):
    run, *events = example()
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
    assert len(found["/path"]) == sum(end.status is PlanStatus.FOUND for end in ends)
    for end, (message, result) in zip(ends, found["/result"], strict=True):
        assert message.log_time == end.step * 1_000_000
        assert (result.status, result.feasible) == (end.status, end.status is PlanStatus.FOUND)
        assert list(result.path) == end.path.ravel().tolist()
    evolved = [event.evolution for event in events if isinstance(event, Evolved)]
    for evolution, (_, run_of_ga) in zip(evolved, found["/ga_run"], strict=True):
        assert list(run_of_ga.best) == evolution.best.tolist()
        assert list(run_of_ga.way_points) == evolution.way_points.ravel().tolist()
        assert run_of_ga.genotype == "control_points"
    texts = [(line.level, line.msg) for _, line in found["/log"]]
    assert [level for level, _ in texts] == [20, 30, 30, 20]  # two trials found nothing
    assert texts[1][1].startswith("trial 0: ")
    assert found["/trial_start"][0][1].settings == run.settings
    assert found["/run_end"][0][1].found == 4


def test_a_field_that_can_be_passed_never_shows_as_an_obstacle(tmp_path):
    run = example()[0]
    grid = GridMap("almost", np.array([[0.0, 0.999, 1.0, 0.0]]))
    problem = Problem(grid, (0, 0), (3, 0))
    data = next(_messages.records(dataclasses.replace(run, problem=problem), run)).data
    assert TYPES.deserialize_cdr(data, "nav_msgs/msg/OccupancyGrid").data.tolist() == [
        0,
        99,
        100,
        0,
    ]


def test_rerun_accepts_it(log):
    checked = subprocess.run(
        [sys.executable, "-m", "rerun_cli", "mcap", "check", "--full", log],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert checked.returncode == 0, checked.stderr
    rows = [line for line in checked.stdout.splitlines() if "/" in line and "run.mcap" not in line]
    assert len(rows) == len(_log_format.TOPICS)
    assert all(row.startswith("ok") for row in rows)


@pytest.mark.parametrize(
    ("name", "limit", "found"),
    [("MAX_CHUNK", 256, "in a message"), ("MAX_LOG", 4096, "in the run")],
)
def test_what_could_not_be_read_is_not_written(name, limit, found, tmp_path, monkeypatch):
    monkeypatch.setattr(mcap, name, limit)
    with pytest.raises(InputError, match=found):
        write(example(trials=99), tmp_path)


@pytest.mark.parametrize("flush_every", [0, -5])
def test_flush_every_is_checked(flush_every):
    with pytest.raises(InputError, match=r"recorder\.mcap\.flush_every"):
        mcap.Recorder(flush_every=flush_every)


@pytest.mark.parametrize("recorder", [mcap.Recorder(flush_every=1), none.Recorder()])
def test_recorders_keep_the_protocol(recorder):
    assert isinstance(recorder, Recorder)
    recorder.abort()  # also before open


def test_none_records_nothing(tmp_path):
    recorder = none.Recorder()
    recorder.open(str(tmp_path))
    for event in example():
        recorder.record(event)
    assert recorder.close() == []
    assert list(tmp_path.iterdir()) == []
