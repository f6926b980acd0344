"""``metadata.yaml``: with it the folder of a log is a bag of ROS 2."""

from collections.abc import Mapping
from functools import lru_cache

import yaml
from mcap.records import Statistics

from gapath.recorders.mcap.format import ALL_TOPICS, TYPES, offered_qos_profiles

METADATA = "metadata.yaml"
"""Name of the file that makes a folder a bag."""

_VERSION = 9  # of rosbag2's description of a bag, since ROS 2 Jazzy


def described(log: str, statistics: Statistics, channels: Mapping[str, int]) -> bytes:
    """Describe a bag.

    Parameters
    ----------
    log : str
        Name of its MCAP file.
    statistics : Statistics
        What this holds.
    channels : mapping of str to int
        Topic -> channel.

    Returns
    -------
    bytes
        YAML, as rosbag2 writes and reads it.
    """
    counts, begin = statistics.channel_message_counts, statistics.message_start_time
    there = {
        "starting_time": {"nanoseconds_since_epoch": begin},
        "duration": {"nanoseconds": statistics.message_end_time - begin},
        "message_count": statistics.message_count,
    }
    topics = [
        {
            "topic_metadata": {
                "name": topic,
                "type": ALL_TOPICS[topic],
                "serialization_format": "cdr",
                "offered_qos_profiles": offered_qos_profiles(topic),
                "type_description_hash": _hash(ALL_TOPICS[topic]),
            },
            "message_count": counts[channel],
        }
        for topic, channel in channels.items()
    ]
    bag = {
        "version": _VERSION,
        "storage_identifier": "mcap",
        **there,
        "topics_with_message_count": topics,
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [log],
        "files": [{"path": log, **there}],
        "custom_data": None,
        "ros_distro": "",
    }
    text = yaml.dump({"rosbag2_bagfile_information": bag}, Dumper=_Plain, sort_keys=False)
    return text.encode()


class _Plain(yaml.SafeDumper):
    """Writes what is there twice twice: not every reader of ROS takes a reference."""

    def ignore_aliases(self, data: object) -> bool:
        return True


@lru_cache(maxsize=64)
def _hash(name: str) -> str:
    """Give a type's hash as ROS 2 has it (RIHS01), the same as of a package that is built."""
    return str(TYPES.hash_rihs01(name))
