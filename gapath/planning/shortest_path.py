"""Shortest paths on the grid: the exact planners, and the optimum that all are held against."""

import numpy as np

from gapath.kernels.graph_search import path_to, search
from gapath.kernels.units import SCALE
from gapath.problem import Plan, PlanStatus, Query


def shortest_path(problem: Query, informed: bool = True, by_length: bool = False) -> Plan:
    """Find a path of least cost on the 8-connected grid.

    Parameters
    ----------
    problem : Query
        Start and target on a known map.
    informed : bool
        True for A*, False for Dijkstra: the same cost, fewer or more expansions.
    by_length : bool
        Minimise the octile length (diagonal steps cost sqrt(2)) instead of KG18 eq. (5),
        by which a diagonal step costs no more than a straight one.

    Returns
    -------
    Plan
        FOUND, or INFEASIBLE where no path exists. Its cost is eq. (5) either way.
    """
    grid, table = problem.map, problem.map.table
    (x, y), (u, v) = problem.start, problem.target
    # zeros that nobody touches cost nothing: large maps get them from fresh pages
    states = np.zeros(table.size, dtype=np.int64)
    expansions = np.zeros(1, dtype=np.int64)
    rule, least = int(problem.corner_cutting), grid.least_weight(problem.start, problem.target)
    cost = search(table, x, y, u, v, rule, by_length, informed, least, states, expansions)
    if cost < 0:
        return Plan(PlanStatus.INFEASIBLE, expansions=int(expansions[0]))
    path = path_to(states, table.shape[1], u, v)
    if by_length:
        total = int(table[path[:, 1], path[:, 0]].sum(dtype=np.int64))
    else:
        total = int(cost) + int(table[y, x])
    return Plan(PlanStatus.FOUND, path, total / SCALE, expansions=int(expansions[0]))
