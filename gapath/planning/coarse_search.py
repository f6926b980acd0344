"""Search from coarse to fine: a good path where weights change from field to field."""

import numpy as np

from gapath.kernels.coarse import FACTOR, fence, pool
from gapath.kernels.graph_search import path_to, search
from gapath.kernels.units import ALLOW, OBSTACLE, SCALE
from gapath.problem import Plan, PlanStatus, Query, no_path

LARGE = 1 << 16
"""Fields of a map from which on it is worth its time."""


def coarse_path(problem: Query) -> Plan:
    """Search on a coarse map, then on finer ones near the path of the coarser one.

    Parameters
    ----------
    problem : Query
        Start and target on a known map.

    Returns
    -------
    Plan
        FOUND, a path of least cost on a map that is not `LARGE`; NOT_FOUND if there is none near
        the coarse one.
    """
    tables = [problem.map.table]
    while tables[-1].size > LARGE:
        rows, cols = tables[-1].shape
        coarse = np.empty((-(-rows // FACTOR), -(-cols // FACTOR)), dtype=np.int32)
        pool(tables[-1], coarse)
        tables.append(coarse)
    path, cost, total = no_path(), 0, 0
    expansions = np.zeros(1, dtype=np.int64)
    for level in reversed(range(len(tables))):
        table = tables[level]
        rows, cols = table.shape
        x, y, u, v = (c // FACTOR**level for c in (*problem.start, *problem.target))
        states = np.zeros(table.size, dtype=np.int64)
        if len(path):
            fence(path, rows, cols, states)
        if level == 0:
            rule = int(problem.corner_cutting)
            least = problem.map.least_weight(problem.start, problem.target)
        else:
            rule, least = ALLOW, int(table.min())
            for a, b in ((x, y), (u, v)):
                table[b, a] = min(table[b, a], OBSTACLE - 1)
        cost = int(search(table, x, y, u, v, rule, 0, True, least, states, expansions))
        total += int(expansions[0])
        if cost < 0:
            return Plan(PlanStatus.NOT_FOUND, expansions=total)
        path = path_to(states, cols, u, v)
    x, y = problem.start
    weights = (cost + int(problem.map.table[y, x])) / SCALE
    return Plan(PlanStatus.FOUND, path, weights, expansions=total)
