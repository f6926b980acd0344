"""Automatic resizing of a picture (M22 Sec. IV, further work).

A picture is made smaller by a whole number: a pixel of the small one is an obstacle if any of
its pixels was, so no obstacle vanishes. What may be lost are gaps. The scale is the coarsest one
at which none is that the robot fits through, up to that at which its radius is one pixel: grown
obstacles neither merge with one another or with the border, nor cut the free floor in two, where
they did not before. Obstacles grow by less than two small pixels more than they had to, and a
free line between two points may be blocked by that: paths may be longer, and planners that know
a few keypoints only may find none.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.grid import Field
from gapath.survey.keypoints import label
from gapath.survey.obstacle_image import Picture, dilate


def shrunk(obstacles: Picture, scale: int) -> Picture:
    """Make a picture smaller.

    Parameters
    ----------
    obstacles : (rows, cols) bool
        The picture.
    scale : int
        Pixels a side that become one.

    Returns
    -------
    (ceil(rows / scale), ceil(cols / scale)) bool
        True where any pixel was.
    """
    rows, cols = obstacles.shape
    fitting = np.pad(obstacles, ((0, -rows % scale), (0, -cols % scale)))
    blocks = fitting.reshape(-(-rows // scale), scale, -(-cols // scale), scale)
    return np.asarray(blocks.any(axis=(1, 3)))


def growth_at(scale: int, growth: int) -> int:
    """Give by how many small pixels obstacles grow, so that no less than before is kept clear."""
    return -(-growth // scale)


def coarsest_scale(
    obstacles: Picture, grown: Picture, growth: int, ends: tuple[Field, Field]
) -> int:
    """Find the coarsest scale at which no obstacle vanishes and no gap closes.

    Parameters
    ----------
    obstacles : (rows, cols) bool
        The picture, not grown.
    grown : (rows, cols) bool
        The picture, grown.
    growth : int
        Pixels by which obstacles grow: the robot's radius; also the coarsest scale tried.
    ends : two of (x, y)
        Start and end, which must stay free.

    Returns
    -------
    int
        Pixels a side that can become one; 1 if none can.
    """
    count = _framed_count(grown)
    floor = label_free(grown)
    for scale in range(growth, 1, -1):
        coarse = dilate(shrunk(obstacles, scale), growth_at(scale, growth))
        if any(coarse[y // scale, x // scale] for x, y in ends):
            continue
        if _framed_count(coarse) == count and _keeps_floors(floor, coarse, scale):
            return scale
    return 1


def _framed_count(obstacles: Picture) -> int:
    """Count obstacles, the world outside the picture being one of them."""
    return label(np.pad(obstacles, 1, constant_values=True))[1]


def label_free(obstacles: Picture) -> NDArray[np.int32]:
    """Give each part of the free floor a number: pixels that share a side belong together."""
    from skimage import measure

    parts: NDArray[np.int32] = measure.label(~obstacles, connectivity=1)
    return parts


def _keeps_floors(floor: NDArray[np.int32], coarse: Picture, scale: int) -> bool:
    """Tell whether no part of the free floor was cut in two."""
    parts, first = np.unique(label_free(coarse), return_index=True)
    y, x = np.unravel_index(first[parts > 0], coarse.shape)
    found = floor[y * scale, x * scale]
    return len(np.unique(found)) == len(found)
