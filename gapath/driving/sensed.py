"""What a robot's sensor covers, as a line around it."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.field_of_view import HEADING_X, HEADING_Y


def sensed(layers: int, heading: int) -> NDArray[np.float32]:
    """Give the border of what is seen in a direction.

    Parameters
    ----------
    layers : int
        Range of the sensor in fields.
    heading : int
        Where it looks: 0 (+x) to 7, clockwise with y down.

    Returns
    -------
    (n, 2) float32
        A closed line around the centre of the robot's field, as (x, y).
    """
    x, y = int(HEADING_X[heading]), int(HEADING_Y[heading])
    far = layers + 0.5
    if x and y:  # a square, which the robot's field is the corner of
        corners = [(-0.5, -0.5), (far, -0.5), (far, far), (-0.5, far), (-0.5, -0.5)]
        return np.array([(x * u, y * v) for u, v in corners], dtype=np.float32)
    sides = [(u, v + 0.5) for v in range(layers + 1) for u in (v - 0.5, v + 0.5)]
    corners = [*sides, *((u, -v) for u, v in reversed(sides)), sides[0]]
    return np.array([(x * u - y * v, y * u + x * v) for u, v in corners], dtype=np.float32)
