"""A map as a picture: what a field costs as grey, obstacles in a colour of their own."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.patches import Patch
from numpy.typing import NDArray

from gapath.grid import GridMap
from gapath.problem import Graph, Problem

POINT, LINE, GROWN = "#D55E00", "#56B4E9", "#E69F00"
_OBSTACLE = "#4a5364"
_COST = LinearSegmentedColormap.from_list("cost", ["#ffffff", "#eceef1", "#98a1b0"]).with_extremes(
    bad=_OBSTACLE
)


def draw_map(axes: Axes, weights: NDArray[np.float64]) -> list[Patch]:
    """Draw the fields of a map, field (x, y) centred at (x, y) with y down.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    weights : (rows, cols) float64
        0 preferred, 1 an obstacle.

    Returns
    -------
    list of matplotlib.patches.Patch
        What the colours mean, for a legend.
    """
    obstacles = weights == 1
    cost = np.ma.masked_where(obstacles, weights)
    axes.imshow(cost, cmap=_COST, vmin=0, vmax=1, interpolation="nearest")
    axes.grid(visible=False)
    axes.spines[["top", "right"]].set_visible(True)
    handles = [Patch(facecolor=_OBSTACLE, label="obstacle (weight 1)")] if obstacles.any() else []
    # Start and target are always preferred; a legend for them alone would say little.
    kinds = np.unique(weights[~obstacles])
    kinds = kinds[kinds > 0] if len(kinds) <= 3 else np.array([kinds[0], kinds[-1]])
    return handles + [
        Patch(facecolor=_COST(kind), edgecolor="#98a1b0", label=f"free (weight {kind:g})")
        for kind in kinds
    ]


def mark_ends(axes: Axes, problem: Problem) -> None:
    """Mark the start with S and the target with T.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where the map is drawn.
    problem : Problem
        With start and target.
    """
    for letter, (x, y) in (("S", problem.start), ("T", problem.target)):
        axes.text(
            x, y, letter, ha="center", va="center", color="white", fontsize=9, weight="bold",
            bbox={"boxstyle": "circle,pad=0.25", "facecolor": "black", "linewidth": 0},
            clip_on=False,
        )  # fmt: skip


def draw_picture(axes: Axes, grid: GridMap, graph: Graph | None) -> None:
    """Draw obstacles white on black, and what they grew by in a colour."""
    picture = np.zeros((grid.rows, grid.cols, 3))
    if graph is not None:
        picture[graph.grown(grid.rows, grid.cols)] = to_rgb(GROWN)
    picture[grid.obstacles] = 1.0
    axes.imshow(picture, interpolation="nearest")
    axes.grid(visible=False)
    axes.set(xticks=[], yticks=[])


def draw_lines(axes: Axes, points: NDArray[np.int32], edges: NDArray[np.int32]) -> None:
    """Draw lines of a graph, and its points."""
    for i, j in edges:
        axes.plot(*points[[i, j]].T, color=LINE, linewidth=0.4)
    axes.plot(*points.T, "o", color=POINT, markersize=2.5)
