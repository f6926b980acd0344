"""Which settings of which methods form a grid: every value of one with every value of another."""

from itertools import combinations
from typing import TypeAlias

import numpy as np
import pandas as pd
from numpy.typing import NDArray

MANY = 2 / 3
"""More of the combinations than this make a grid; fewer may be settings varied one at a time."""

_LINE = 3
"""So many methods, at least, are a grid among others of the same YAML."""
_SCATTERED = 8
"""So many, at least, are a sweep without being a grid."""
_AT_ONCE = 3
"""Grids among others are sought over so many settings, at most."""

Codes: TypeAlias = NDArray[np.int64]
Grid: TypeAlias = tuple[tuple[int, ...], list[int]]
"""Columns and rows."""


def find_grids(codes: Codes) -> list[Grid]:
    """Find the grids that methods form.

    Parameters
    ----------
    codes : (n, k) int64
        Numbers of the values of k settings in n methods, all of which differ.

    Returns
    -------
    list of (tuple of int, list of int)
        Columns and rows of each: one that has most of all combinations; or those of fewer settings,
        the others the same, the largest first, which may share rows; or, where many methods form
        neither, all of them. Rows that are in none are left out.
    """
    n, k = codes.shape
    everything: list[Grid] = [(tuple(range(k)), list(range(n)))]
    if n < 2:
        return []
    if _filled(codes):
        return everything
    found: list[Grid] = []
    free = np.ones(n, dtype=bool)
    while (grid := _largest(codes, free)) is not None:
        found.append(grid)
        free[grid[1]] = False
    scattered = free.sum() > n / 2 and not _one_at_a_time(codes)
    irregular = n >= _SCATTERED and (scattered or len(found) > k)
    return everything if irregular else found


def changed_together(settings: pd.DataFrame) -> dict[str, str]:
    """Find settings each of whose values came with one value of another.

    Parameters
    ----------
    settings : DataFrame
        One row a method, a column a setting, each of several values.

    Returns
    -------
    dict of str to str
        A setting, and the one with which it changed, which is not among the keys.
    """
    codes = {name: pd.factorize(settings[name].map(repr))[0] for name in settings}
    together: dict[str, str] = {}
    for name, other in combinations(sorted(settings), 2):
        free = name not in together and other not in together
        if free and _changed(settings, codes[name], codes[other], (name, other)):
            together[other] = name
    return together


def _changed(settings: pd.DataFrame, one: Codes, two: Codes, names: tuple[str, str]) -> bool:
    levels = one.max() + 1
    pairs = len(np.unique(one * len(two) + two))
    if not levels == two.max() + 1 == pairs:
        return False
    # Values drawn at random are each there once, too, but not in the same order.
    return bool(levels < len(settings) or levels < _LINE or _in_order(settings[list(names)]))


def _in_order(pair: pd.DataFrame) -> bool:
    try:
        values = pair.astype(float).sort_values(pair.columns[0])
    except (TypeError, ValueError):
        return len(pair) < _SCATTERED
    last = values.iloc[:, 1]
    return bool(last.is_monotonic_increasing or last.is_monotonic_decreasing)


def _filled(codes: Codes) -> bool:
    levels = [len(np.unique(column)) for column in codes.T]
    return all(count > 1 for count in levels) and len(codes) > MANY * float(np.prod(levels))


def _largest(codes: Codes, free: NDArray[np.bool_]) -> Grid | None:
    """Give the grid over some of the settings that has most rows that are in none."""
    k = codes.shape[1]
    best: Grid | None = None
    most = 1
    for size in range(1, min(k - 1, _AT_ONCE) + 1):
        for columns in combinations(range(k), size):
            others = [i for i in range(k) if i not in columns]
            _, group = np.unique(codes[:, others], axis=0, return_inverse=True)
            group = group.reshape(-1)
            gain = np.bincount(group, weights=free)
            for place in np.flatnonzero((gain > most) & (np.bincount(group) >= _LINE)):
                rows = np.flatnonzero(group == place)
                if gain[place] > most and _filled(codes[rows][:, list(columns)]):
                    best, most = (columns, rows.tolist()), int(gain[place])
    return best


def _one_at_a_time(codes: Codes) -> bool:
    """Tell whether all differ from one method in one setting at most."""
    usual = [np.bincount(column).argmax() for column in codes.T]
    return bool(((codes != usual).sum(axis=1) <= 1).all())
