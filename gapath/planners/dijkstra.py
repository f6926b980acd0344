"""Dijkstra's algorithm, the rival of KG18's Table 1."""

from dataclasses import dataclass

from gapath.errors import require
from gapath.graph import shortest_path
from gapath.problem import Plan, Query
from gapath.rng import Stream


@dataclass(frozen=True)
class Planner:
    """Dijkstra on the 8-connected grid.

    Parameters
    ----------
    minimise : str
        "weights": the sum of the weights of the path's fields (KG18 eq. (5));
        "length": the octile length, by which MovingAI's benchmarks are published.
    """

    minimise: str

    exact = True

    def __post_init__(self) -> None:
        require(
            self.minimise in ("weights", "length"),
            "planner.minimise",
            self.minimise,
            '"weights" or "length"',
        )

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Find a path of least cost; the stream is not used."""
        return shortest_path(problem, informed=False, by_length=self.minimise == "length")
