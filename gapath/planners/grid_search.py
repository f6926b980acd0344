"""A* and Dijkstra on the grid: the exact planners, and the rival of KG18's Table 1.

A* is the one that a robotics engineer would use (Hart, Nilsson, Raphael 1968).
"""

from dataclasses import dataclass

from gapath.errors import require
from gapath.kernels.rng import Stream
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Plan, Query


@dataclass(frozen=True)
class Planner:
    """Graph search on the 8-connected grid.

    Parameters
    ----------
    informed : bool
        True for A*, False for Dijkstra.
    minimise : str
        "weights": the sum of the weights of the path's fields (KG18 eq. (5)), and of equal ones
        the number of its fields;
        "length": the octile length, by which MovingAI's benchmarks are published.
    """

    informed: bool
    minimise: str

    exact = optimal = True

    def __post_init__(self) -> None:
        require(
            self.minimise in ("weights", "length"),
            "planner.minimise",
            self.minimise,
            '"weights" or "length"',
        )

    @property
    def minimises(self) -> str:
        """As its setting says."""
        return self.minimise

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Find a cheapest path, of several one of the fewest fields; the stream is not used."""
        return shortest_path(problem, self.informed, by_length=self.minimise == "length")
