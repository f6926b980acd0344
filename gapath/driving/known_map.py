"""What the robot knows: unknown fields count as free (KG18 Sec. 3.12)."""

import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.components import build
from gapath.discovery import reader_of, yaml_values
from gapath.errors import InputError
from gapath.grid import Field, GridMap, Table
from gapath.kernels.field_of_view import follow, sense
from gapath.kernels.units import OBSTACLE, SCALE

KNOWN = "drive.known_map"
"""The setting that names what the robot knows before it starts."""


class Looks(NamedTuple):
    """What one look showed, or several on the way along a path."""

    headings: list[int]
    """Where the robot looked, each 0 to 7 (`gapath.kernels.field_of_view`)."""
    ends: list[int]
    """How many news there were after each look."""
    news: NDArray[np.int64]
    """(2, n) flat indices of the fields that are new or have changed, and their table entries."""


class KnownMap:
    """The map in the robot's head; it grows as the robot looks around.

    Parameters
    ----------
    world : GridMap
        The true map: its size, and what is known from the start of the two ends.
    start, target : (x, y)
        Fields whose weight is known (KG18 Sec. 2: the paper's are 0).
    unknown_weight : float
        What the robot takes an unknown field to cost.
    before : GridMap, optional
        What the robot knows before it starts; where it is free it counts as unknown.
    """

    def __init__(
        self,
        world: GridMap,
        start: Field,
        target: Field,
        unknown_weight: float,
        before: GridMap | None = None,
    ) -> None:
        unknown = int(unknown_weight * SCALE + 0.5)
        self._table: Table = np.full((world.rows, world.cols), unknown, dtype=np.int32)
        self.seen: NDArray[np.bool_] = np.zeros((world.rows, world.cols), dtype=np.bool_)
        if before is not None:
            blocked = before.table >= OBSTACLE
            self._table[blocked] = OBSTACLE
        for x, y in (start, target):
            self._table[y, x] = world.table[y, x]
            self.seen[y, x] = True
        self.table = _read_only(self._table)
        self._ends = (start, target)
        self._resolution = world.resolution
        self._least = np.array([unknown], dtype=np.int64)
        # A start lighter than all other fields spoils their weight as a bound only for fields
        # from which a straightest way to the target leads over it.
        light = int(world.table[start[1], start[0]]) < unknown
        self._start_may_shorten = light and _lies_between(start, target, self.rows, self.cols)

    @property
    def rows(self) -> int:
        """Number of fields from top to bottom."""
        return int(self.table.shape[0])

    @property
    def cols(self) -> int:
        """Number of fields from left to right."""
        return int(self.table.shape[1])

    @property
    def resolution(self) -> float:
        """Side of a field in metres."""
        return self._resolution

    def least_weight(self, start: Field, target: Field) -> int:
        """Give a table entry that bounds the weights of fields between start and target."""
        return 0 if self._start_may_shorten and start not in self._ends else int(self._least[0])

    def look(self, world: Table, place: Field, heading: int, layers: int, occlusion: bool) -> Looks:
        """Take over what the robot sees, in one call of a kernel.

        Parameters
        ----------
        world : (rows, cols) int32
            The true map now.
        place : (x, y)
            The robot's field.
        heading : int
            0 to 7 (`gapath.kernels.field_of_view`).
        layers : int
            Range of the sensor.
        occlusion : bool
            Obstacles hide what lies behind them.

        Returns
        -------
        Looks
            What it showed.
        """
        news = np.empty((2, (layers + 1) ** 2), dtype=np.int64)
        state = (self._table, self.seen)
        count = sense(world, *state, *place, heading, layers, occlusion, news, 0, self._least)
        return Looks([heading], [count], news[:, :count])

    def follow(
        self,
        world: Table,
        path: NDArray[np.int32],
        fields: int,
        rule: int,
        layers: int,
        occlusion: bool,
    ) -> Looks:
        """Take over what the robot sees on its way along a path, in one call of a kernel.

        It looks before each step, and stops at the target, which a path may pass before its end,
        or when it sees an obstacle on the path.

        Parameters
        ----------
        world : (rows, cols) int32
            The true map, which must not change meanwhile.
        path : (n, 2) int32
            Fields as (x, y), the robot's own first.
        fields : int
            Most steps, fewer than n.
        rule : int
            Corner-cutting rule.
        layers, occlusion
            As of `look`.

        Returns
        -------
        Looks
            One for each step; all steps were made but for the last, which may be blocked.
        """
        most = min(fields * (layers + 1) ** 2, world.size)  # no field is news twice
        news = np.empty((2, most), dtype=np.int64)
        told = np.empty((2, fields), dtype=np.int64)
        state = (self._table, self.seen)
        u, v = self._ends[1]
        count = follow(
            world,
            *state,
            path,
            fields,
            v * self.cols + u,
            rule,
            layers,
            occlusion,
            news,
            told,
            self._least,
        )
        headings, ends = told[:, :count].tolist()
        return Looks(headings, ends, news[:, : ends[-1]].copy())  # without the room for more

    def dearer(self, places: tuple[Field, ...], penalty: float) -> "KnownMap":
        """Give a copy on which some fields cost more."""
        dearer = copy.copy(self)
        dearer._table = self.table.copy()
        rows, cols = [y for _, y in places], [x for x, _ in places]
        before = self.table[rows, cols].astype(np.int64)
        after = np.minimum(before + int(penalty * SCALE), OBSTACLE - 1)
        dearer._table[rows, cols] = np.where(before >= OBSTACLE, OBSTACLE, after)
        dearer.table = _read_only(dearer._table)
        return dearer


def read_known_map(path: str) -> GridMap:
    """Read what a robot knows before it starts: what that map calls unknown stays unknown.

    Parameters
    ----------
    path : str
        A map file.

    Returns
    -------
    GridMap
        Its obstacles are known, everything else is not.

    Raises
    ------
    InputError
        If the file cannot be used.
    """
    kind = reader_of(path, KNOWN)
    values = yaml_values("map", kind) | {"path": path}
    if "unknown" in values:
        values["unknown"] = "free"
    try:
        grid: GridMap = build("map", values, KNOWN).read()
    except InputError as error:
        raise InputError(f"{KNOWN}, {error.where}", error.value, error.expected) from error
    return grid


def _read_only(table: Table) -> Table:
    """Give a view of the type that `GridMap.table` has: kernels are compiled once for both."""
    view = table.view()
    view.setflags(write=False)
    return view


def _lies_between(start: Field, target: Field, rows: int, cols: int) -> bool:
    """Tell whether the start lies on a straightest way to the target from any other field.

    If so, then from a neighbour: the field before the start on that way.
    """
    (x, y), (u, v) = start, target
    distance = max(abs(u - x), abs(v - y))
    return any(
        max(abs(u - i), abs(v - j)) > distance
        for i in range(max(x - 1, 0), min(x + 2, cols))
        for j in range(max(y - 1, 0), min(y + 2, rows))
    )
