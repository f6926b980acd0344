"""Which of several problems stands for all of a run."""

from collections.abc import Mapping

import numpy as np

from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.problem import CornerCutting, Problem
from gapath.scenario.listed import Queries


def first_of(
    queries: Queries, grid: GridMap, rule: CornerCutting, maps: Mapping[str, GridMap]
) -> Problem:
    """Pose the first query that can be solved, or else the first whose ends are free.

    Raises InputError if one of them lies outside the map.
    """
    ends = np.hstack([queries.starts, queries.targets])
    outside = (ends < 0) | (ends >= 2 * (grid.cols, grid.rows))
    for index in np.flatnonzero(outside.any(axis=1))[:1]:
        where = f"map {grid.name}, problem {queries.numbers[index]}"
        limits = f"fields [x, y] with 0 <= x < {grid.cols}, 0 <= y < {grid.rows}"
        raise InputError(where, f"{ends[index, :2].tolist()} to {ends[index, 2:].tolist()}", limits)
    parts = grid.parts(int(rule))
    start, target = (parts[at[:, 1], at[:, 0]] for at in (queries.starts, queries.targets))
    free = (start > 0) & (target > 0)
    joined = free & (start == target)
    first = int(np.argmax(joined if joined.any() else free))
    (x, y, u, v), length = ends[first].tolist(), float(queries.lengths[first])
    return Problem(grid, (x, y), (u, v), rule, maps, length, queries)
