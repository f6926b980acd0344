"""What a log looks like: its limits, topics and message definitions.

Standard messages are what other people's viewers draw; messages of our own package
``gapath_msgs`` hold the numbers exactly, and only they are read back.
"""

import json
from typing import NamedTuple

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from gapath.kernels.units import OBSTACLE, SCALE

PROFILE, LIBRARY = "ros2", "gapath"
"""What the file's header says: its conventions, and who wrote it."""

MAX_CHUNK = 1 << 28
"""Bytes that one chunk may inflate to: 256 MiB, a run of a million epochs."""

MAX_LOG = 1 << 34
"""Bytes that all chunks of a log may inflate to: 16 GiB."""

LOG_VERSION = "7"
"""Raised whenever an older reader would misread a log."""

EARLIER = ("4", "5", "6")
"""Versions that are read, too. In all of them a step is a millisecond, no topic is latched, there
is no `/tf_static`, and maps are not compressed. A log of version 5 has settings of recorders and
its chunks end elsewhere; one of version 4 has no population besides."""


class Form(NamedTuple):
    """What of a log's bytes does not follow from its events.

    Parameters
    ----------
    version : str
        The log's.
    step_ns : int
        Nanoseconds that a step counts: log time is the step index times these.
    """

    version: str
    step_ns: int

    @property
    def is_bag(self) -> bool:
        """Whether a log has what ROS 2 asks of a bag: latched topics and a tree of frames."""
        return self.version == LOG_VERSION


def earlier(version: str) -> Form:
    """Give the form of an earlier version."""
    return Form(version, 1_000_000)


LONGEST_STEP = 10**9
"""Nanoseconds that a step may count at most."""

LAST_TIME = 2**31 * 10**9
"""Log time ends here: seconds in a ROS message are of 32 bits with a sign."""

FRAME = "map"
"""The metric frame of every standard message (REP 105)."""

WORLD = "world"
"""The frame above it in the tree of frames, at the same place: without a tree viewers of ROS know
no frame at all."""

ROBOT = "base_link"
"""The robot's frame (REP 105)."""

_OWN = {
    "gapath_msgs/msg/TrialStart": """\
# A trial begins. Its random streams are keyed by (seed, trial, call).
uint64 trial
uint64 seed
string method             # name of the planner or navigator
string settings           # the run's settings, a line each: name: value
""",
    "gapath_msgs/msg/Query": """\
# A trial has a start and a target of its own, of several on one map.
uint64 trial
float64 optimal_cost      # infinite: no path exists
uint32 number             # of the query among all that are listed
int32 start_x             # fields
int32 start_y
int32 target_x
int32 target_y
int32[] optimal_path      # x, y, x, y, ... [fields]; empty: no path exists
""",
    "gapath_msgs/msg/GaRun": """\
# A genetic algorithm ran: one row an epoch, rows one after another.
uint64 trial
uint64 call               # number of this run within its trial
uint32 genes              # columns of chromosomes
uint32 way_points_count   # way points in a row of way_points
int32[] chromosomes       # the best individual
int32[] way_points        # of the best individual: x, y, x, y, ... [fields]
float64[] best            # fitness of the best individual
float64[] mean            # mean fitness of the population
string genotype           # what the genes mean
""",
    "gapath_msgs/msg/MemeticRun": """\
# A genetic algorithm ran and tells what its population took in, a change at a time; a polygon is
# written as what changed of the same individual's one before.
uint64 trial
uint64 call               # number of this run within its trial
uint32 way_points_count   # vertices in each epoch's best polygon, its last one repeated
int32[] leaders           # an epoch each: number of the change that left the best individual
int32[] epochs            # a change each, as are the next five: from 1, not falling
int32[] individuals       # which one it changed
int32[] operators         # what did it, a number of names
int32[] heads             # vertices of the polygon before with which this one begins
int32[] tails             # vertices of the polygon before with which it ends
int32[] ends              # where its other vertices end in vertices, in between
int32[] vertices          # x, y, x, y, ... [fields]
float64[] best            # an epoch each: fitness of the best individual
float64[] mean            # mean fitness of the population
float64[] gains           # a change each: by how much the individual became cheaper
float64[] costs           # what it costs since
float64[] shares          # a name each: by how much it lowered the cost of the best so far
string[] names            # what makes and changes individuals
string genotype           # what the best individual's genes mean
""",
    "gapath_msgs/msg/Graph": """\
# What a planner made of the map before it searched; the same in every trial of a run.
uint64 trial
uint32 rows               # of the picture of obstacles, in blocks
uint32 cols
uint32 block              # fields of the map, along a side, that are one block
uint8[] obstacles         # grown by the robot's radius: 8 blocks a byte, row by row, high bit first
int32[] points            # x, y, x, y, ... [fields]: the start, the target, the keypoints
int32[] edges             # i, j, i, j, ...: points that a free line joins
""",
    "gapath_msgs/msg/Result": """\
# A trial ended.
uint8 FOUND=0
uint8 NOT_FOUND=1
uint8 INFEASIBLE=2
uint8 OPTIMAL=3
uint64 trial
uint64 epochs
uint64 evaluations        # chromosomes whose fitness was computed
uint64 expansions         # fields that a graph search expanded
uint64 obstacles          # obstacle fields on the best path; 0 if it is feasible
float64 weights           # sum of the weights of the best path's other fields
float64 vln               # what an obstacle field counts in cost
float64 cost              # for people: obstacles * vln + weights
uint8 status
bool feasible             # status is FOUND or OPTIMAL
int32[] path              # x, y, x, y, ... [fields]; empty without a path
""",
    "gapath_msgs/msg/DriveStart": """\
# A trial is a drive: what its robot can do.
uint64 trial
float64 unknown_weight    # what it takes an unknown field to cost
uint32 sensor_range       # layers of the triangle that it sees
uint32 step_limit         # steps after which it has overrun
""",
    "gapath_msgs/msg/DriveStep": f"""\
# A robot looked around and moved, or stood (the first look of a drive: stood).
uint8 EXPLORE=0
uint8 REPLAN=1
uint8 RETURN=2
uint64 trial
int32 x                   # the robot's field after the step
int32 y
uint8 heading             # where it looked: 0 (+x) to 7, clockwise with y down
uint8 mode
int32[] fields            # seen for the first time or changed: x, y, x, y, ... [fields]
int32[] entries           # their weights in units of 1 / {SCALE}; {OBSTACLE}: an obstacle
""",
    "gapath_msgs/msg/PlannerCall": """\
# A navigator called a planner in this step, before the robot moved.
uint8 FOUND=0
uint8 NOT_FOUND=1
uint8 INFEASIBLE=2
uint8 OPTIMAL=3
uint64 trial
uint64 epochs
uint64 evaluations        # chromosomes whose fitness was computed
uint64 expansions         # fields that a graph search expanded
uint64 obstacles          # known obstacle fields on the best path; 0 if it is feasible
float64 weights           # sum of the weights of its other fields on the known map
float64 vln               # what an obstacle field counts in cost
float64 cost              # for people: obstacles * vln + weights
uint32 index              # number of the planner in its part's list
uint8 status
bool adopted              # its path became the current one
int32[] path              # x, y, x, y, ... [fields]
string part               # A (return), B (explore) or C (replan)
""",
    "gapath_msgs/msg/Paths": """\
# The path that the robot follows, or the way back, is another one from this step on.
uint64 trial
int32[] path              # from the robot's field on: x, y, x, y, ... [fields]; empty: none
int32[] past              # the way back, the robot's own field last
""",
    "gapath_msgs/msg/DriveEnd": """\
# A drive ended.
uint8 REACHED=0
uint8 RETURNED=1
uint8 OVERRAN=2
uint64 trial
uint64 steps
uint64 stands             # in how many of them it stood
uint8 outcome
""",
    "gapath_msgs/msg/Epoch": """\
# An epoch of a genetic algorithm; only in bags that gapath-log bag makes.
uint64 trial
uint64 call               # number of this run within its trial
uint32 epoch              # from 1
float64 best              # fitness of the best individual
float64 mean              # mean fitness of the population
""",
    "gapath_msgs/msg/RunEnd": """\
# The run was not interrupted.
uint64 trials
uint64 found              # trials that found a path, or reached the target
""",
}

TOPICS = {
    "/map": "nav_msgs/msg/OccupancyGrid",
    "/start": "geometry_msgs/msg/PoseStamped",
    "/target": "geometry_msgs/msg/PoseStamped",
    "/optimal_path": "nav_msgs/msg/Path",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/log": "rcl_interfaces/msg/Log",
    "/trial_start": "gapath_msgs/msg/TrialStart",
    "/run_end": "gapath_msgs/msg/RunEnd",
    "/path": "nav_msgs/msg/Path",
    "/query": "gapath_msgs/msg/Query",
    "/ga_run": "gapath_msgs/msg/GaRun",
    "/memetic_run": "gapath_msgs/msg/MemeticRun",
    "/graph": "gapath_msgs/msg/Graph",
    "/result": "gapath_msgs/msg/Result",
    "/known_map": "nav_msgs/msg/OccupancyGrid",
    "/pose": "geometry_msgs/msg/PoseStamped",
    "/current_path": "nav_msgs/msg/Path",
    "/past_path": "nav_msgs/msg/Path",
    "/drive_start": "gapath_msgs/msg/DriveStart",
    "/drive_step": "gapath_msgs/msg/DriveStep",
    "/planner_call": "gapath_msgs/msg/PlannerCall",
    "/paths": "gapath_msgs/msg/Paths",
    "/drive_end": "gapath_msgs/msg/DriveEnd",
}
"""Message type of every topic; a log has a channel for those that its run wrote to."""

ALL_TOPICS = TOPICS | {
    "/best": "nav_msgs/msg/Path",
    "/epoch": "gapath_msgs/msg/Epoch",
    "/tf": "tf2_msgs/msg/TFMessage",
}
"""The same with those of bags that are made of a log to see it move."""

LATCHED = frozenset(
    ("/map", "/start", "/target", "/optimal_path", "/tf_static", "/path", "/known_map")
) | {"/current_path", "/past_path"}
"""Topics whose last message holds until the next one: who comes late still gets it."""

_FOR_EVER = {"sec": 9223372036, "nsec": 854775807}
_LATCHED_QOS = {
    "history": "keep_last",
    "depth": 1,
    "reliability": "reliable",
    "durability": "transient_local",
    "deadline": _FOR_EVER,
    "lifespan": _FOR_EVER,
    "liveliness": "automatic",
    "liveliness_lease_duration": _FOR_EVER,
    "avoid_ros_namespace_conventions": False,
}


def offered_qos_profiles(topic: str) -> list[dict[str, object]]:
    """Give a topic's quality of service as rosbag2 says it since its version 9; none: the usual."""
    return [_LATCHED_QOS] if topic in LATCHED else []


TYPES = get_typestore(Stores.ROS2_HUMBLE)
for _name, _text in _OWN.items():
    TYPES.register(get_types_from_msg(_text, _name))


def definitions() -> dict[str, str]:
    """Give the texts of gapath's own definitions by name, in the order in which they are here."""
    return {name.rpartition("/")[2]: text for name, text in _OWN.items()}


def schema(name: str) -> bytes:
    """Give a type's definition, schema encoding ``ros2msg``."""
    text = _OWN.get(name) or TYPES.generate_msgdef(name, ros_version=2)[0]
    return text.encode()


def channel_metadata(topic: str, form: Form) -> dict[str, str]:
    """Give what rosbag2 keeps with a topic: JSON, which is YAML."""
    qos = offered_qos_profiles(topic) if form.is_bag else []
    return {"offered_qos_profiles": json.dumps(qos)} if qos else {}
