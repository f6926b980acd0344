"""A bag in which epochs and the robot move, made of a log; and the package of its definitions."""

import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from log_events import example, example_drives, write
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from gapath.commands import log as log_cli
from gapath.events import Evolved, Stepped
from gapath.recorders.mcap import format as log_format


def read(folder):
    """Read a bag with the types that it brings: topic -> [(seconds, message)]."""
    types, found = get_typestore(Stores.ROS2_JAZZY), defaultdict(list)
    with Reader(folder) as reader:
        for connection in reader.connections:
            if connection.msgtype not in types.types:
                types.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
        for connection, time, data in reader.messages():
            message = types.deserialize_cdr(data, connection.msgtype)
            found[connection.topic].append((time / 1e9, message))
    return found


def test_a_plan_moves_epoch_by_epoch(tmp_path, capsys):
    events = example()
    log, folder = write(events, tmp_path), tmp_path / "bag"
    words = ["bag", str(log), str(folder), "--trials", "1,4", "--step-s", "0.5"]
    assert log_cli.main(words) == 0
    assert capsys.readouterr().out.split() == [
        f"{folder}/animation.mcap",
        f"{folder}/metadata.yaml",
    ]
    found = read(folder)
    told = [e for e in events if isinstance(e, Evolved) and e.trial in (1, 4)]
    grid = events[0].problem.map
    rows = [row for event in told for row in zip(*event.evolution[:2], strict=True)]
    assert [(m.best, m.mean) for _, m in found["/epoch"]] == rows
    assert [(m.trial, m.epoch) for _, m in found["/epoch"]] == [
        (event.trial, i + 1) for event in told for i in range(8)
    ]
    ways = [grid.to_metres(way) for event in told for way in event.evolution.way_points]
    for (time, path), way in zip(found["/best"], ways, strict=True):
        shown = [(pose.pose.position.x, pose.pose.position.y) for pose in path.poses]
        assert np.array_equal(shown, way) and path.header.frame_id == "map"
        assert path.header.stamp.sec + path.header.stamp.nanosec / 1e9 == time
    times = [time for time, _ in found["/epoch"]]
    assert times[:8] == [0.5 * i for i in range(8)]  # the first one at once, trial 4 after a pause
    assert times[8:] == [0.5 * i for i in range(18, 26)]
    assert len(found["/map"]) == len(found["/tf_static"]) == 1


def test_a_drive_has_the_robots_frame(tmp_path):
    events = example_drives()
    log, folder = write(events, tmp_path), tmp_path / "bag"
    assert log_cli.main(["bag", str(log), str(folder)]) == 0
    found = read(folder)
    steps = [e for e in events if isinstance(e, Stepped) and e.trial == 0]
    assert len(found["/tf"]) == len(found["/pose"]) == len(steps)
    for (time, frames), (_, pose) in zip(found["/tf"], found["/pose"], strict=True):
        (frame,) = frames.transforms
        assert (frame.header.frame_id, frame.child_frame_id) == ("map", "base_link")
        assert frame.header.stamp.sec + frame.header.stamp.nanosec / 1e9 == time
        place, turn = frame.transform.translation, frame.transform.rotation
        assert (place.x, place.y) == (pose.pose.position.x, pose.pose.position.y)
        assert (turn.z, turn.w) == (pose.pose.orientation.z, pose.pose.orientation.w)


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["bag", "LOG", "DIR/new", "--trials", "9"], "no trial 9"),
        (["bag", "LOG", "DIR"], "something that is there"),
        (["bag", "LOG", "DIR/no/new"], "no such folder"),
        (["bag", "LOG", "DIR/new", "--step-s", "nan"], "step_s"),
        (["bag", "DIR/none", "DIR/new"], "none"),
        (["messages", "DIR"], "something that is there"),
    ],
)
def test_what_cannot_be_made_is_refused(words, named, tmp_path, capsys):
    log = write(example(), tmp_path)
    there = sorted(tmp_path.iterdir())
    words = [w.replace("LOG", str(log)).replace("DIR", str(tmp_path)) for w in words]
    assert log_cli.main(words) == 2
    told = capsys.readouterr()
    assert told.out == "" and named in told.err and told.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == there


def test_the_package_has_the_definitions_of_logs(tmp_path):
    folder = tmp_path / "gapath_msgs"
    assert log_cli.main(["messages", str(folder)]) == 0
    files = sorted((folder / "msg").glob("*.msg"))
    types = get_typestore(Stores.ROS2_JAZZY)
    for file in files:
        types.register(get_types_from_msg(file.read_text(), f"gapath_msgs/msg/{file.stem}"))
    ours = {name for name in log_format.ALL_TOPICS.values() if name.startswith("gapath_msgs/")}
    assert {f"gapath_msgs/msg/{file.stem}" for file in files} == ours
    write(example(), tmp_path)
    with Reader(tmp_path) as reader:
        for connection in reader.connections:
            if connection.msgtype in ours:
                file = folder / "msg" / f"{Path(connection.msgtype).name}.msg"
                assert file.read_text() == connection.msgdef.data
                assert connection.digest == types.hash_rihs01(connection.msgtype)
    root = ElementTree.parse(folder / "package.xml").getroot()
    assert (root.tag, root.findtext("name"), root.findtext("license")) == (
        "package",
        "gapath_msgs",
        "MIT",
    )
    cmake = (folder / "CMakeLists.txt").read_text()
    assert all(f'"msg/{file.name}"' in cmake for file in files) and "project(gapath_msgs)" in cmake


def test_rerun_reads_such_a_bag(tmp_path):
    folder = tmp_path / "bag"
    assert log_cli.main(["bag", str(write(example_drives(), tmp_path)), str(folder)]) == 0
    checked = subprocess.run(
        [sys.executable, "-m", "rerun_cli", "mcap", "check", "--full", folder / "animation.mcap"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert checked.returncode == 0 and "/tf " in checked.stdout, checked.stderr
