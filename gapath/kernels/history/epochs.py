"""What a genetic algorithm's kernel keeps of each epoch, and the paper's numbers made of it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import KEY_BITS, ONE_OBSTACLE

EPOCHS = np.dtype([("key", np.int64), ("obstacle_sum", np.int64), ("cost_sum", np.int64)])
"""What happened in an epoch: the best individual's key, obstacle fields and cost (in units of
1 / SCALE) of the whole population."""


class History(NamedTuple):
    """What a kernel keeps of a run of E epochs; epoch 1 is the initial population."""

    epochs: NDArray[np.void]
    """(E,) what happened in each: the kernel's `EPOCHS`."""
    chromosomes: NDArray[np.int32]
    """(E, genes) the best individual of each, as the kernel writes it."""


@kernel
def fitness_history(
    history: NDArray[np.void], population: int, vln: float, scale: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Give the paper's numbers: eq. (5) of the best individual, and its mean.

    Parameters
    ----------
    history : (E,) EPOCHS
        History of E epochs.
    population : int
        Individuals.
    vln : float
        What an obstacle field counts.
    scale : int
        Units of cost in a cost of 1.

    Returns
    -------
    best, mean : (E,) float64
        Epoch by epoch.
    """
    best = np.empty(history.shape[0])
    mean = np.empty(history.shape[0])
    for i in range(best.shape[0]):
        epoch = history[i]
        best[i] = (epoch["key"] >> KEY_BITS) * vln + (epoch["key"] & (ONE_OBSTACLE - 1)) / scale
        mean[i] = (epoch["obstacle_sum"] * vln + epoch["cost_sum"] / scale) / population
    return best, mean
