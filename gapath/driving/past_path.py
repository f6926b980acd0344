"""The past path: going on along a path, and back in one's own footsteps.

`Track` is for navigators that have no parts of KG18's: they go on while their path is free
and go back when there is none.
"""

from typing import Any, NamedTuple

from gapath.driving.navigation import Call, Decision, Past, Path
from gapath.events import Mode
from gapath.grid import Field


def simplified(past: Past | tuple[Field, ...]) -> tuple[Field, ...]:
    """Cut every loop out of a past path (KG18 Sec. 4.6).

    Parameters
    ----------
    past : Past or tuple of (x, y)
        Fields in the order in which they were reached.

    Returns
    -------
    tuple of (x, y)
        No field twice, the same two ends: from each field the way goes on behind its last
        occurrence.
    """
    last = {place: i for i, place in enumerate(past)}
    kept = []
    i = 0
    while i < len(past):
        kept.append(past[i])
        i = last[past[i]] + 1
    return tuple(kept)


class Track(NamedTuple):
    """Where a robot came from and where it is going."""

    past: Past
    """The past path, the robot's own field last."""
    path: Path | None = None
    """(n, 2) int32 the current path."""
    at: int = 0
    """Index of the robot's own field on it."""
    returning: bool = False
    """Going back, because there is no path."""
    memory: Any = None
    """What else the navigator remembers."""

    def adopt(self, path: Path) -> "Track":
        """Take a path that begins in the robot's field."""
        return Track(self.past, path, 0, False, self.memory)

    def further(self, fields: tuple[Field, ...]) -> "Track":
        """Pass the next fields of the current path."""
        past, at = self.past + fields, self.at + len(fields)
        return Track(past, self.path, at, self.returning, self.memory)

    def go_on(self, calls: tuple[Call, ...] = (), to_end: bool = False) -> Decision:
        """Go to the next field of the current path, or to its end while it is free."""
        assert self.path is not None
        rest = self.path[self.at :]
        x, y = rest[1].tolist()
        place = (x, y)
        mode = Mode.REPLAN if calls else Mode.EXPLORE
        fields = len(rest) - 1 if to_end else 1
        return Decision(place, mode, self.further((place,)), self, calls, rest, self.past, fields)

    def go_back(self, calls: tuple[Call, ...] = ()) -> Decision:
        """Go back to the field before; at the start, stand."""
        past = self.past if self.returning else Past(simplified(self.past))
        stood = Track(past, returning=True, memory=self.memory)
        moved = stood._replace(past=past[:-1] or past)
        return Decision(moved.past[-1], Mode.RETURN, moved, stood, calls, None, past)
