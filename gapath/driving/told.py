"""A drive told as events."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gapath.driving.drive import Driven
from gapath.driving.navigation import Past
from gapath.events import (
    Called,
    DriveFinished,
    DriveStarted,
    Event,
    Mode,
    PathsChanged,
    Stepped,
    TrialStarted,
)
from gapath.grid import Field
from gapath.problem import no_path


def drive_events(driven: Driven, cols: int, seed: int, trial: int, step: int) -> Iterator[Event]:
    """Tell a drive as events.

    Parameters
    ----------
    driven : Driven
        The drive.
    cols : int
        Width of the map.
    seed, trial : int
        Keys of the drive's random streams.
    step : int
        The step at which the trial begins: that of its first look.

    Yields
    ------
    Event
        Its start, and what its robot can do; for each step the planners called, the paths if they
        changed, the step itself; its end.
    """
    yield TrialStarted(step, trial, seed)
    layers, unknown = driven.sensor.range, driven.unknown_weight
    yield DriveStarted(step, trial, layers, unknown, driven.step_limit)
    path = no_path()
    past: Past | tuple[Field, ...] = ()
    for i, frame in enumerate(driven.frames):
        now, decision = step + i, frame.decision
        mode = Mode.EXPLORE
        if decision is not None:
            mode = decision.mode
            for call in decision.calls:
                yield Called(
                    now,
                    trial,
                    call.part,
                    call.index,
                    call.adopted,
                    call.plan.answer,
                )
            new_path = path[:0] if decision.path is None else decision.path
            new_past = decision.past
            if not _continues(path, new_path) or not _extends(past, new_past):
                way_back = np.array(tuple(new_past), dtype=np.int32).reshape(-1, 2)
                yield PathsChanged(now, trial, new_path, way_back)
            path, past = new_path, new_past
        fields = np.stack([frame.news % cols, frame.news // cols], axis=1).astype(np.int32)
        entries = frame.entries.astype(np.int32)
        yield Stepped(now, trial, frame.place, frame.heading, mode, fields, entries, frame.seconds)
    places = [frame.place for frame in driven.frames]
    stands = sum(now == before for before, now in pairwise(places))
    steps = len(places) - 1
    yield DriveFinished(step + steps, trial, driven.outcome, steps, stands)


def _continues(before: NDArray[np.int32], now: NDArray[np.int32]) -> bool:
    """Tell whether a path is what is left of another."""
    return len(before) - len(now) in (0, 1) and np.array_equal(
        before[len(before) - len(now) :], now
    )


def _extends(before: Sequence[Field], now: Sequence[Field]) -> bool:
    """Tell whether a past path is another, longer or shorter by at most one field."""
    shared = min(len(before), len(now))
    return abs(len(before) - len(now)) <= 1 and before[:shared] == now[:shared]
