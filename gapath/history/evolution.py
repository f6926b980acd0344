"""What a genetic algorithm did, epoch by epoch."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Population(NamedTuple):
    """What a memetic algorithm's population took in, in order (m changes, at least one).

    A change makes an individual, a polygon whose vertices straight lines join
    (`gapath.kernels.raster.polyline`), into another one: from then on it is the individual.
    """

    epochs: NDArray[np.int32]
    """(m,) epoch of each, from 1, not falling; those of epoch 1 are the first population."""
    individuals: NDArray[np.int32]
    """(m,) number of the individual that it became."""
    operators: NDArray[np.int32]
    """(m,) what made it, a number of `names`."""
    gains: NDArray[np.float64]
    """(m,) by how much it made the individual cheaper than it was; 0 in the first population."""
    costs: NDArray[np.float64]
    """(m,) what the individual costs now, KG18 eq. (5)."""
    ends: NDArray[np.int32]
    """(m,) where each one's vertices end in `vertices`."""
    vertices: NDArray[np.int32]
    """(sum, 2) vertices as (x, y), one polygon after another, start and target included."""
    names: tuple[str, ...]
    """What makes and changes individuals: the first one is what found the first path ("wall
    following", "search"), then "crossover", "shortcut", ..."""
    shares: tuple[float, ...]
    """By how much each of `names` lowered the cost of the best individual so far; the first one's
    is what the first path cost, so that ``shares[0] - sum(shares[1:])`` is the final cost."""

    def polygon(self, change: int) -> NDArray[np.int32]:
        """Give the vertices (n, 2) that a change left."""
        begin = self.ends[change - 1] if change else 0
        return self.vertices[begin : self.ends[change]]

    def standing(self, epochs: int) -> NDArray[np.int32]:
        """Say as which change left it each individual (P) is at the end of each epoch.

        Parameters
        ----------
        epochs : int
            How many.

        Returns
        -------
        (epochs, P) int32
            Numbers of changes, individuals in order of their numbers; -1 where there is none yet.
        """
        whose = np.unique(self.individuals)
        found = np.empty((epochs, len(whose)), dtype=np.int32)
        for k, individual in enumerate(whose):
            own = np.flatnonzero(self.individuals == individual)
            until = np.searchsorted(self.epochs[own], np.arange(1, epochs + 1), side="right")
            found[:, k] = np.concatenate([[-1], own])[until]
        return found

    def crowds(self, epochs: int) -> list[list[NDArray[np.int32]]]:
        """Give the polygons of all individuals at the end of each of so many epochs."""
        return [[self.polygon(i) for i in row if i >= 0] for row in self.standing(epochs).tolist()]


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
    graph's points; "polygon": x1, y1, ... of its vertices, the last one repeated."""
    population: Population | None = None
    """What the population took in, where the algorithm tells it: then the best individual of each
    epoch is as one of these changes left it."""
