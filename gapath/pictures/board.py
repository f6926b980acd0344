"""A map as a picture: what a field costs as grey, obstacles in a colour of their own."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gapath.pictures.canvas import (
    Artist,
    Axes,
    AxesImage,
    Line2D,
    LinearSegmentedColormap,
    Patch,
    to_rgb,
    to_rgba,
)

POINT, LINE, GROWN = "#D55E00", "#56B4E9", "#E69F00"
PATH, UNKNOWN = "#0072B2", to_rgba("#56B4E9", 0.35)
_OBSTACLE = "#4a5364"
_COST = LinearSegmentedColormap.from_list("cost", ["#ffffff", "#eceef1", "#98a1b0"]).with_extremes(
    bad=_OBSTACLE
)
_MOST = 1000
"""Points of a picture along a side; of a larger map each is the dearest field of a square."""


def draw_map(axes: Axes, weights: NDArray[np.float64]) -> AxesImage:
    """Draw the fields of a map, field (x, y) centred at (x, y) with y down.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    weights : (rows, cols) float64
        0 preferred, 1 an obstacle.

    Returns
    -------
    matplotlib.image.AxesImage
        The picture.
    """
    image = axes.imshow(_cost(weights), cmap=_COST, vmin=0, vmax=1, interpolation="nearest")
    _place(axes, image, weights.shape)
    axes.spines[["top", "right"]].set_visible(True)
    return image


def draw_unknown(axes: Axes, unknown: NDArray[np.bool_]) -> AxesImage:
    """Tint the fields of a map that are unknown, (rows, cols)."""
    image = axes.imshow(_tint(unknown), interpolation="nearest")
    _place(axes, image, unknown.shape)
    return image


def _place(axes: Axes, image: AxesImage, shape: tuple[int, ...]) -> None:
    """Let a picture's points lie where the fields are that they stand for."""
    (rows, cols), side = shape, _side(shape)
    height, width = side * (-(-rows // side)), side * (-(-cols // side))
    image.set_extent((-0.5, width - 0.5, height - 0.5, -0.5))
    axes.set(xlim=(-0.5, cols - 0.5), ylim=(rows - 0.5, -0.5))
    axes.grid(visible=False)


def _side(shape: tuple[int, ...]) -> int:
    return -(-max(shape) // _MOST)


def _thinned(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give the greatest value of each square, as many as a picture has points."""
    side = _side(values.shape)
    if side == 1:
        return values
    rows, cols = np.arange(0, values.shape[0], side), np.arange(0, values.shape[1], side)
    across = np.maximum.reduceat(values, cols, axis=1)
    return np.asarray(np.maximum.reduceat(across, rows, axis=0))


def _cost(weights: NDArray[np.float64]) -> np.ma.MaskedArray:
    return np.ma.masked_equal(_thinned(weights), 1.0)


def _tint(unknown: NDArray[np.bool_]) -> NDArray[np.float64]:
    return np.asarray(_thinned(unknown.astype(np.float64))[..., None] * np.array(UNKNOWN))


def map_legend(weights: NDArray[np.float64]) -> list[Patch]:
    """Say what the colours of a map mean.

    Parameters
    ----------
    weights : (rows, cols) float64
        As of `draw_map`.

    Returns
    -------
    list of matplotlib.patches.Patch
        Obstacles if there are any, and each weight; of more than three the least and the greatest.
    """
    obstacles = weights == 1
    handles = [Patch(facecolor=_OBSTACLE, label="obstacle (weight 1)")] if obstacles.any() else []
    # Start and target are always preferred; a legend for them alone would say little.
    kinds = np.unique(weights[~obstacles])
    kinds = kinds[kinds > 0] if len(kinds) <= 3 else np.array([kinds[0], kinds[-1]])
    return handles + [
        Patch(facecolor=_COST(kind), edgecolor="#98a1b0", label=f"free (weight {kind:g})")
        for kind in kinds
    ]


def mark_ends(axes: Axes, start: tuple[int, int] | None, target: tuple[int, int] | None) -> None:
    """Mark the start with S and the target with T, where there are any.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where the map is drawn.
    start, target : (x, y), optional
        Fields.
    """
    for letter, place in (("S", start), ("T", target)):
        if place is None:
            continue
        axes.text(
            *place, letter, ha="center", va="center", color="white", fontsize=9, weight="bold",
            bbox={"boxstyle": "circle,pad=0.25", "facecolor": "black", "linewidth": 0},
            clip_on=False,
        )  # fmt: skip


def draw_path(axes: Axes, path: NDArray[np.int32], way_points: NDArray[np.int32]) -> Line2D:
    """Draw a path.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where the map is drawn.
    path : (n, 2) int32
        Fields as (x, y).
    way_points : (w, 2) int32
        Points on it that are marked.

    Returns
    -------
    matplotlib.lines.Line2D
        The path's line.
    """
    (line,) = axes.plot(*path.T, color=PATH, linewidth=1.8, label="path")
    if len(way_points):
        axes.plot(*way_points.T, "o", color=POINT, markersize=5, label="way points")
    return line


def legend_below(axes: Axes, handles: Sequence[Artist]) -> None:
    """Say below a picture what its colours mean, in two columns.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where it is drawn.
    handles : sequence of matplotlib.artist.Artist
        What is there, with a label each.
    """
    axes.legend(
        handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2, fontsize=8,
        frameon=False,
    )  # fmt: skip


def drive_legend(axes: Axes, lines: Sequence[Line2D] = ()) -> None:
    """Say below a drive's picture what its colours mean.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where it is drawn.
    lines : sequence of matplotlib.lines.Line2D
        Lines with a label, beside the way of the robot.
    """
    way = Line2D([], [], color=PATH, linewidth=1.8, marker="o", label="the robot and its way")
    unseen = Patch(facecolor=UNKNOWN, label="tinted: not seen by it")
    legend_below(axes, [way, *lines, Patch(facecolor=_OBSTACLE, label="obstacle"), unseen])


class Robot:
    """A robot on a map of which it knows a part, as an animation shows it.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where the true map is drawn.
    shape : (rows, cols)
        Of the map.
    """

    def __init__(self, axes: Axes, shape: tuple[int, int]) -> None:
        (self._map,) = axes.images
        self._unknown = draw_unknown(axes, np.zeros(shape, dtype=np.bool_))
        follows, sensor = "path that it follows", "what its sensor covers"
        (self._path,) = axes.plot([], [], color=POINT, linestyle=":", linewidth=1.5, label=follows)
        (self._way,) = axes.plot([], [], color=PATH, linewidth=1.8)
        (self._place,) = axes.plot([], [], "o", color=PATH, markersize=7)
        (self._sensor,) = axes.plot([], [], color=GROWN, linewidth=1.2, label=sensor)
        drive_legend(axes, [self._path, self._sensor])

    def show(
        self,
        weights: NDArray[np.float64],
        known: NDArray[np.float64],
        places: NDArray[np.int32],
        path: NDArray[np.int32],
        seen: NDArray[np.float32],
    ) -> None:
        """Show a moment.

        Parameters
        ----------
        weights : (rows, cols) float64
            The true map, seen where the robot knows nothing.
        known : (rows, cols) float64
            What it knows; NaN where it knows nothing.
        places : (n, 2) int32
            Where it was, as (x, y), the last one where it is.
        path : (m, 2) int32
            The path that it follows, as far as it knows it to be free.
        seen : (k, 2) float32
            The border of what its sensor covers.
        """
        unknown = np.isnan(known)
        self._map.set_data(_cost(np.where(unknown, weights, known)))
        self._unknown.set_data(_tint(unknown))
        self._path.set_data(*path.T)
        self._way.set_data(*places.T)
        self._place.set_data(*places[-1:].T)
        self._sensor.set_data(*seen.T)


def draw_picture(axes: Axes, obstacles: NDArray[np.bool_], grown: NDArray[np.bool_] | None) -> None:
    """Draw obstacles white on black, and what they grew by in a colour; all (rows, cols)."""
    picture = np.zeros((*obstacles.shape, 3))
    if grown is not None:
        picture[grown] = to_rgb(GROWN)
    picture[obstacles] = 1.0
    axes.imshow(picture, interpolation="nearest")
    axes.grid(visible=False)
    axes.set(xticks=[], yticks=[])


def draw_lines(axes: Axes, points: NDArray[np.int32], edges: NDArray[np.int32]) -> None:
    """Draw lines of a graph, and its points."""
    for i, j in edges:
        axes.plot(*points[[i, j]].T, color=LINE, linewidth=0.4)
    axes.plot(*points.T, "o", color=POINT, markersize=2.5)
