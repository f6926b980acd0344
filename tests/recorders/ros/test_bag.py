"""A run folder is a bag of ROS 2: `rosbags` opens it as one, and reads all of it."""

from collections import Counter

import pytest
import yaml
from log_events import example, example_drives, example_memetic, write
from rosbags.interfaces import QosDurability
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from gapath.recorders.mcap import format as log_format

LATCHED = {"/map", "/start", "/target", "/optimal_path", "/tf_static", "/path"}
LATCHED |= {"/known_map", "/current_path", "/past_path"}


@pytest.mark.parametrize("events", [example, example_drives, example_memetic])
def test_a_run_folder_is_a_bag(events, tmp_path):
    told = events()
    write(told, tmp_path, chunk_messages=5)
    types, counts, times = get_typestore(Stores.ROS2_JAZZY), Counter(), []
    with Reader(tmp_path) as reader:
        for connection in reader.connections:  # nothing of gapath's: the log brings its types
            if connection.msgtype not in types.types:
                text = connection.msgdef.data
                types.register(get_types_from_msg(text, connection.msgtype))
        for connection, time, data in reader.messages():
            message = types.deserialize_cdr(data, connection.msgtype)
            assert type(message).__msgtype__ == connection.msgtype
            counts[connection.topic] += 1
            times.append(time)
            if hasattr(message, "header"):
                stamp = message.header.stamp
                assert stamp.sec * 10**9 + stamp.nanosec == time
        assert (reader.start_time, reader.end_time - 1) == (min(times), max(times))
        assert max(times) == told[-1].step * 100_000_000
        assert reader.message_count == len(times)
        for connection in reader.connections:
            topic, qos = connection.topic, connection.ext.offered_qos_profiles
            assert connection.msgcount == counts[topic]
            kept = [each.durability for each in qos]
            assert kept == ([QosDurability.TRANSIENT_LOCAL] if topic in LATCHED else [])
            assert connection.digest == types.hash_rihs01(connection.msgtype)
    assert {"/map", "/tf_static", "/run_end"} <= counts.keys()


def test_the_description_is_that_of_rosbag2(tmp_path):
    write(example(), tmp_path)
    text = (tmp_path / "metadata.yaml").read_text()
    bag = yaml.safe_load(text)["rosbag2_bagfile_information"]
    assert (bag["version"], bag["storage_identifier"]) == (9, "mcap")
    assert bag["relative_file_paths"] == ["run.mcap"] == [file["path"] for file in bag["files"]]
    assert "&" not in text and "*" not in text  # no reference within
    (kept,) = [
        topic["topic_metadata"]["offered_qos_profiles"]
        for topic in bag["topics_with_message_count"]
        if topic["topic_metadata"]["name"] == "/map"
    ]
    assert kept[0]["durability"] == "transient_local" and kept[0]["reliability"] == "reliable"


def test_types_are_the_same_in_every_release_that_is_read(tmp_path):
    releases = [get_typestore(release) for release in (Stores.ROS2_HUMBLE, Stores.ROS2_JAZZY)]
    for name in set(log_format.TOPICS.values()):
        if not name.startswith("gapath_msgs/"):
            assert len({release.hash_rihs01(name) for release in releases}) == 1, name
