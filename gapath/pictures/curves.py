"""The course of a genetic algorithm as a picture."""

import numpy as np
from numpy.typing import NDArray

from gapath.pictures.canvas import Axes


def draw_convergence(axes: Axes, best: NDArray[np.float64], mean: NDArray[np.float64]) -> None:
    """Draw fitness by epoch, the least of which is the best.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    best, mean : (E,) float64
        Fitness of the best individual, and the mean of the population, epoch by epoch.
    """
    epochs = np.arange(1, len(best) + 1)
    point = "o" if len(epochs) == 1 else ""
    axes.plot(epochs, best, color="#0072B2", marker=point, zorder=3, label="best")
    axes.plot(epochs, mean, "--", color="#D55E00", marker=point, linewidth=1, label="mean")
    least = min(best.min(), mean.min())
    if 0 < 10 * least < max(best.max(), mean.max()):  # free paths cost about the same
        axes.set_yscale("log")
    axes.set(xlabel="epoch", ylabel="fitness (less is better)")
    axes.legend(frameon=False)
