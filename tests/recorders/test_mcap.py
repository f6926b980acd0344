"""The log: what goes in comes out."""

import dataclasses
import tempfile
import time
from string import ascii_letters

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from log_events import example, example_drives, logged, plain, write, write_as
from mcap.reader import make_reader

from gapath.errors import InputError
from gapath.events import (
    Called,
    DriveFinished,
    DriveStarted,
    Evolved,
    Mode,
    Outcome,
    PathsChanged,
    Recorder,
    RunFinished,
    RunStarted,
    Stepped,
    Surveyed,
    TrialFinished,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.history.evolution import Evolution, Population
from gapath.history.graph import Graph
from gapath.problem import Answer, CornerCutting, PlanStatus, Problem
from gapath.recorders import mcap, none
from gapath.recorders.mcap import cdr
from gapath.recorders.mcap import format as log_format
from gapath.recorders.mcap.messages import Messages

TYPES = log_format.TYPES
FORM = log_format.Form(log_format.LOG_VERSION, 100_000_000)
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
def with_populations(draw):
    """Any evolution with a population: every best individual is one of its polygons."""
    some = st.lists(paths(least=1), min_size=1, max_size=6)
    polygons, names = draw(some), draw(st.lists(st.text(), min_size=1, max_size=3))
    m = len(polygons)
    later = st.lists(st.integers(1, 3), min_size=m - 1, max_size=m - 1)
    first = [1, *sorted(draw(later))]
    population = Population(
        epochs=np.array(first, dtype=np.int32),
        individuals=draw(arrays(np.int32, m, elements=int32)),
        operators=draw(arrays(np.int32, m, elements=st.integers(0, len(names) - 1))),
        gains=draw(arrays(np.float64, m)),
        costs=draw(arrays(np.float64, m)),
        ends=np.cumsum(list(map(len, polygons)), dtype=np.int32),
        vertices=np.concatenate(polygons),
        names=tuple(names),
        shares=tuple(draw(st.floats()) for _ in names),
    )
    width = max(map(len, polygons)) + draw(st.integers(0, 2))
    epochs = range(first[-1] + draw(st.integers(0, 1)))
    best = [draw(st.sampled_from(polygons[: first.count(1)])) for _ in epochs]
    rows = [np.concatenate([each, each[-1:].repeat(width - len(each), 0)]) for each in best]
    way_points = np.array(rows, dtype=np.int32).reshape(len(best), width, 2)
    values = (draw(arrays(np.float64, len(best))) for _ in range(2))
    genes = way_points.reshape(len(best), 2 * width)
    return Evolution(*values, genes, way_points, draw(st.text()), population)


@st.composite
def evolutions(draw):
    if draw(st.booleans()):
        return draw(with_populations())
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
def graphs(draw):
    """Any graph; its picture need not have whole bytes."""
    shape = st.tuples(st.integers(1, 9), st.integers(1, 9))
    obstacles = draw(arrays(np.bool_, shape))
    points = draw(arrays(np.int32, st.tuples(st.integers(0, 9), st.just(2))))
    some = st.tuples(st.integers(0, 9 if len(points) else 0), st.just(2))
    edges = draw(arrays(np.int32, some, elements=st.integers(0, max(len(points) - 1, 0))))
    return Graph(obstacles, draw(st.integers(1, 2**32 - 1)), points, edges)


@st.composite
def answers(draw):
    status, numbers = draw(st.sampled_from(PlanStatus)), [draw(counts) for _ in range(4)]
    weights, vln = draw(st.floats()), draw(st.floats())
    return Answer(status, draw(paths()), weights, numbers[0], vln, *numbers[1:])


VERSIONS = st.text(ascii_letters + "019.+!-", min_size=1, max_size=99)
NAMES = st.from_regex(r"[a-z_]+(\.[a-z_]+|\[\d\])*", fullmatch=True)
VALUES = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text()


def drives(draw, grid, step, trial):
    """Give the events of a drive between its start and its end."""
    few, weights = st.integers(0, 2**32 - 1), st.floats()
    yield DriveStarted(step, trial, draw(few), draw(weights), draw(few))
    places = st.tuples(st.integers(0, grid.cols - 1), st.integers(0, grid.rows - 1))
    part, heading = st.sampled_from("ABC"), st.integers(0, 7)
    for i in range(draw(st.integers(0, 3))):
        now = step + i
        if draw(st.booleans()):
            yield Called(now, trial, draw(part), i, draw(st.booleans()), draw(answers()))
        if draw(st.booleans()):
            yield PathsChanged(now, trial, draw(paths()), draw(paths()))
        seen = np.array(draw(st.lists(places, max_size=4)), dtype=np.int32).reshape(-1, 2)
        entries = draw(arrays(np.int32, len(seen), elements=st.integers(0, 1 << 24)))
        mode, seconds = draw(st.sampled_from(Mode)), draw(st.floats())
        yield Stepped(now, trial, draw(places), draw(heading), mode, seen, entries, seconds)


@st.composite
def runs(draw):
    """Give the events of a run that need not make sense as one."""
    grid = draw(grid_maps())
    target = (grid.cols - 1, grid.rows - 1)
    problem = Problem(grid, (0, 0), target, draw(st.sampled_from(CornerCutting)))
    task = draw(st.sampled_from(["plan", "drive"]))
    events = [
        RunStarted(
            draw(st.text()),
            draw(st.text()),
            task,
            problem,
            draw(counts),
            draw(counts),
            draw(st.dictionaries(NAMES, VALUES, max_size=3)),
            draw(st.dictionaries(VERSIONS, VERSIONS, max_size=3)),
            draw(paths()),
            draw(st.floats()),
        )
    ]
    steps = st.integers(0, 10**10)
    for _ in range(draw(st.integers(0, 3))):
        step, trial = draw(steps), draw(counts)
        events.append(TrialStarted(step, trial, draw(counts)))
        if task == "drive":
            events += drives(draw, grid, step, trial)
            ended = draw(st.sampled_from(Outcome))
            events.append(DriveFinished(step, trial, ended, draw(counts), draw(counts)))
            continue
        if draw(st.booleans()):
            events.append(Surveyed(step, trial, draw(graphs())))
        for call in range(draw(st.integers(0, 2))):
            events.append(Evolved(step, trial, call, draw(evolutions())))
        events.append(TrialFinished(step, trial, draw(answers())))
    if draw(st.booleans()):
        events.append(RunFinished(draw(steps), draw(counts), draw(counts)))
    return events


@settings(max_examples=60, deadline=None)
@given(runs(), st.integers(1, 5))
def test_events_come_back(events, chunk_messages):
    with tempfile.TemporaryDirectory() as folder:
        path = write(events, folder, chunk_messages)
        expected = [plain(logged(event)) for event in events]
        assert list(map(plain, mcap.read_events(path))) == expected
        assert list(map(plain, mcap.read_prefix(path))) == expected


@settings(max_examples=60, deadline=None)
@given(runs())
def test_every_message_is_what_rosbags_would_write(events):
    messages = Messages(events[0], FORM)
    for event in events:
        for topic, _, data in messages.records(event):
            name = log_format.TOPICS[topic]
            message = TYPES.deserialize_cdr(data, name)
            assert bytes(TYPES.serialize_cdr(message, name, little_endian=True)) == data


@given(
    st.integers(0, 10**18),
    arrays(np.float64, st.tuples(st.integers(0, 9), st.just(2)), elements=st.floats()),
)
def test_path_equals_one_built_pose_by_pose(time, metres):
    make = {name.split("/")[-1]: cls for name, cls in TYPES.types.items()}
    stamp = make["Time"](*divmod(time, 10**9))
    header = TYPES.types["std_msgs/msg/Header"](stamp, "map")
    turn = make["Quaternion"](0.0, 0.0, 0.0, 1.0)
    poses = [
        make["PoseStamped"](header, make["Pose"](make["Point"](x, y, 0.0), turn)) for x, y in metres
    ]
    name = "nav_msgs/msg/Path"
    slow = TYPES.serialize_cdr(TYPES.types[name](header, poses), name, little_endian=True)
    assert cdr.path_cdr(time, metres) == bytes(slow)


@pytest.mark.parametrize("version", log_format.EARLIER)
@pytest.mark.parametrize("events", [example, example_drives])
def test_earlier_logs_are_read_and_written_again(events, version, tmp_path):
    form = log_format.earlier(version)
    path = write_as(form, events(), tmp_path / "run.mcap")
    told = [plain(logged(event)) for event in events()]
    assert list(map(plain, mcap.read_events(path))) == told
    found = mcap.compare(path, lambda _: iter(events()), mcap.USUAL)
    assert (found.version, found.difference, found.byte) == (version, "", None)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert not any(channel.metadata for channel in summary.channels.values())
        assert "/tf_static" not in {channel.topic for channel in summary.channels.values()}
        assert [each.name for each in reader.iter_attachments()] == ["map.npy", "optimal_path.npy"]
        assert summary.statistics.message_end_time == events()[-1].step * 1_000_000


@pytest.mark.parametrize("step_s", [1e-9, 0.05, 1.0])
def test_a_step_takes_as_long_as_the_recorder_says(step_s, tmp_path):
    form = log_format.Form(log_format.LOG_VERSION, round(step_s * 1e9))
    path = write_as(form, example(), tmp_path / "run.mcap")
    assert list(map(plain, mcap.read_events(path))) == [plain(event) for event in example()]
    found = mcap.compare(path, lambda _: iter(example()), mcap.USUAL)
    assert (found.difference, found.byte) == ("", None)
    with path.open("rb") as file:
        summary = make_reader(file, validate_crcs=True).get_summary()
    assert summary.statistics.message_end_time == example()[-1].step * form.step_ns


@pytest.mark.parametrize("step_s", [0.0, -0.1, 1.5, float("nan"), float("inf"), 1e-10])
def test_a_step_of_no_sensible_time_is_refused(step_s):
    with pytest.raises(InputError, match=r"step_s: got .*, expected from 1e-9 to 1"):
        mcap.Recorder(step_s=step_s)


def test_log_times_end_where_ros_ends(tmp_path):
    run, last = example()[0], example()[-1]
    late = dataclasses.replace(last, step=2**31 * 10)
    with pytest.raises(InputError, match=r"s of log time, expected less than 2147483648 s"):
        write([run, late], tmp_path)


@pytest.mark.parametrize("events", [example, example_drives])
def test_same_events_same_bytes(events, tmp_path):
    first = write(events(), tmp_path, chunk_messages=5).read_bytes()
    assert write(events(), tmp_path, chunk_messages=5).read_bytes() == first


def test_a_step_costs_little(tmp_path):
    events = example_drives(trials=200)
    steps = sum(isinstance(event, Stepped) for event in events)
    took = []
    for _ in range(3):
        began = time.perf_counter()
        write(events, tmp_path)
        took.append(time.perf_counter() - began)
    assert min(took) / steps < 300e-6  # five times what a quiet machine takes, starts included


@pytest.mark.parametrize(
    ("name", "limit", "found"),
    [("MAX_CHUNK", 256, "in a message"), ("MAX_LOG", 4096, "in the run")],
)
def test_what_could_not_be_read_is_not_written(name, limit, found, tmp_path, monkeypatch):
    monkeypatch.setattr(f"gapath.recorders.mcap.log.{name}", limit)
    with pytest.raises(InputError, match=found):
        write(example(trials=99), tmp_path)


@pytest.mark.parametrize("recorder", [mcap.Recorder(step_s=0.1), none.Recorder()])
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
