"""One drive through an unknown map (KG18 Sec. 4.1, Fig. 10)."""

import time
from dataclasses import dataclass, field
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.errors import require
from gapath.grid import OBSTACLE, Field, GridMap
from gapath.kernels.field_of_view import HEADING_X, HEADING_Y, heading_of
from gapath.kernels.fitness import cuts_corner
from gapath.known_map import KnownMap
from gapath.navigation import Decision, Mode, Navigator, Query
from gapath.problem import CornerCutting, Problem
from gapath.rng import Stream, stream
from gapath.world import Changes, World

HEADINGS = {
    (dx, dy): heading
    for heading, (dx, dy) in enumerate(zip(HEADING_X.tolist(), HEADING_Y.tolist(), strict=True))
}
"""Heading of a step; looked up, since a call of a kernel costs as much as ten look-ups."""


class Outcome(IntEnum):
    """How a drive ended."""

    REACHED = 0
    """The robot is at the target."""
    RETURNED = 1
    """It came back to its start in return mode: KG18's terminal failure."""
    OVERRAN = 2
    """It used up its steps."""


@dataclass(frozen=True)
class Sensor:
    """What the robot sees (KG18 Sec. 5).

    Parameters
    ----------
    range : int
        Layers of the triangle in front of it.
    occlusion : bool
        Obstacles hide what lies behind them.
    """

    range: int
    occlusion: bool

    def __post_init__(self) -> None:
        require(
            1 <= self.range <= 1000, "drive.sensor.range", self.range, "an integer from 1 to 1000"
        )


class Frame(NamedTuple):
    """A step of a drive, as it was decided and done."""

    place: Field
    """The robot's field after the step."""
    heading: int
    """Where it looked, 0 to 7."""
    decision: Decision | None
    """What the navigator wanted; None for the first look."""
    news: NDArray[np.int64]
    """(n,) flat indices of the fields that it saw for the first time or changed; in the first
    frame also of the obstacles that it knew before."""
    entries: NDArray[np.int64]
    """(n,) their table entries."""
    seconds: float
    """Wall time of the step."""


@dataclass(frozen=True, eq=False)
class Drive:
    """A drive from its first look to its end.

    Parameters
    ----------
    outcome : Outcome
        How it ended.
    frames : list of Frame
        The first look, then one frame a step.
    compute_time_s : float
        Wall time of looking and deciding, in seconds.
    """

    outcome: Outcome
    frames: list[Frame] = field(repr=False)
    compute_time_s: float


def drive(
    problem: Problem,
    navigator: Navigator,
    sensor: Sensor,
    changes: Changes,
    seed: int,
    trial: int,
    step_limit: int,
    unknown_weight: float,
    before: GridMap | None = None,
) -> Drive:
    """Drive once.

    Parameters
    ----------
    problem : Problem
        The true map, start, target and corner-cutting rule.
    navigator : Navigator
        Decides.
    sensor : Sensor
        Sees.
    changes : Changes
        What happens to the map meanwhile.
    seed, trial : int
        Keys of all random streams.
    step_limit : int
        Steps after which the drive has overrun.
    unknown_weight : float
        What an unknown field counts.
    before : GridMap, optional
        What the robot knows before it starts.

    Returns
    -------
    Drive
        How it ended, and every step.
    """
    start, target = problem.start, problem.target
    world = World(problem.map, changes, (start, target), seed, trial)
    known = KnownMap(problem.map, start, target, unknown_weight, before)
    rule = int(problem.corner_cutting)
    place, mode = start, Mode.EXPLORE
    heading = int(heading_of(target[0] - start[0], target[1] - start[1]))

    begin = last = time.perf_counter()
    news, entries = known.look(world.table, place, heading, sensor.range, sensor.occlusion)
    query = Query(known, start, target, problem.corner_cutting)
    state = navigator.begin(query)
    now = time.perf_counter()
    if before is not None:  # the first frame tells all that is known
        news = np.union1d(np.flatnonzero(before.obstacles), news)
        entries = known.table.ravel()[news].astype(np.int64)
    frames = [Frame(place, heading, None, news, entries, now - last)]
    outcome = Outcome.OVERRAN
    for step in range(step_limit + 1):
        if place == target:
            outcome = Outcome.REACHED
            break
        if place == start and mode is Mode.RETURN:
            outcome = Outcome.RETURNED
            break
        if step == step_limit:
            break
        last = time.perf_counter()
        world.advance(step, place)

        def streams(part: int, index: int, step: int = step) -> Stream:
            return stream(seed, trial, (step + 1) << 16 | part << 8 | index)

        decision = navigator.step(state, query, news, streams)
        mode = decision.mode
        dx, dy = decision.place[0] - place[0], decision.place[1] - place[1]
        if dx or dy:
            heading = HEADINGS[dx, dy]
        news, entries = known.look(world.table, place, heading, sensor.range, sensor.occlusion)
        u, v = decision.place
        # the sensor has shown what blocks the step: the next decision knows it
        blocked = world.table[v, u] >= OBSTACLE or (
            rule != CornerCutting.ALLOW and cuts_corner(world.table, *place, u, v, rule)
        )
        if (dx or dy) and not blocked:
            place, state = decision.place, decision.moved
            query = Query(known, place, target, query.corner_cutting)
        else:
            state = decision.stood
        now = time.perf_counter()
        frames.append(Frame(place, heading, decision, news, entries, now - last))
    return Drive(outcome, frames, time.perf_counter() - begin)
