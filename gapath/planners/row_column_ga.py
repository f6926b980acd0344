"""The genetic algorithms of Sedighi et al. 2004 (S04), and of Geisler and Hermanu before it.

A chromosome gives each row of a square grid a column, or each column a row; S04's may switch
between the two on the way. Fitness is relative to the population: few collisions, then a short
path of few turns, eqs (1) and (2).
"""

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks, require, require_memory
from gapath.history.evolution import Evolution
from gapath.kernels.history.epochs import History, fitness_history
from gapath.kernels.lines import KEY_BITS, ONE_OBSTACLE
from gapath.kernels.raster import polyline
from gapath.kernels.rng import Stream, probability_threshold
from gapath.kernels.s04.evolution import SETTINGS, run_evolution
from gapath.kernels.s04.genotype import MAX_SIDE
from gapath.kernels.units import SCALE
from gapath.problem import Plan, PlanStatus, Query, no_path
from gapath.survey.row_column import SquareView


@dataclass(frozen=True)
class Planner:
    """S04's planner; ``conf/planner/sedighi.yaml`` says where each value comes from.

    Parameters
    ----------
    column_wise : bool
        The flag is a gene: a path may go column by column, not only row by row.
    switches : int
        How often a path may change between the two, at most 2.
    population : int
        Individuals, at least 2.
    max_epochs : int
        Generations; the first is the initial population.
    stop_when_feasible : bool
        Stop as soon as the fittest path is feasible, however long it is.
    crossover_probability : float
        For each pair of parents; others are copied.
    mutation_probability : float
        For each gene.
    length_weight, turns_weight : float
        L and T of eq. (1).
    vln : float
        What an obstacle field counts in the reported cost, as in KG18.
    pad_to_square : bool
        Take a map that is not square, too: what it lacks to one counts as obstacles.
    """

    column_wise: bool
    switches: int
    population: int
    max_epochs: int
    stop_when_feasible: bool
    crossover_probability: float
    mutation_probability: float
    length_weight: float
    turns_weight: float
    vln: float
    pad_to_square: bool

    exact = False
    minimises = "weights"

    def __post_init__(self) -> None:
        check = Checks(self, "planner")
        check.whole("switches", 0, 2)
        check(
            "switches", not self.switches or self.column_wise, "0, as planner.column_wise is false"
        )
        check.whole("population", 2, 65535)
        check.whole("max_epochs", 1, 10**6)
        for name in ("crossover_probability", "mutation_probability"):
            check(name, 0 <= getattr(self, name) <= 1, "a number in [0, 1]")
        for name in ("length_weight", "turns_weight"):
            check(name, 0 <= getattr(self, name) <= 10**6, "a number from 0 to 1000000")
        check("turns_weight", self.length_weight + self.turns_weight > 0, "more than 0, or L is")
        check("vln", 1 <= self.vln < float("inf"), "a finite number above every weight")

    @cached_property
    def kernel_settings(self) -> NDArray[np.void]:
        """Settings as the kernel takes them, (1,) `gapath.kernels.s04.evolution.SETTINGS`."""
        settings = np.zeros(1, dtype=SETTINGS)
        for name in SETTINGS.names or ():
            if hasattr(self, name):
                settings[name] = getattr(self, name)
        settings["crossover_threshold"] = probability_threshold(self.crossover_probability)
        settings["mutation_threshold"] = probability_threshold(self.mutation_probability)
        return settings

    def check(self, problem: Query) -> None:
        """Refuse a map that is not square, unless it is to be padded, and one that is too large.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.

        Raises
        ------
        InputError
            If the map does not suit.
        """
        grid = problem.map
        require(
            grid.rows == grid.cols or self.pad_to_square,
            "map",
            f"{grid.cols} x {grid.rows} fields",
            "a square grid (S04), or planner.pad_to_square=true: what it lacks counts as obstacles",
        )
        n = max(grid.rows, grid.cols)
        require(n <= MAX_SIDE, "map", f"{n} fields a side", f"at most {MAX_SIDE} for this planner")
        needed = 4 * (2 * n + 2) * (2 * self.population + self.max_epochs)
        needed += 8 * (n + 3) * self.population + 8 * (2 * n + 5) * self.max_epochs
        require_memory(
            needed,
            "planner.population, planner.max_epochs",
            f"{self.population}, {self.max_epochs}",
        )

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Run the genetic algorithm once.

        Parameters
        ----------
        problem : Query
            Start and target on a known map; one that is not square counts as padded.
        stream : (4,) uint64
            A random stream, advanced in place.

        Returns
        -------
        Plan
            FOUND with the fittest path, or NOT_FOUND with its cost.
        """
        grid = problem.map
        view = SquareView.of(problem)
        settings = self.kernel_settings
        result = run_evolution(grid.table, view.ends, view.flips, settings, stream)
        key = int(result.epochs["key"][-1])
        found = key < ONE_OBSTACLE
        return Plan(
            PlanStatus.FOUND if found else PlanStatus.NOT_FOUND,
            path=polyline(view.paths(result.chromosomes[-1:])[0]) if found else no_path(),
            weights=(key & (ONE_OBSTACLE - 1)) / SCALE,
            obstacles=key >> KEY_BITS,
            vln=self.vln,
            epochs=len(result.epochs),
            evaluations=self.population * len(result.epochs),
            trace=partial(self._evolution, result, view),
        )

    def _evolution(self, result: History, view: SquareView) -> Evolution:
        best, mean = fitness_history(result.epochs, self.population, self.vln, SCALE)
        return Evolution(
            best=best,
            mean=mean,
            chromosomes=result.chromosomes,
            way_points=view.paths(result.chromosomes),
            genotype="row_column",
        )
