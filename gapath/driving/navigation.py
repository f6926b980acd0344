"""A drive through an unknown map, step by step: what every navigator must offer."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol, overload, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from gapath.driving.known_map import KnownMap
from gapath.events import Mode
from gapath.grid import Field
from gapath.kernels.rng import Stream
from gapath.problem import Answer, CornerCutting

Path = NDArray[np.int32]

StreamOf = Callable[[int, int], Stream]
"""The random stream of one call within a step: (part, index) -> stream."""


class Situation(NamedTuple):
    """What a navigator asks a planner: from the robot's field, on what it knows."""

    map: KnownMap
    start: Field
    target: Field
    corner_cutting: CornerCutting


@dataclass(frozen=True, eq=False)
class Call:
    """A planner was called in this step."""

    part: str
    """A, B or C (KG18 Figs 12-14)."""
    index: int
    """Number of the planner in its part's list."""
    plan: Answer
    """Its answer."""
    adopted: bool
    """Whether its path became the current one."""


class Past(Sequence[Field]):
    """A past path; one that goes on from another shares the fields of both.

    So a drive takes time and memory as its steps, not as their square.

    Parameters
    ----------
    fields : iterable of (x, y)
        Fields in the order in which they were reached.
    """

    __slots__ = ("_fields", "_length")

    def __init__(self, fields: Iterable[Field]) -> None:
        self._fields = list(fields)  # of all that share it: only ever longer
        self._length = len(self._fields)

    def __len__(self) -> int:
        """Give how many fields it has."""
        return self._length

    @overload
    def __getitem__(self, index: int) -> Field: ...
    @overload
    def __getitem__(self, index: slice) -> "Past": ...
    def __getitem__(self, index: int | slice) -> "Field | Past":
        """Give a field, or the past path of some; a beginning is shared."""
        if not isinstance(index, slice):
            return self._fields[range(self._length)[index]]
        begin, end, step = index.indices(self._length)
        if begin == 0 and step == 1:
            return self._beginning(end)
        return Past(self._fields[: self._length][index])

    def __iter__(self) -> Iterator[Field]:
        """Give its fields in order."""
        return iter(self._fields[: self._length])

    def __add__(self, fields: tuple[Field, ...]) -> "Past":
        """Go on; where another has gone on otherwise already, it is left to that one."""
        known, end = self._fields, self._length + len(fields)
        if len(known) > self._length:
            if tuple(known[self._length : end]) == fields:
                return self._beginning(end)
            return Past((*known[: self._length], *fields))
        known.extend(fields)
        return self._beginning(end)

    def __eq__(self, other: object) -> bool:
        """Tell whether another sequence has the same fields."""
        if isinstance(other, Past) and other._fields is self._fields:
            return other._length == self._length
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]

    def _beginning(self, length: int) -> "Past":
        beginning = Past.__new__(Past)
        beginning._fields, beginning._length = self._fields, length
        return beginning


class Following(Protocol):
    """State of a navigator whose robot follows a path."""

    def further(self, fields: tuple[Field, ...]) -> "Following":
        """Give the state after these next fields of the path were passed."""


class Decision(NamedTuple):
    """What a navigator wants to do in a step."""

    place: Field
    """The next field; the robot's own if it stands."""
    mode: Mode
    """What it is doing."""
    moved: object
    """The navigator's state after the move."""
    stood: object
    """Its state if the next field turns out to be blocked."""
    calls: tuple[Call, ...] = ()
    """The planners it called."""
    path: Path | None = None
    """The current path from the robot's field on, (n, 2) int32; None if it has none."""
    past: Past | tuple[Field, ...] = ()
    """The way back, oldest field first, the robot's own last."""
    fields: int = 1
    """How many fields of the path to pass before the next decision; that comes sooner if an
    obstacle turns up on the path. If more than one, `moved` is `Following`."""


@runtime_checkable
class Navigator(Protocol):
    """What a module of `gapath.navigators` offers under the name ``Navigator``.

    A frozen dataclass whose fields are the settings of its YAML file in ``conf/navigator``. One
    that does not take every map is `gapath.planning.planner.Particular`, too.
    """

    @property
    def complete(self) -> bool:
        """True if it reaches every target that can be reached on a map that does not change."""

    def begin(self, query: Situation) -> object:
        """Give the state before the first step.

        Parameters
        ----------
        query : Situation
            Start, target and what is known before the first look.

        Returns
        -------
        object
            The navigator's state.
        """

    def step(
        self, state: object, query: Situation, news: NDArray[np.int64], streams: StreamOf
    ) -> Decision:
        """Decide what to do next.

        Parameters
        ----------
        state : object
            As the step before left it.
        query : Situation
            The robot's field, the target, and what is known now.
        news : (n,) int64
            Flat indices of the fields of the known map that changed since the last decision.
        streams : callable
            Random streams, by part and index.

        Returns
        -------
        Decision
            The next field and both states that may follow.
        """
