"""Messages in CDR, the encoding of ROS 2: by `rosbags`, and by hand what a run writes often.

Standard messages are in metres, y up, in the frame `FRAME`.
"""

import math
import struct
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.grid import Field, GridMap, Table
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.problem import Answer, PlanStatus
from gapath.recorders.mcap.format import ALL_TOPICS, FRAME, ROBOT, TYPES, WORLD

ENCAPSULATION = b"\0\1\0\0"
"""Before every message: little-endian CDR."""

INFO, WARN = 20, 30
"""Levels of rcl_interfaces/msg/Log."""

COUNT = struct.Struct("<I")
"""How many parts a sequence has."""

_STAMP = struct.Struct("<iI")


class Record(NamedTuple):
    """One message: topic, log time in nanoseconds, CDR bytes."""

    topic: str
    time: int
    data: bytes


def record(topic: str, time: int, *values: Any) -> Record:
    """Make a message of its fields in order, by `rosbags`."""
    name = ALL_TOPICS[topic]
    message = TYPES.types[name](*values)
    return Record(topic, time, bytes(TYPES.serialize_cdr(message, name, little_endian=True)))


def arrays_cdr(head: bytes, *arrays: NDArray[Any]) -> bytes:
    """Serialise a message that ends with arrays of numbers of at least four bytes."""
    parts, position = [ENCAPSULATION, head], len(head)
    for array in arrays:
        padding = bytes(-(position + 4) % array.itemsize if array.size else 0)
        parts += COUNT.pack(array.size), padding, array.tobytes()
        position += 4 + len(padding) + array.nbytes
    return b"".join(parts)


@lru_cache(maxsize=16)
def strings_cdr(*texts: str) -> bytes:
    """Serialise the strings that end a message, the same ones in all trials of a run."""
    data = b""
    for text in texts:
        encoded = text.encode() + b"\0"
        data += bytes(-len(data) % 4) + COUNT.pack(len(encoded)) + encoded
    return data


def answer_numbers(answer: Answer) -> tuple[int, int, int, int, float, float, float]:
    """Give the numbers of an answer in the order in which messages have them."""
    return (
        answer.epochs,
        answer.evaluations,
        answer.expansions,
        answer.obstacles,
        answer.weights,
        answer.vln,
        answer.cost,
    )


def read_answer(message: Any) -> Answer:
    """Give the answer that a message holds."""
    return Answer(
        PlanStatus(message.status),
        np.array(message.path, dtype=np.int32).reshape(-1, 2),
        message.weights,
        message.obstacles,
        message.vln,
        message.epochs,
        message.evaluations,
        message.expansions,
    )


def log_record(time: int, level: int, text: str) -> Record:
    """Say a sentence for people."""
    return record("/log", time, _stamp(time), level, "gapath", text, "", "", 0)


def in_metres(grid: GridMap, place: Field) -> tuple[float, float]:
    """Give the centre of a field."""
    x, y = grid.to_metres(np.array([place], dtype=np.int32))[0].tolist()
    return x, y


def pose_record(
    topic: str, time: int, metres: tuple[float, float], turn: tuple[float, float] = (0.0, 1.0)
) -> Record:
    """Show a place as a pose.

    Parameters
    ----------
    topic : str
        One of `TOPICS` with a PoseStamped.
    time : int
        Its log time, in nanoseconds.
    metres : (float, float)
        The place.
    turn : (float, float)
        z and w of the orientation's quaternion.

    Returns
    -------
    Record
        The message.
    """
    pose = _POSE.pack(*metres, 0.0, 0.0, 0.0, *turn)
    return Record(topic, time, ENCAPSULATION + _header_cdr(time) + pose)


_POSE = struct.Struct("<7d")


def _header_cdr(time: int) -> bytes:
    second, nanosecond = divmod(time, 10**9)
    return _STAMP.pack(second, nanosecond) + _FRAME_CDR


_FRAME_CDR = COUNT.pack(len(FRAME) + 1) + FRAME.encode() + b"\0"


def _stamp(time: int) -> Any:
    return TYPES.types["builtin_interfaces/msg/Time"](*divmod(time, 10**9))


def frames_record() -> Record:
    """Give the tree of frames: the map's in the world's, both at one place."""
    return _frame_record("/tf_static", 0, (WORLD, FRAME), (0.0, 0.0), (0.0, 1.0))


def robot_frame(time: int, metres: tuple[float, float], turn: tuple[float, float]) -> Record:
    """Give the robot's frame in the map's; its pose as of `pose_record`."""
    return _frame_record("/tf", time, (FRAME, ROBOT), metres, turn)


def _frame_record(
    topic: str,
    time: int,
    frames: tuple[str, str],
    metres: tuple[float, float],
    turn: tuple[float, float],
) -> Record:
    transform = TYPES.types["geometry_msgs/msg/Transform"](
        TYPES.types["geometry_msgs/msg/Vector3"](*metres, 0.0),
        TYPES.types["geometry_msgs/msg/Quaternion"](0.0, 0.0, *turn),
    )
    header = TYPES.types["std_msgs/msg/Header"](_stamp(time), frames[0])
    stamped = TYPES.types["geometry_msgs/msg/TransformStamped"](header, frames[1], transform)
    return record(topic, time, [stamped])


def per_cent(entries: Table) -> NDArray[np.int8]:
    """Show table entries as ROS shows occupancy.

    Parameters
    ----------
    entries : (...) int32
        Table entries (`gapath.grid`).

    Returns
    -------
    (...) int8
        100 is kept for obstacles: a field that can be passed shows at most 99.
    """
    percent = np.minimum(np.rint(entries * (100 / SCALE)), 99)
    shown: NDArray[np.int8] = np.where(entries < OBSTACLE, percent, 100).astype(np.int8)
    return shown


def occupancy_grid_cdr(grid: GridMap, percent: NDArray[np.int8]) -> bytes:
    """Serialise a ``nav_msgs/OccupancyGrid`` at time 0.

    Parameters
    ----------
    grid : GridMap
        Its size and place.
    percent : (rows, cols) int8
        What it shows by [y, x]; -1 unknown.

    Returns
    -------
    bytes
        Its last rows x cols bytes are the rows from the bottom up, as ROS counts them.
    """
    header = TYPES.types["std_msgs/msg/Header"](_stamp(0), FRAME)
    x, y, yaw = grid.origin
    point = TYPES.types["geometry_msgs/msg/Point"](x, y, 0.0)
    turn = (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
    rotation = TYPES.types["geometry_msgs/msg/Quaternion"](*turn)
    origin = TYPES.types["geometry_msgs/msg/Pose"](point, rotation)
    info = TYPES.types["nav_msgs/msg/MapMetaData"](
        _stamp(0), grid.resolution, grid.cols, grid.rows, origin
    )
    head = record("/map", 0, header, info, np.empty(0, np.int8)).data[: -COUNT.size]
    return b"".join((head, COUNT.pack(percent.size), np.ascontiguousarray(percent[::-1]).data))


def stamp_again(message: bytearray, time: int) -> None:
    """Change the time in a message's header."""
    _STAMP.pack_into(message, len(ENCAPSULATION), *divmod(time, 10**9))


_POSE_AND_NEXT_HEADER = np.dtype(
    [("position", "<f8", 3), ("orientation", "<f8", 4), ("header", "V16")]
)


def path_cdr(time: int, metres: NDArray[np.float64]) -> bytes:
    """Serialise a ``nav_msgs/Path``, 30 times faster than pose by pose.

    Parameters
    ----------
    time : int
        Log time, in nanoseconds, of the path's and every pose's header.
    metres : (n, 2) float64
        Positions; every orientation is the identity.

    Returns
    -------
    bytes
        Little-endian CDR.
    """
    header = _header_cdr(time)
    start = ENCAPSULATION + header + COUNT.pack(len(metres))
    if not len(metres):
        return start
    # Doubles are aligned to 8 bytes. That puts 4 bytes before the first pose only, so
    # what repeats is a pose and the header of the one after it.
    poses = np.zeros(len(metres), _POSE_AND_NEXT_HEADER)
    poses["position"][:, :2] = metres
    poses["orientation"][:, 3] = 1.0
    poses["header"] = np.void(header)
    return start + header + bytes(4) + poses.tobytes()[: -len(header)]
