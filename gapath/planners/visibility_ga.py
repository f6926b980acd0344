"""The planner of Martinez Santa et al. 2022 (M22): keypoints, visibility graph, GA.

Obstacles become keypoints, keypoints a visibility graph, and a chromosome is a row of indices of
its points; the fitness is the path's length, eq. (7).
"""

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks, InputError, require_memory
from gapath.history.evolution import Evolution
from gapath.kernels.history.epochs import History
from gapath.kernels.m22.evolution import SETTINGS, path_length, run_evolution
from gapath.kernels.m22.graph import END, START
from gapath.kernels.rng import Stream, probability_threshold
from gapath.kernels.units import SCALE
from gapath.planning.stages import Stages
from gapath.problem import Plan, PlanStatus, Query
from gapath.survey.visibility_graph import Surveyor, VisibilityGraph

PROFILES = ("v64", "v67", "v69")


@dataclass(frozen=True)
class Planner(Surveyor):
    """M22's planner; ``conf/planner/visibility_ga.yaml`` says where each value comes from.

    Parameters
    ----------
    robot_radius, radius_unit, radius_tolerance, element, threshold
        As of `gapath.survey.obstacle_image.Clearance`.
    keypoints, corner_tolerance, push_out, resize
        As of `gapath.survey.visibility_graph.Surveyor`.
    ga2_profile : str
        Version of the library geneticalgorithm2 whose generations these are: "v64" (up to
        6.6.0), "v67" (6.7) or "v69" (6.8 on).
    genes : str or int
        Genes of a chromosome: "obstacles" or a number are turns between start and end; with
        "obstacles_and_ends" these two are genes as well, which a penalty holds in place.
    population : int
        Individuals.
    max_epochs : int
        Generations; the first is the initial population.
    max_stagnation : int or None
        Stop after more generations than this without a better path; None: never.
    mutation_probability : float
        For each gene.
    elite_portion, parents_portion : float
        Of the population; the elite is rounded up, with "v64" down but to no less than one
        individual unless it is 0.
    crossover_probability : float
        That a parent breeds; with "v67" the portion of those that do, without meaning in "v69".
    """

    ga2_profile: str
    genes: str | int
    population: int
    max_epochs: int
    max_stagnation: int | None
    mutation_probability: float
    elite_portion: float
    parents_portion: float
    crossover_probability: float

    exact = False
    minimises = "line_length"

    def __post_init__(self) -> None:
        super().__post_init__()
        check = Checks(self, "planner")
        check("ga2_profile", self.ga2_profile in PROFILES, f"one of {', '.join(PROFILES)}")
        if isinstance(self.genes, str):
            good = self.genes in ("obstacles", "obstacles_and_ends")
        else:
            good = 1 <= self.genes <= 1000
        check("genes", good, '"obstacles", "obstacles_and_ends" or an integer from 1 to 1000')
        check.whole("population", 4, 65535)
        check.whole("max_epochs", 1, 10**6)
        check(
            "max_stagnation",
            self.max_stagnation is None or 1 <= self.max_stagnation <= 10**6,
            "an integer from 1 to 1000000, or null",
        )
        for name in ("mutation_probability", "elite_portion", "parents_portion"):
            check(name, 0 <= getattr(self, name) <= 1, "a number in [0, 1]")
        check("crossover_probability", 0.05 <= self.crossover_probability <= 1, "in [0.05, 1]")
        check(
            "parents_portion",
            max(self._elites, 2) <= self.parents < self.population,
            "a portion with at least two parents and the elite, that leaves room for offspring",
        )

    @property
    def _elites(self) -> int:
        portion = self.population * self.elite_portion
        return int(portion) if self.ga2_profile == "v64" and portion > 1 else math.ceil(portion)

    @property
    def parents(self) -> int:
        """Individuals that breed; they live on."""
        parents = int(self.parents_portion * self.population)
        return parents + (self.population - parents) % 2  # children come in pairs

    def kernel_settings(self, problem: Query, scale: int) -> NDArray[np.void]:
        """Give the settings as the kernel takes them.

        Parameters
        ----------
        problem : Query
            Tells the penalty.
        scale : int
            Fields of the map, along a side, that are one pixel of the planner's picture.

        Returns
        -------
        (1,) SETTINGS
            `gapath.kernels.m22.evolution.SETTINGS`.
        """
        old, middle = self.ga2_profile == "v64", self.ga2_profile == "v67"
        parents = self.parents
        some = max(2, int(parents * self.crossover_probability))
        settings = np.zeros(1, dtype=SETTINGS)
        settings["population"] = self.population
        settings["ends_are_genes"] = self._ends_are_genes
        settings["max_epochs"] = self.max_epochs
        settings["max_stagnation"] = self.max_stagnation or self.max_epochs
        settings["parents"] = parents
        settings["elites"] = self._elites
        settings["breeders"] = 0 if old else some if middle else parents
        settings["crossover_threshold"] = probability_threshold(self.crossover_probability)
        settings["mutation_threshold"] = probability_threshold(self.mutation_probability)
        settings["roulette_skips_elites"] = not old
        settings["distinct_parents"] = not old
        settings["middle_includes_end"] = not old
        settings["first_excludes_last"] = old  # so does OppOpPopInit, its library, before 2.0
        settings["first_best_is_last_drawn"] = old
        settings["offspring_can_save"] = old
        # f(P)max: the perimeter of the picture
        settings["penalty"] = 2 * (problem.map.rows + problem.map.cols) * SCALE // scale
        return settings

    @property
    def _ends_are_genes(self) -> bool:
        return self.genes == "obstacles_and_ends"

    def _genes(self, obstacle_count: int) -> int:
        genes = self.genes
        if isinstance(genes, str):
            genes = max(1, obstacle_count) + (2 if self._ends_are_genes else 0)
        needed = 4 * genes * (2 * self.population + 5 * self.max_epochs) + 32 * self.max_epochs
        require_memory(needed, "planner.max_epochs", f"{self.max_epochs} with {genes} genes")
        return genes

    def check(self, problem: Query) -> None:
        """Refuse a problem that does not suit.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.

        Raises
        ------
        InputError
            If the robot does not fit at an end, or the map has too many keypoints or obstacles.
        """
        self._genes(self.count_obstacles(problem))

    def plan(self, problem: Query, stream: Stream) -> Plan:
        """Make the graph and run the genetic algorithm once.

        Parameters
        ----------
        problem : Query
            Start and target on a known map.
        stream : (4,) uint64
            A random stream, advanced in place.

        Returns
        -------
        Plan
            FOUND with the best path, or NOT_FOUND, also for what `check` refuses and a robot
            has come to know only now; INFEASIBLE if no path of the graph joins start and end.
        """
        stages = Stages()
        try:
            graph = self.survey(problem, stages)
            genes = self._genes(graph.obstacle_count)
        except InputError:
            return Plan(PlanStatus.NOT_FOUND, stages=stages.seconds)
        survey = partial(graph.drawn, problem)
        if not len(graph.shortest(informed=False)[0]):
            return Plan(PlanStatus.INFEASIBLE, survey=survey, stages=stages.seconds)
        result = run_evolution(
            graph.lengths, genes, self.kernel_settings(problem, graph.scale), stream
        )
        stages.end("genetic algorithm")
        turns = _turns(result.chromosomes, self._ends_are_genes)
        epochs = len(result.epochs)
        plan = Plan(
            PlanStatus.NOT_FOUND,
            epochs=epochs,
            evaluations=self.population + (self.population - self.parents) * (epochs - 1),
            trace=partial(_evolution, result, graph, problem, turns, self.population),
            survey=survey,
            stages=stages.seconds,
        )
        if path_length(graph.lengths, result.chromosomes[-1], self._ends_are_genes) < 0:
            return plan
        return graph.answer(plan, turns[-1], problem)


def _turns(chromosomes: NDArray[np.int32], ends_are_genes: bool) -> NDArray[np.int32]:
    """Give the paths of chromosomes as indices of points, the end repeated up to their last."""
    indices = chromosomes
    if not ends_are_genes:
        column = np.ones((len(chromosomes), 1), dtype=np.int32)
        indices = np.concatenate((START * column, chromosomes, END * column), axis=1)
    reached = np.logical_or.accumulate(indices == END, axis=1)
    return np.where(reached, np.int32(END), indices)


def _evolution(
    result: History,
    graph: VisibilityGraph,
    problem: Query,
    turns: NDArray[np.int32],
    population: int,
) -> Evolution:
    unit = SCALE / graph.scale
    return Evolution(
        best=result.epochs["best"] / unit,
        mean=result.epochs["sum"] / (unit * population),
        chromosomes=result.chromosomes,
        way_points=graph.on_map(problem)[turns],
        genotype="keypoints",
    )
