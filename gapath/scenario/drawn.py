"""Pairs of start and target drawn on a map, for maps that come without a scenario."""

import math

import numpy as np

from gapath.errors import require
from gapath.grid import GridMap
from gapath.kernels.rng import fill, high, stream
from gapath.scenario.listed import Queries

SEED = 20
"""Key of the streams that draw: pairs belong to a map, so no run's seed changes them."""


def draw_queries(grid: GridMap, count: int, rule: int) -> Queries:
    """Draw pairs of different fields that a path joins, all such starts with equal chances.

    The first pair is the map's own, if it has one. Each depends on the map and its number alone,
    not on how many are drawn.

    Parameters
    ----------
    grid : GridMap
        The map.
    count : int
        How many pairs, at least 1.
    rule : int
        Corner-cutting rule (`gapath.kernels.units`).

    Returns
    -------
    Queries
        Without published lengths and buckets.

    Raises
    ------
    InputError
        If no path joins any two fields.
    """
    parts = grid.parts(rule).ravel()
    fields = np.flatnonzero(parts)
    fields = fields[np.argsort(parts[fields], kind="stable")]  # those of a part side by side
    sizes = np.bincount(parts[fields])
    fields = fields[sizes[parts[fields]] > 1]
    require(len(fields) > 0, f"map {grid.name}", "no two fields that a path joins", "a free way")
    begins = np.searchsorted(parts[fields], np.arange(len(sizes)))
    ends = np.empty((count, 2), dtype=np.int64)
    words = np.empty(2, dtype=np.uint64)
    for number in range(count):
        fill(stream(SEED, number), words)
        first = high(words[0], len(fields))
        part = parts[fields[first]]
        other = int(begins[part]) + high(words[1], int(sizes[part]) - 1)
        ends[number] = fields[first], fields[other + (other >= first)]  # not the same field
    places = np.stack([ends % grid.cols, ends // grid.cols], axis=2).astype(np.int32)
    if grid.start is not None and grid.target is not None:
        places[0] = grid.start, grid.target
    return Queries(
        np.arange(count, dtype=np.int32),
        np.full(count, -1, dtype=np.int32),
        places[:, 0],
        places[:, 1],
        np.full(count, math.nan),
    )
