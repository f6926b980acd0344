"""What a genetic algorithm did, epoch by epoch."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Evolution(NamedTuple):
    """What a genetic algorithm did, epoch by epoch (E epochs).

    A best path is given by its way points, which straight lines join
    (`gapath.kernels.raster.polyline`); rows are padded with the last way point.
    """

    best: NDArray[np.float64]
    """(E,) fitness of the best individual: its cost, KG18 eq. (5), obstacles counted as VLN; for
    the genotype "keypoints" the length of its lines in fields, M22 eq. (7)."""
    mean: NDArray[np.float64]
    """(E,) mean fitness of the population."""
    chromosomes: NDArray[np.int32]
    """(E, genes) the best individual."""
    way_points: NDArray[np.int32]
    """(E, n, 2) the best individual's way points as (x, y)."""
    genotype: str
    """What the genes mean, e.g. "control_points": x1, y1, ..., xk, yk; "keypoints": numbers of a
    graph's points."""
