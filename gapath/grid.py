"""Grid maps: weights in [0, 1] on square fields (KG18 Sec. 2).

The one rule of coordinates: a field is written (x, y), x to the right, y down, (0, 0)
top left; arrays are indexed ``[y, x]``. Metres (ROS) point up: see `GridMap.to_metres`.
"""

import hashlib
import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gapath.errors import InputError, require
from gapath.kernels.table import fill_parts, fill_table, least_three
from gapath.kernels.units import ALLOW
from gapath.pictures.shown import Shown, axes_for

if TYPE_CHECKING:
    from gapath.pictures.shown import Axes

Field: TypeAlias = tuple[int, int]
"""A field of the map as (x, y)."""

Table: TypeAlias = NDArray[np.int32]
"""What kernels read, (rows, cols): the weight in units of 1 / `SCALE`, or `OBSTACLE`."""

MAX_FIELDS = 1 << 26
"""Fields of the largest map that is accepted (8192 x 8192)."""

MAX_SIDE = 1 << 16
"""Longest side of a map that is accepted."""


class PlanningMap(Protocol):
    """The part of a map that planners use: of a `GridMap`, or of what a robot knows of one."""

    @property
    def table(self) -> Table:
        """What kernels read, (rows, cols) int32."""

    @property
    def rows(self) -> int:
        """Number of fields from top to bottom."""

    @property
    def cols(self) -> int:
        """Number of fields from left to right."""

    @property
    def resolution(self) -> float:
        """Side of a field in metres."""

    def least_weight(self, start: Field, target: Field) -> int:
        """Give a table entry that no field between start and target undercuts."""


@dataclass(frozen=True, eq=False)
class GridMap(Shown):
    """A map of square fields, each with the cost of passing it.

    Parameters
    ----------
    name : str
        Short name, used in tables and file names.
    weights : (rows, cols) float64
        Cost of passing each field: 0 preferred, 0.5 the usual base, 1 an obstacle. An array that
        cannot be written any more is kept, of another a copy.
    start, target : (x, y), optional
        The fields that the map's author means a robot to go from and to.
    instance : int
        Number within a generated class; 0 is the canonical one.
    source : str
        Where the map comes from: "reconstructed", a format's name, or "array".
    resolution : float
        Side of a field in metres.
    origin : (x, y, yaw)
        Pose of the lower left corner of the map, in metres and radians.
    published_length : float
        Octile length of a shortest path from start to target, in fields, as the map's author
        gives it; NaN if nobody does.
    inverted : bool, optional
        Of a picture that could be read either way: whether dark was taken for an obstacle.

    Raises
    ------
    InputError
        If the array is not two-dimensional, is empty or too large, or has a weight that
        is not a finite number in [0, 1].
    """

    name: str
    weights: NDArray[np.float64] = field(repr=False)
    start: Field | None = None
    target: Field | None = None
    instance: int = 0
    source: str = "array"
    resolution: float = 1.0
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    published_length: float = math.nan
    inverted: bool | None = None

    def __post_init__(self) -> None:
        where = f"map {self.name}"
        try:
            given = np.asarray(self.weights)
            require(given.dtype.kind in "biuf", where, f"an array of {given.dtype}", "real numbers")
            base: Any = given
            while isinstance(base, np.ndarray) and not base.flags.writeable:
                base = base.base
            final = base is None or isinstance(base, bytes)
            kept = final and given.dtype == np.float64 and given.flags.c_contiguous
            weights = given if kept else np.array(given, dtype=np.float64, order="C")
        except ValueError as error:  # rows of different lengths
            if isinstance(error, InputError):
                raise
            raise InputError(where, type(self.weights).__name__, "an array of numbers") from error
        require(
            weights.ndim == 2 and weights.size > 0,
            where,
            f"shape {weights.shape}",
            "a non-empty array of (rows, cols)",
        )
        require(
            weights.size <= MAX_FIELDS and max(weights.shape) <= MAX_SIDE,
            where,
            f"shape {weights.shape}",
            f"at most {MAX_FIELDS} fields, {MAX_SIDE} a side",
        )
        if not (weights.min() >= 0.0 and weights.max() <= 1.0):  # also where one is NaN
            y, x = np.argwhere(~((weights >= 0.0) & (weights <= 1.0)))[0]
            place, right = f"{where}, field ({x}, {y})", "a finite weight in [0, 1]"
            raise InputError(place, weights[y, x], right)
        numbers = (self.resolution, *self.origin)
        require(
            all(isinstance(v, int | float) for v in numbers),
            f"{where}, resolution and origin",
            numbers,
            "numbers",
        )
        good = math.isfinite(self.resolution) and self.resolution > 0
        require(good, f"{where}, resolution", self.resolution, "a positive number of metres")
        right = "three finite numbers (metres, metres, radians)"
        require(all(map(math.isfinite, self.origin)), f"{where}, origin", self.origin, right)
        weights.setflags(write=False)
        # file names may hold bytes that are no text; logs and tables cannot
        name = self.name.encode("utf-8", "replace").decode("utf-8")
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "weights", weights)

    @property
    def rows(self) -> int:
        """Number of fields from top to bottom."""
        return int(self.weights.shape[0])

    @property
    def cols(self) -> int:
        """Number of fields from left to right."""
        return int(self.weights.shape[1])

    @cached_property
    def table(self) -> Table:
        """The map as kernels read it, (rows, cols) int32, built once per map."""
        table = np.empty(self.weights.shape, dtype=np.int32)
        fill_table(self.weights.ravel(), table.ravel())
        table.setflags(write=False)
        return table

    @cached_property
    def obstacles(self) -> NDArray[np.bool_]:
        """True where a field cannot be passed, (rows, cols)."""
        return np.equal(self.weights, 1.0)

    def least_weight(self, start: Field, target: Field) -> int:
        """Give the least table entry of any field but start and target (0 if none is left)."""
        cols = self.weights.shape[1]
        begin, end = start[1] * cols + start[0], target[1] * cols + target[0]
        for entry, i in self._lightest:
            if i != begin and i != end:
                return entry
        return 0

    def is_even(self, start: Field, target: Field) -> bool:
        """Tell whether all free fields but start and target weigh the same."""
        if self._lightest[0][0] == -self._heaviest[0][0]:
            return True  # they do, too
        ends = (start[1] * self.cols + start[0], target[1] * self.cols + target[0])
        most = next((-entry for entry, i in self._heaviest if i not in ends), 0)
        return abs(most) == self.least_weight(start, target)

    @cached_property
    def _lightest(self) -> list[tuple[int, int]]:
        return least_three(self.table.ravel())

    @cached_property
    def _heaviest(self) -> list[tuple[int, int]]:  # obstacles come last here, too
        table = -self.table
        np.copyto(table, self.table, where=self.obstacles)
        return least_three(table.ravel())

    def joined(self, start: Field, target: Field, rule: int) -> bool:
        """Tell whether a path joins two free fields (`parts`)."""
        parts = self.parts(rule)
        return bool(parts[start[1], start[0]] == parts[target[1], target[0]])

    def parts(self, rule: int) -> NDArray[np.int32]:
        """Give the number of each field's part, (rows, cols) from 1; 0 for obstacles.

        Paths under the corner-cutting rule join the fields of a part; it is done once a map.
        """
        return self._parts_by_corners if rule == ALLOW else self._parts_by_sides

    @cached_property
    def _parts_by_corners(self) -> NDArray[np.int32]:
        return self._parts(diagonal=True)

    @cached_property
    def _parts_by_sides(self) -> NDArray[np.int32]:
        """Of all other rules: where they let a diagonal step pass there is a way beside it."""
        return self._parts(diagonal=False)

    def _parts(self, diagonal: bool) -> NDArray[np.int32]:
        parts = np.zeros(self.weights.shape, dtype=np.int32)
        fill_parts(self.table, diagonal, parts)
        return parts

    @cached_property
    def digest(self) -> str:
        """SHA-256 of what a planner and a log see of the map: weights, shape, scale and place."""
        text = f"{self.rows} {self.cols} {self.resolution!r} {self.origin!r} "
        digest = hashlib.sha256(text.encode())
        for row in self.weights:  # one at a time: as bytes the largest map takes a gigabyte
            digest.update(row.astype("<f8", copy=False).data)
        return digest.hexdigest()

    def contains(self, place: Field) -> bool:
        """Tell whether a field (x, y) lies on the map."""
        rows, cols = self.weights.shape
        return bool(0 <= place[0] < cols and 0 <= place[1] < rows)

    def to_metres(self, fields: NDArray[np.int32]) -> NDArray[np.float64]:
        """Give the centres of fields in the map's metric frame, which has y up.

        Parameters
        ----------
        fields : (n, 2) int32
            Fields as (x, y).

        Returns
        -------
        (n, 2) float64
            Metres in the frame that `origin` is given in (REP 103, REP 105).
        """
        scale, offset = self._metric
        metres: NDArray[np.float64] = fields * scale
        metres += offset
        x, y, yaw = self.origin
        if yaw == 0.0:  # the offset has the origin in it
            return metres
        cos, sin = math.cos(yaw), math.sin(yaw)
        right, up = metres[:, 0].copy(), metres[:, 1].copy()
        metres[:, 0] = x + right * cos - up * sin
        metres[:, 1] = y + right * sin + up * cos
        return metres

    def to_fields(self, metres: ArrayLike) -> NDArray[np.int32]:
        """Give the fields in which points lie: `to_metres` the other way.

        Parameters
        ----------
        metres : (n, 2) array_like
            Points as (x, y) in metres, in the frame that `origin` is given in.

        Returns
        -------
        (n, 2) int32
            Fields as (x, y); of a point beyond the map's border one beyond it, too.

        Raises
        ------
        InputError
            If they are no points of two finite numbers.
        """
        points = np.asarray(metres, dtype=np.float64)
        good = points.ndim == 2 and points.shape[1] == 2 and bool(np.isfinite(points).all())
        require(good, "metres", metres, "points (x, y) of two finite numbers")
        x, y, yaw = self.origin
        right, up = (points - (x, y)).T / self.resolution
        if yaw != 0.0:
            cos, sin = math.cos(yaw), math.sin(yaw)
            right, up = right * cos + up * sin, up * cos - right * sin
        fields = np.stack([np.floor(right), self.rows - 1 - np.floor(up)], axis=1)
        return fields.clip(-1, MAX_SIDE).astype(np.int32)

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the map, and its start and target where it has them (`Shown.plot`)."""
        from gapath.pictures.board import draw_map, mark_ends

        ax = axes_for(ax)
        draw_map(ax, self.weights)
        mark_ends(ax, self.start, self.target)
        ax.set_title(self.name, parse_math=False)  # a name may have dollars
        return ax

    def _told(self) -> dict[str, object]:
        blocked = f"{100 * self.obstacles.mean():.3g} % of them obstacles"
        return {
            "name": self.name,
            "fields": f"{self.cols} x {self.rows}, {blocked}",
            "start, target": f"{self.start}, {self.target}",
            "field": f"{self.resolution:g} m",
            "source": self.source,
        }

    @cached_property
    def _metric(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Scale and offset of metres: half a field in from the left, y up from the bottom."""
        offset = np.array([0.5, self.rows - 0.5]) * self.resolution
        corner = np.array(self.origin[:2] if self.origin[2] == 0.0 else (0.0, 0.0))
        return np.array([self.resolution, -self.resolution]), offset + corner
