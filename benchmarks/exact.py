"""The exact planners against those of scikit-image and SciPy, on the same graph.

Times in microseconds. "set-up" is done once a map, "solve" once a query, its path included.
All costs are equal, or this stops. SciPy has no early end: it solves for every target at once.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra
from skimage.graph import MCP

from benchmarks.measure import MAPS, Calls, Row, interleave, make_problem, quartiles, ratios
from gapath.graph import shortest_path
from gapath.grid import GridMap
from gapath.problem import Problem

Solve: TypeAlias = Callable[[], tuple[float, Any]]
"""Gives cost and path; the path has the peer's own form."""


def gapath_astar(problem: Problem) -> Solve:
    return partial(_gapath, _anew(problem), True)


def gapath_dijkstra(problem: Problem) -> Solve:
    return partial(_gapath, _anew(problem), False)


def _anew(problem: Problem) -> Problem:
    """Make the problem again, what kernels read included: maps keep it once it is built."""
    grid = GridMap(problem.map.name, problem.map.weights)
    grid.least_weight(problem.start, problem.target)
    return Problem(grid, problem.start, problem.target)


def _gapath(problem: Problem, informed: bool) -> tuple[float, Any]:
    plan = shortest_path(problem, informed)
    return plan.cost, plan.path


def skimage_mcp(problem: Problem) -> Solve:
    weights = problem.map.weights.copy()
    weights[problem.map.obstacles] = -1  # MCP: not to be passed
    mcp = MCP(weights, fully_connected=True)
    start, target = problem.start[::-1], problem.target[::-1]

    def solve() -> tuple[float, Any]:
        costs, _ = mcp.find_costs([start], [target])
        return float(costs[target]), mcp.traceback(target)

    return solve


def scipy_csgraph(problem: Problem) -> Solve:
    grid = problem.map
    numbers = np.arange(grid.rows * grid.cols).reshape(grid.rows, grid.cols)
    free, heads, tails = ~grid.obstacles, [], []
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            if (dx, dy) == (0, 0):
                continue
            here = np.s_[max(-dy, 0) : grid.rows - max(dy, 0), max(-dx, 0) : grid.cols - max(dx, 0)]
            there = np.s_[max(dy, 0) : grid.rows + min(dy, 0), max(dx, 0) : grid.cols + min(dx, 0)]
            passable = free[here] & free[there]
            tails.append(numbers[here][passable])
            heads.append(numbers[there][passable])
    tail, head = np.concatenate(tails), np.concatenate(heads)
    graph = coo_array((grid.weights.ravel()[head], (tail, head)), shape=(numbers.size,) * 2).tocsr()
    start, target = (place[1] * grid.cols + place[0] for place in (problem.start, problem.target))
    own = float(grid.weights.ravel()[start])

    def solve() -> tuple[float, Any]:
        costs, before = dijkstra(graph, indices=start, return_predecessors=True)
        path = [target]
        while path[-1] != start:
            path.append(before[path[-1]])
        return own + float(costs[target]), path

    return solve


PEERS: dict[str, Callable[[Problem], Solve]] = {
    "gapath A*": gapath_astar,
    "gapath Dijkstra": gapath_dijkstra,
    "skimage MCP": skimage_mcp,
    "scipy csgraph": scipy_csgraph,
}
"""Each prepares a map and gives the function that solves; other peers enter here."""


def measure(quick: bool) -> list[Row]:
    rows = []
    for problem in map(make_problem, MAPS):
        rounds = 1 + (3 if quick else 100)
        prepare: Calls = {name: partial(peer, problem) for name, peer in PEERS.items()}
        set_up, solvers = interleave([prepare] * rounds)
        solve, results = interleave(solvers)
        cost = shortest_path(problem).cost
        for name in PEERS:
            if results[-1][name][0] != cost:
                raise RuntimeError(
                    f"{problem.map.name}: {name} finds {results[-1][name][0]}, not {cost}"
                )
            rows.append(
                {
                    "map": problem.map.name,
                    "peer": name,
                    "cost": cost,
                    "set-up us": quartiles(set_up[name]),
                    "solve us": quartiles(solve[name]),
                    "solve / gapath A*": ratios(solve[name], solve["gapath A*"]),
                }
            )
    return rows
