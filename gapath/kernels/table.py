"""What kernels read of a map: its weights as whole numbers, obstacles apart."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.units import OBSTACLE, SCALE


@kernel
def fill_table(weights: NDArray[np.float64], table: NDArray[np.int32]) -> None:
    """Turn weights into table entries.

    Parameters
    ----------
    weights : (n,) float64
        Weights in [0, 1], flattened.
    table : (n,) int32
        Overwritten with the weights in units of 1 / SCALE, rounded half up; OBSTACLE for 1.
    """
    for i in range(weights.shape[0]):
        entry = np.int32(np.floor(weights[i] * SCALE + 0.5))
        table[i] = np.int32(OBSTACLE) if weights[i] == 1.0 else entry
