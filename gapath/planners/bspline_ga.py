"""The genetic algorithm of Kwasniewski & Gosiewski 2018 (KG18), DOI 10.2478/ama-2018-0024.

A chromosome is the control points of a B-spline of degree 2. A few points of the curve are
rounded to fields and joined by straight lines; the fitness is the sum of the weights of the
fields on them, eq. (5). The best quarter survives and breeds.
"""

import copy
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property, partial
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks, require, require_extra, require_memory
from gapath.history.evolution import Evolution
from gapath.kernels.cuda.card import Card
from gapath.kernels.history.epochs import History, fitness_history
from gapath.kernels.kg18.bspline import Basis, basis, fractions, rasterise, way_points
from gapath.kernels.kg18.evolution import (
    KERNELS,
    SETTINGS,
    Evolve,
    evaluations,
    run_evolutions,
    usable_kernels,
)
from gapath.kernels.lines import KEY_BITS, ONE_OBSTACLE
from gapath.kernels.rng import Stream, probability_threshold
from gapath.kernels.units import SCALE
from gapath.planning.device import CPU
from gapath.problem import Plan, PlanStatus, Query, no_path

Arguments: TypeAlias = tuple[
    NDArray[np.int32],
    tuple[int, int, int, int],
    int,
    NDArray[np.void],
    NDArray[np.float64],
    NDArray[np.float64],
]


End: TypeAlias = tuple[int, int, NDArray[np.int32]]
"""What a run comes to: its epochs, and the best individual's key and chromosome."""


@dataclass(frozen=True)
class Planner:
    """KG18's planner; ``conf/planner/bspline_ga.yaml`` says where each value comes from.

    Parameters
    ----------
    population : int
        Individuals, at least 4.
    control_points : int
        k, control points of the B-spline with start and target, at least 3.
    min_epochs : int
        Epochs done at least, even if a path is found before; epoch 1 is the initial population.
    max_epochs : int
        Epochs done at most; without a path until then there is none.
    way_points : int
        Points of the curve that are joined by straight lines, at least 2.
    sampling : str
        "curve": that many way points of the whole curve; "span": of each knot span.
    mixing : float
        D of eq. (6), the fitter parent's share, in [0, 1].
    mutation_probability : float
        With which each gene of a child is drawn anew.
    line_jitter : int
        First third of the initial population, points on the straight line from start to target:
        largest change of a coordinate, in fields.
    line_jitter_probability : float
        Likewise: with which each coordinate is changed.
    neighbourhood : int
        Second third, points around the start: how far away at most, in fields.
    margin : int
        Last third, points all over the map: distance from its border, in fields; on a smaller
        map as much as leaves its middle.
    clip_to_map : bool
        Move genes outside the map to its border.
    vln : float
        What an obstacle field counts in the reported fitness.
    """

    population: int
    control_points: int
    min_epochs: int
    max_epochs: int
    way_points: int
    sampling: str
    mixing: float
    mutation_probability: float
    line_jitter: int
    line_jitter_probability: float
    neighbourhood: int
    margin: int
    clip_to_map: bool
    vln: float
    evolve: Evolve = field(init=False, repr=False, compare=False)
    """The kernels that plan; no setting, as all of them plan the same."""
    card: Card | None = field(init=False, repr=False, compare=False)
    """A GPU that plans instead; no setting either."""

    exact = False
    minimises = "weights"

    def __post_init__(self) -> None:
        check = Checks(self, "planner")
        check.whole("population", 4, 10**6)
        check.whole("control_points", 3, 32)
        check.whole("max_epochs", 1, 10**6)
        check(
            "min_epochs",
            1 <= self.min_epochs <= self.max_epochs,
            f"an integer from 1 to max_epochs, {self.max_epochs}",
        )
        check.whole("way_points", 2, 64)
        check("sampling", self.sampling in ("curve", "span"), '"curve" or "span"')
        for name in ("mixing", "mutation_probability", "line_jitter_probability"):
            check(name, 0 <= getattr(self, name) <= 1, "a number in [0, 1]")
        for name in ("line_jitter", "neighbourhood", "margin"):
            check.whole(name, 0, 65536)
        check("vln", 1 <= self.vln < float("inf"), "a finite number above every weight")
        genes, points = 2 * self.control_points, len(self.basis.rounding)
        needed = 4 * genes * (2 * self.population + self.max_epochs)
        needed += 8 * (genes * self.population + (5 + points) * self.max_epochs)
        require_memory(
            needed,
            "planner.population, planner.max_epochs",
            f"{self.population}, {self.max_epochs}",
        )
        object.__setattr__(self, "evolve", KERNELS[self.kernels[0]])
        object.__setattr__(self, "card", None)

    @property
    def kernels(self) -> tuple[str, ...]:
        """Names of the kernels that run here, the default first."""
        return usable_kernels()

    def using(self, kernels: str | Evolve) -> "Planner":
        """Give a planner that plans the same plans by other kernels.

        Parameters
        ----------
        kernels : str or Evolve
            One of `kernels`, or kernels of one's own.

        Returns
        -------
        Planner
            A copy.

        Raises
        ------
        InputError
            For a name that is none of `kernels`.
        """
        if isinstance(kernels, str):
            require(
                kernels in self.kernels, "kernels", kernels, f"one of {', '.join(self.kernels)}"
            )
            kernels = KERNELS[kernels]
        other = copy.copy(self)
        object.__setattr__(other, "evolve", kernels)
        return other

    @property
    def device(self) -> str:
        """What plans: "cpu", or the GPU's name."""
        return CPU if self.card is None else self.card.name

    def on(self, device: str) -> "Planner":
        """Give a planner that plans the same plans on a GPU.

        The processor does again what somebody wants to see the history of: a plan's epochs.

        Parameters
        ----------
        device : str
            CUDA.

        Returns
        -------
        Planner
            A copy.

        Raises
        ------
        InputError
            If there is no GPU, or no driver or package for it.
        """
        require_extra(f"device={device}", "cuda", "numba-cuda")
        from gapath.kernels.cuda.compiler import card

        other = copy.copy(self)
        object.__setattr__(other, "card", card())
        return other

    @property
    def most_at_once(self) -> int:
        """Runs of one `plan_many`: of a GPU's as many as it takes in a launch, else at most 64.

        More save nothing on a processor. Their histories take 4 MiB at most, and they end within
        seconds, so that threads share them.
        """
        if self.card is not None:
            from gapath.kernels.cuda.evolution import MOST_RUNS

            return MOST_RUNS
        history = self.max_epochs * (24 + 8 * self.control_points)
        evaluated = self.max_epochs * self.population
        return max(min((1 << 22) // history, 10**7 // evaluated, 64), 1)

    @cached_property
    def basis(self) -> Basis:
        """Basis functions at the way points."""
        return basis(self.control_points, self.way_points, self.sampling == "span")

    @cached_property
    def kernel_settings(self) -> NDArray[np.void]:
        """Settings as the kernels take them, (1,) `gapath.kernels.kg18.evolution.SETTINGS`."""
        mixing = Fraction(str(self.mixing))  # 0.8 is meant as 4/5, not as its nearest double
        if mixing.denominator > 10**6:
            mixing = mixing.limit_denominator(10**6)
        settings = np.zeros(1, dtype=SETTINGS)
        for name in SETTINGS.names or ():
            if hasattr(self, name):
                settings[name] = getattr(self, name)
        settings["mixing_numerator"] = mixing.numerator
        settings["mixing_denominator"] = mixing.denominator
        settings["mutation_threshold"] = probability_threshold(self.mutation_probability)
        settings["line_jitter_threshold"] = probability_threshold(self.line_jitter_probability)
        return settings

    def arguments(self, problem: Query) -> Arguments:
        """Give what kernels need to know of a problem.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.

        Returns
        -------
        table, ends, rule, settings, weights, rounding
            The first arguments of `gapath.kernels.kg18.evolution.Evolve`.
        """
        ends = (*problem.start, *problem.target)
        rule = int(problem.corner_cutting)
        return problem.map.table, ends, rule, self.kernel_settings, *self.basis

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Run the genetic algorithm once.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        stream : (4,) uint64
            A random stream, advanced in place.

        Returns
        -------
        Plan
            FOUND with the best path, or NOT_FOUND with the best fitness.
        """
        return next(iter(self.plan_many(problem, stream[None])))

    def plan_many(self, problem: Query, streams: NDArray[np.uint64]) -> Iterable[Plan]:
        """Run the genetic algorithm once for each stream, in one call of the kernel.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        streams : (n, 4) uint64
            Random streams, advanced in place.

        Returns
        -------
        iterable of Plan
            As `plan` gives them.
        """
        given = self.arguments(problem)
        if self.card is not None:
            return self._plans_of(self.card, given, streams)
        results = run_evolutions(*given, streams, self.evolve)
        return [self._plan(_end(result), partial(self._evolution, result)) for result in results]

    def _plans_of(
        self, card: Card, given: Arguments, streams: NDArray[np.uint64]
    ) -> Iterator[Plan]:
        """Plan on a GPU; of what it gives a plan is made when it is reached, one by one."""
        from gapath.kernels.cuda.evolution import outcomes

        begun = streams.copy()
        whole = fractions(self.control_points, self.way_points, self.sampling == "span")
        found = outcomes(card, *given[:4], whole, streams)
        ends = zip(found.epochs.tolist(), found.keys.tolist(), found.chromosomes, strict=True)
        return (
            self._plan(end, partial(self._again, given, begun[i], end))
            for i, end in enumerate(ends)
        )

    def _again(self, given: Arguments, stream: Stream, end: End) -> Evolution:
        """Do a GPU's run on the processor, whose history is the truth."""
        (result,) = run_evolutions(*given, stream[None].copy(), self.evolve)
        epochs, key, chromosome = _end(result)
        if (epochs, key, chromosome.tolist()) != (end[0], end[1], end[2].tolist()):
            told = f"{epochs} epochs and key {key}, on {self.device} {end[0]} and {end[1]}"
            raise RuntimeError(f"a plan comes to something else on the processor: {told}")
        return self._evolution(result)

    def _plan(self, end: End, trace: Callable[[], Evolution]) -> Plan:
        epochs, key, chromosome = end
        found = key < ONE_OBSTACLE
        return Plan(
            PlanStatus.FOUND if found else PlanStatus.NOT_FOUND,
            path=rasterise(chromosome, *self.basis) if found else no_path(),
            weights=(key & (ONE_OBSTACLE - 1)) / SCALE,
            obstacles=key >> KEY_BITS,
            vln=self.vln,
            epochs=epochs,
            evaluations=evaluations(self.population, epochs),
            trace=trace,
            lines=partial(self._lines, chromosome) if found else no_path,
        )

    def _lines(self, chromosome: NDArray[np.int32]) -> NDArray[np.int32]:
        return np.asarray(way_points(chromosome[None], self.basis)[0])

    def _evolution(self, result: History) -> Evolution:
        best, mean = fitness_history(result.epochs, self.population, self.vln, SCALE)
        return Evolution(
            best=best,
            mean=mean,
            chromosomes=result.chromosomes,
            way_points=way_points(result.chromosomes, self.basis),
            genotype="control_points",
        )


def _end(result: History) -> End:
    return len(result.epochs), int(result.epochs["key"][-1]), result.chromosomes[-1]
