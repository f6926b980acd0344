"""What every planner must offer."""

from collections.abc import Iterable
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.rng import Stream
from gapath.problem import Plan, Query


@runtime_checkable
class Particular(Protocol):
    """A planner or navigator that does not suit every problem says so, before a run begins."""

    def check(self, problem: Query) -> None:
        """Raise InputError if a problem does not suit."""


@runtime_checkable
class Optimal(Protocol):
    """A planner whose paths have the least of what it minimises says so; none is found twice."""

    @property
    def optimal(self) -> bool:
        """Whether no path that it finds can be improved upon."""


A_PLANNER = "a mapping with base, the name of a planner's YAML"
"""What is right where a setting has to be a planner."""


@runtime_checkable
class Planner(Protocol):
    """What a module of `gapath.planners` offers under the name ``Planner``.

    A frozen dataclass whose fields are the settings of its YAML file in ``conf/planner``.
    """

    @property
    def exact(self) -> bool:
        """True if it finds a path wherever there is one."""

    @property
    def minimises(self) -> str:
        """What it seeks the least of: "weights" (KG18 eq. (5)), "length" (octile) or a metric."""

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Plan a path; every random number comes from the stream.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        stream : (4,) uint64
            A random stream, advanced in place (`gapath.kernels.rng.stream`).

        Returns
        -------
        Plan
            The answer, also when nothing was found.
        """


@runtime_checkable
class Batching(Protocol):
    """A planner that plans many times in one call, without Python in between."""

    @property
    def most_at_once(self) -> int:
        """Plans that one call is best asked for at most; what they keep has to fit memory."""

    def plan_many(self, problem: Query, streams: NDArray[np.uint64]) -> Iterable[Plan]:
        """Plan once for each stream, as `Planner.plan` does.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        streams : (n, 4) uint64
            Random streams, advanced in place.

        Returns
        -------
        iterable of Plan
            In their order; all is planned when it is given, but a plan may take up room only when
            it is reached.
        """
