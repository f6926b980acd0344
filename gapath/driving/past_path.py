"""The past path: going on along a path, and back in one's own footsteps.

`Track` is for navigators that have no parts of KG18's: they go on while their path is free
and go back when there is none.
"""

from dataclasses import dataclass, replace
from typing import Any

from gapath.driving.navigation import Call, Decision, Path
from gapath.events import Mode
from gapath.grid import Field


def simplified(past: tuple[Field, ...]) -> tuple[Field, ...]:
    """Cut every loop out of a past path (KG18 Sec. 4.6).

    Parameters
    ----------
    past : tuple of (x, y)
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


@dataclass(frozen=True, eq=False)
class Track:
    """Where a robot came from and where it is going.

    Parameters
    ----------
    past : tuple of (x, y)
        The past path, the robot's own field last.
    path : (n, 2) int32 or None
        The current path.
    at : int
        Index of the robot's own field on it.
    returning : bool
        Going back, because there is no path.
    memory : object
        What else the navigator remembers.
    """

    past: tuple[Field, ...]
    path: Path | None = None
    at: int = 0
    returning: bool = False
    memory: Any = None

    def adopt(self, path: Path) -> "Track":
        """Take a path that begins in the robot's field."""
        return replace(self, path=path, at=0, returning=False)

    def further(self, fields: tuple[Field, ...]) -> "Track":
        """Pass the next fields of the current path."""
        return replace(self, at=self.at + len(fields), past=self.past + fields)

    def go_on(self, calls: tuple[Call, ...] = (), to_end: bool = False) -> Decision:
        """Go to the next field of the current path, or to its end while it is free."""
        assert self.path is not None
        rest = self.path[self.at :]
        place = (int(rest[1, 0]), int(rest[1, 1]))
        mode = Mode.REPLAN if calls else Mode.EXPLORE
        fields = len(rest) - 1 if to_end else 1
        return Decision(place, mode, self.further((place,)), self, calls, rest, self.past, fields)

    def go_back(self, calls: tuple[Call, ...] = ()) -> Decision:
        """Go back to the field before; at the start, stand."""
        past = self.past if self.returning else simplified(self.past)
        stood = replace(self, past=past, path=None, at=0, returning=True)
        moved = replace(stood, past=past[:-1] or past)
        return Decision(moved.past[-1], Mode.RETURN, moved, stood, calls, None, past)
