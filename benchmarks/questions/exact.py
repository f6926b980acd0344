"""The exact planners against those of six libraries, on the same fields.

Times in microseconds. "set-up" is done once a map, "solve" once a query, its path included; the
first query of each set-up is not timed. All costs are equal, or this stops: those that a library
gives, or else those of its paths, summed up outside the clock. SciPy has no early end: it solves
for every target at once. Libraries that run Python code take fewer rounds, each of them beside
gapath's A*, too.

KG18's cost is the sum of a path's weights, by which a diagonal step costs no more than a straight
one. pyastar2d takes no weight below 1 and pathfinding none of 0; on these maps only start and
target have one, which every path pays once. So all but gapath, scikit-image and SciPy search with
these two as light as the lightest other field, and pyastar2d in units of that weight; on a map
with other weights of 0 both would be skipped. pathfinding multiplies diagonal steps by sqrt(2):
its grid gets another cost of a step.
"""

from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from operator import attrgetter, itemgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra
from skimage.graph import MCP

from benchmarks.measure import MAPS, Calls, Row, interleave, make_problem, quartiles, ratios, timed
from gapath.grid import GridMap
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem


class Prepared(NamedTuple):
    """A peer on a map."""

    solve: Callable[[], Any]
    """Gives what the peer gives, the path among it."""
    cost: Callable[[Any], float]
    """Tells what that costs by KG18 eq. (5); not timed."""


class Peer(NamedTuple):
    """Somebody's exact planner."""

    prepare: Callable[[Problem], Prepared]
    extra: str = ""
    """The package of the bench extra that it needs."""
    rounds: int = 100
    zeros: bool = True
    """Whether it takes fields of weight 0 besides start and target."""


def gapath_planner(informed: bool, problem: Problem) -> Prepared:
    grid = GridMap(problem.map.name, problem.map.weights)  # anew: a map keeps what it has built
    grid.least_weight(problem.start, problem.target)
    again = Problem(grid, problem.start, problem.target)
    return Prepared(partial(shortest_path, again, informed), attrgetter("cost"))


def skimage_mcp(problem: Problem) -> Prepared:
    weights = problem.map.weights.copy()
    weights[problem.map.obstacles] = -1  # MCP: not to be passed
    mcp = MCP(weights, fully_connected=True)
    start, target = problem.start[::-1], problem.target[::-1]

    def solve() -> tuple[float, Any]:
        costs, _ = mcp.find_costs([start], [target])
        return float(costs[target]), mcp.traceback(target)

    return Prepared(solve, itemgetter(0))


def numbers_of_ends(problem: Problem) -> tuple[int, int]:
    """Give start and target as the flattened map numbers its fields."""
    cols = problem.map.cols
    (x0, y0), (x1, y1) = problem.start, problem.target
    return y0 * cols + x0, y1 * cols + x1


def edges(grid: GridMap) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """List the steps between free neighbours: tails and heads, fields of the flattened map."""
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
    return np.concatenate(tails), np.concatenate(heads)


def scipy_csgraph(problem: Problem) -> Prepared:
    weights = problem.map.weights.ravel()
    tail, head = edges(problem.map)
    graph = coo_array((weights[head], (tail, head)), shape=(weights.size,) * 2).tocsr()
    start, target = numbers_of_ends(problem)
    own = float(weights[start])

    def solve() -> tuple[float, Any]:
        costs, before = dijkstra(graph, indices=start, return_predecessors=True)
        path = [target]
        while path[-1] != start:
            path.append(before[path[-1]])
        return own + float(costs[target]), path

    return Prepared(solve, itemgetter(0))


def with_ordinary_ends(problem: Problem) -> tuple[NDArray[np.float64], float]:
    """Give the weights with start and target as light as the lightest other field, and its weight.

    Every path pays its ends once, so the best one stays the best.
    """
    weights = problem.map.weights.copy().ravel()
    ends = list(numbers_of_ends(problem))
    weights[ends] = 1
    least = float(weights.min())
    weights[ends] = least
    return weights.reshape(problem.map.weights.shape), least


def towards(target: tuple[int, int], least: float) -> Callable[[tuple[int, int]], float]:
    """Give the heuristic of A*: the fewest steps, each on the lightest field."""
    x, y = target
    return lambda place: least * max(abs(place[0] - x), abs(place[1] - y))


def cost_of_numbers(problem: Problem) -> Callable[[Any], float]:
    """Sum up the fields that a path passes, numbered as `numbers_of_ends` does."""
    return lambda path: float(problem.map.weights.flat[list(path)].sum())


def pyastar2d_astar(problem: Problem) -> Prepared:
    from pyastar2d import astar_path

    weights, least = with_ordinary_ends(problem)
    weights /= least
    weights[problem.map.obstacles] = np.inf
    single = weights.astype(np.float32)
    start, target = problem.start[::-1], problem.target[::-1]
    return Prepared(
        partial(astar_path, single, start, target, allow_diagonal=True),
        lambda path: float(problem.map.weights[tuple(path.T)].sum()),
    )


def rustworkx_graph(informed: bool, problem: Problem) -> Prepared:
    import rustworkx

    weights, least = with_ordinary_ends(problem)
    tail, head = (ends.tolist() for ends in edges(problem.map))
    graph = rustworkx.PyDiGraph()
    graph.add_nodes_from([(x, y) for y in range(problem.map.rows) for x in range(problem.map.cols)])
    graph.add_edges_from(list(zip(tail, head, weights.ravel()[head].tolist(), strict=True)))
    (start, target), estimate = numbers_of_ends(problem), towards(problem.target, least)

    def astar() -> Any:
        reached = problem.target.__eq__
        return rustworkx.astar_shortest_path(graph, start, reached, float, estimate)

    def dijkstra() -> Any:
        return rustworkx.dijkstra_shortest_paths(graph, start, target, weight_fn=float)[target]

    return Prepared(astar if informed else dijkstra, cost_of_numbers(problem))


def networkx_graph(informed: bool, problem: Problem) -> Prepared:
    import networkx

    weights, least = with_ordinary_ends(problem)
    tail, head = (ends.tolist() for ends in edges(problem.map))
    graph = networkx.DiGraph()
    graph.add_weighted_edges_from(zip(tail, head, weights.ravel()[head].tolist(), strict=True))
    (start, target), estimate = numbers_of_ends(problem), towards(problem.target, least)
    cols = problem.map.cols

    def heuristic(here: int, _: int) -> float:
        return estimate((here % cols, here // cols))

    solve = (
        partial(networkx.astar_path, graph, start, target, heuristic)
        if informed
        else partial(networkx.dijkstra_path, graph, start, target)
    )
    return Prepared(solve, cost_of_numbers(problem))


def pathfinding_grid(informed: bool, problem: Problem) -> Prepared:
    from pathfinding.core.diagonal_movement import DiagonalMovement
    from pathfinding.core.grid import Grid
    from pathfinding.core.heuristic import chebyshev
    from pathfinding.finder.a_star import AStarFinder
    from pathfinding.finder.dijkstra import DijkstraFinder

    class Fields(Grid):  # type: ignore[misc]
        def calc_cost(self, node_a: Any, node_b: Any, weighted: bool = False) -> float:
            return float(node_b.weight)

    weights, _ = with_ordinary_ends(problem)
    weights[problem.map.obstacles] = 0  # not to be passed
    grid = Fields(matrix=weights.tolist())
    finder = (
        AStarFinder(chebyshev, diagonal_movement=DiagonalMovement.always)
        if informed
        else DijkstraFinder(diagonal_movement=DiagonalMovement.always)
    )
    start, target = grid.node(*problem.start), grid.node(*problem.target)

    def cost(found: Any) -> float:
        return sum(float(problem.map.weights[node.y, node.x]) for node in found[0])

    return Prepared(partial(finder.find_path, start, target, grid), cost)


OURS = "gapath A*"

PEERS: dict[str, Peer] = {
    OURS: Peer(partial(gapath_planner, True)),
    "gapath Dijkstra": Peer(partial(gapath_planner, False)),
    "skimage MCP": Peer(skimage_mcp),
    "scipy csgraph": Peer(scipy_csgraph),
    "pyastar2d A*": Peer(pyastar2d_astar, "pyastar2d", zeros=False),
    "rustworkx A*": Peer(partial(rustworkx_graph, True), "rustworkx", 10),
    "rustworkx Dijkstra": Peer(partial(rustworkx_graph, False), "rustworkx", 10),
    "networkx A*": Peer(partial(networkx_graph, True), "networkx", 10),
    "networkx Dijkstra": Peer(partial(networkx_graph, False), "networkx", 10),
    "pathfinding A*": Peer(partial(pathfinding_grid, True), "pathfinding", 10, zeros=False),
    "pathfinding Dijkstra": Peer(partial(pathfinding_grid, False), "pathfinding", 10, zeros=False),
}
"""Each prepares a map; other peers enter here."""


def why_not(peer: Peer, problem: Problem) -> str | None:
    """Say why a peer cannot solve a problem here, if so."""
    if peer.extra and not find_spec(peer.extra):
        return "skipped: the bench extra is not installed"
    if not peer.zeros and with_ordinary_ends(problem)[1] == 0:
        return "skipped: fields of weight 0"
    return None


def once(peer: Peer, problem: Problem) -> tuple[float, float, float]:
    """Prepare and solve: the microseconds of both, and the cost."""
    set_up, prepared = timed(partial(peer.prepare, problem))
    prepared.solve()  # its own data in the caches, not the last peer's
    solve, found = timed(prepared.solve)
    return set_up, solve, prepared.cost(found)


def measure(quick: bool) -> list[Row]:
    return [row for problem in map(make_problem, MAPS) for row in _compare(problem, quick)]


def _compare(problem: Problem, quick: bool) -> list[Row]:
    skipped = {name: why_not(peer, problem) for name, peer in PEERS.items()}
    rows: dict[str, Row] = {}
    for rounds in sorted({peer.rounds for peer in PEERS.values()}):  # ours ends with the most
        calls: Calls = {
            name: partial(once, peer, problem)
            for name, peer in PEERS.items()
            if name == OURS or (peer.rounds == rounds and not skipped[name])
        }
        rows |= _time(problem, calls, 1 + (1 + rounds // 50 if quick else rounds))
    return [
        {"map": problem.map.name, "peer": name}
        | ({"solve us": why} if (why := skipped[name]) else rows[name])
        for name in PEERS
    ]


def _time(problem: Problem, calls: Calls, rounds: int) -> dict[str, Row]:
    _, results = interleave([calls] * rounds)
    optimum, rows = shortest_path(problem).cost, {}
    for name in calls:
        set_up, solve, costs = zip(*(found[name] for found in results), strict=True)
        if set(costs) != {optimum}:
            raise RuntimeError(f"{problem.map.name}: {name} finds {set(costs)}, not {optimum}")
        rows[name] = {
            "cost": optimum,
            "set-up us": quartiles(set_up),
            "solve us": quartiles(solve),
            "solve / gapath A*": ratios(solve, [found[OURS][1] for found in results]),
        }
    return rows
