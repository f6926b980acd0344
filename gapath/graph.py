"""Shortest paths on the grid: the exact planners, and the optimum that all are held against."""

import numpy as np

from gapath.grid import SCALE
from gapath.kernels.graph_search import path_to, search
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
    grid = problem.map
    costs = np.zeros(grid.rows * grid.cols, dtype=np.int64)
    arrivals = np.empty(costs.size, dtype=np.int8)
    expansions = np.zeros(1, dtype=np.int64)
    cost = search(
        grid.table,
        problem.start,
        problem.target,
        int(problem.corner_cutting),
        by_length,
        informed,
        grid.least_weight(problem.start, problem.target),
        costs,
        arrivals,
        expansions,
    )
    if cost < 0:
        return Plan(PlanStatus.INFEASIBLE, expansions=int(expansions[0]))
    path = path_to(arrivals, grid.cols, problem.start, problem.target)
    if by_length:
        total = int(grid.table[path[:, 1], path[:, 0]].sum(dtype=np.int64))
    else:
        total = int(cost) + int(grid.table[problem.start[1], problem.start[0]])
    return Plan(PlanStatus.FOUND, path, total / SCALE, expansions=int(expansions[0]))
