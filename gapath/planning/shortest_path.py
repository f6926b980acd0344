"""Shortest paths on the grid: the exact planners, and the optimum that all are held against.

A path is as long as it has fields. Of paths that cost the same the shortest is given: where
fields cost nothing, all do.
"""

import numpy as np

from gapath.kernels.graph_search import BY_LENGTH, FIELD_BITS, NO_PATH, TOO_LONG, path_to, search
from gapath.kernels.table import weights_of
from gapath.kernels.units import SCALE
from gapath.problem import Plan, PlanStatus, Query


def shortest_path(problem: Query, informed: bool = True, by_length: bool = False) -> Plan:
    """Find a path of least cost on the 8-connected grid, and of several one of the fewest fields.

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
        OPTIMAL, by length FOUND, or INFEASIBLE where no path exists. Its cost is eq. (5) either
        way. (If the search comes to a path of more than two million fields, it is one of least
        cost, whose fields are not counted.)
    """
    grid, table = problem.map, problem.map.table
    (x, y), (u, v) = problem.start, problem.target
    expansions = np.zeros(1, dtype=np.int64)
    rule, least = int(problem.corner_cutting), grid.least_weight(problem.start, problem.target)
    for field_bits in (BY_LENGTH,) if by_length else (FIELD_BITS, 0):
        # zeros that nobody touches cost nothing: large maps get them from fresh pages
        states = np.zeros(table.size, dtype=np.int64)
        cost = search(table, x, y, u, v, rule, field_bits, informed, least, states, expansions)
        if cost != TOO_LONG:
            break
    if cost == NO_PATH:
        return Plan(PlanStatus.INFEASIBLE, expansions=int(expansions[0]))
    path = path_to(states, table.shape[1], u, v)
    total = weights_of(table, path) if by_length else int(cost) + int(table[y, x])
    status = PlanStatus.FOUND if by_length else PlanStatus.OPTIMAL
    return Plan(status, path, total / SCALE, expansions=int(expansions[0]))
