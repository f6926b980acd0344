"""One drive through an unknown map (KG18 Sec. 4.1, Fig. 10)."""

import time
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from gapath.driving.known_map import KnownMap, Looks
from gapath.driving.navigation import Decision, Following, Navigator, Situation
from gapath.driving.world import Changes, World
from gapath.errors import Checks
from gapath.events import Mode, Outcome
from gapath.grid import Field, GridMap
from gapath.kernels.field_of_view import HEADING_X, HEADING_Y, heading_of
from gapath.kernels.lines import cuts_corner
from gapath.kernels.rng import Stream, stream
from gapath.kernels.units import ALLOW, OBSTACLE
from gapath.problem import Problem

HEADINGS = {
    (dx, dy): heading
    for heading, (dx, dy) in enumerate(zip(HEADING_X.tolist(), HEADING_Y.tolist(), strict=True))
}
"""Heading of a step; looked up, since a call of a kernel costs as much as ten look-ups."""


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
        check = Checks(self, "drive.sensor")
        check.whole("range", 1, 1000)


class Frame(NamedTuple):
    """A step of a drive, as it was decided and done."""

    place: Field
    """The robot's field after the step."""
    heading: int
    """Where it looked, 0 to 7."""
    decision: Decision | None
    """What the navigator wanted, without states where it had decided so before; None for the
    first look."""
    news: NDArray[np.int64]
    """(n,) flat indices of the fields that it saw for the first time or changed; in the first
    frame also of the obstacles that it knew before."""
    entries: NDArray[np.int64]
    """(n,) their table entries."""
    seconds: float
    """Wall time of the step; steps that were decided together share theirs equally."""


class Leg(NamedTuple):
    """What came of one decision: a step, or several along a path."""

    decision: Decision | None
    """None for the first look."""
    looks: Looks
    """One for each step."""
    passed: tuple[Field, ...]
    """The robot's field after each step but for a last one that it could not make."""
    seconds: float
    """Wall time of deciding and looking."""


@dataclass(frozen=True, eq=False)
class Driven:
    """A drive from its first look to its end.

    Parameters
    ----------
    sensor : Sensor
        What its robot saw.
    step_limit : int
        Steps after which it would have overrun.
    unknown_weight : float
        What an unknown field counted.
    outcome : Outcome
        How it ended.
    legs : list of Leg
        The first look, then one leg a decision.
    compute_time_s : float
        Wall time of looking and deciding, in seconds.
    """

    sensor: Sensor
    step_limit: int
    unknown_weight: float
    outcome: Outcome
    legs: list[Leg] = field(repr=False)
    compute_time_s: float

    @cached_property
    def frames(self) -> list[Frame]:
        """The first look, then one frame a step."""
        frames: list[Frame] = []
        (place,) = self.legs[0].passed
        for decision, looks, passed, seconds in self.legs:
            begin = 0
            for i, (heading, end) in enumerate(zip(looks.headings, looks.ends, strict=True)):
                now = decision if i == 0 else _gone_on(decision, i, passed)
                place = passed[i] if i < len(passed) else place
                share = seconds / len(looks.ends)
                news, entries = looks.news[:, begin:end]
                frames.append(Frame(place, heading, now, news, entries, share))
                begin = end
        return frames


def _gone_on(decision: Decision | None, i: int, passed: tuple[Field, ...]) -> Decision:
    """Give what the navigator wanted i fields after it had decided to follow a path."""
    assert decision is not None and decision.path is not None
    rest, past = decision.path[i:], decision.past + passed[:i]
    place = (int(rest[1, 0]), int(rest[1, 1]))
    return Decision(place, Mode.EXPLORE, None, None, (), rest, past)


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
) -> Driven:
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
    Driven
        How it ended, and every step.
    """
    start, target = problem.start, problem.target
    world = World(problem.map, changes, (start, target), seed, trial)
    known = KnownMap(problem.map, start, target, unknown_weight, before)
    sees = (sensor.range, sensor.occlusion)
    rule = int(problem.corner_cutting)
    place, mode = start, Mode.EXPLORE
    heading = int(heading_of(target[0] - start[0], target[1] - start[1]))

    begin = last = time.perf_counter()
    looks = known.look(world.table, place, heading, *sees)
    query = Situation(known, start, target, problem.corner_cutting)
    state = navigator.begin(query)
    now = time.perf_counter()
    if before is not None:  # the first leg tells all that is known
        news = np.union1d(np.flatnonzero(before.obstacles), looks.news[0])
        entries = known.table.ravel()[news].astype(np.int64)
        looks = Looks(looks.headings, [len(news)], np.stack([news, entries]))
    legs = [Leg(None, looks, (place,), now - last)]
    step = 0

    def streams(part: int, index: int) -> Stream:
        return stream(seed, trial, (step + 1) << 16 | part << 8 | index)

    while True:
        if place == target:
            outcome = Outcome.REACHED
            break
        if place == start and mode is Mode.RETURN:
            outcome = Outcome.RETURNED
            break
        if step == step_limit:
            outcome = Outcome.OVERRAN
            break
        last = time.perf_counter()
        world.advance(step, place)
        decision = navigator.step(state, query, looks.news[0], streams)
        mode, path = decision.mode, decision.path
        fields = min(decision.fields, step_limit - step)
        if fields > 1 and path is not None and not changes.every:
            looks = known.follow(world.table, path, fields, rule, *sees)
            xs, ys = path[1 : len(looks.ends) + 1].T.tolist()
            ahead = tuple(zip(xs, ys, strict=True))
        else:
            dx, dy = decision.place[0] - place[0], decision.place[1] - place[1]
            if dx or dy:
                heading = HEADINGS[dx, dy]
            looks = known.look(world.table, place, heading, *sees)
            ahead = (decision.place,)
        heading = looks.headings[-1]
        # the sensor has shown what blocks the last step: the next decision knows it
        (x, y), (u, v) = ahead[-2] if len(ahead) > 1 else place, ahead[-1]
        blocked = world.table[v, u] >= OBSTACLE or (
            rule != ALLOW and cuts_corner(world.table, x, y, u, v, rule)
        )
        passed = ahead[:-1] if blocked or (x, y) == (u, v) else ahead
        state = decision.moved if passed else decision.stood
        if passed:
            place = passed[-1]
            query = Situation(known, place, target, problem.corner_cutting)
        if len(passed) > 1:
            state = cast(Following, state).further(passed[1:])
        step += len(ahead)
        legs.append(Leg(decision, looks, passed, time.perf_counter() - last))
    seconds = time.perf_counter() - begin
    return Driven(sensor, step_limit, unknown_weight, outcome, legs, seconds)
