"""A planning problem and a plan."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from gapath.errors import InputError, one_of
from gapath.grid import Field, GridMap, PlanningMap
from gapath.history.evolution import Evolution
from gapath.history.graph import Graph
from gapath.kernels import units
from gapath.pictures.shown import FRAMES, Shown, axes_for
from gapath.scenario.listed import Queries
from gapath.scenario.nearest import nearest_told, other_reading

if TYPE_CHECKING:
    from gapath.pictures.animation import Animation
    from gapath.pictures.shown import Axes


class CornerCutting(IntEnum):
    """Whether a diagonal step may pass obstacles; a field outside the map counts as one, too."""

    ALLOW = units.ALLOW
    """Every diagonal step between free fields is allowed (KG18 sets no rule)."""
    ONE_SIDE = units.ONE_SIDE
    """Not if both orthogonal neighbours are obstacles."""
    FORBID = units.FORBID
    """Not if either orthogonal neighbour is an obstacle (MovingAI's rule)."""
    NO_DIAGONALS = units.NO_DIAGONALS
    """No diagonal step at all: horizontal and vertical moves only (S04)."""

    @classmethod
    def named(cls, name: str) -> Self:
        """Give the rule that a setting names, in lower case; raises InputError if it names none."""
        for rule in cls:
            if rule.setting == name:
                return rule
        raise InputError("corner_cutting", name, one_of(name, [rule.setting for rule in cls]))

    @cached_property
    def setting(self) -> str:
        """Its name in settings."""
        return self.name.lower()


class PlanStatus(IntEnum):
    """How a planning query ended."""

    FOUND = 0
    NOT_FOUND = 1
    INFEASIBLE = 2
    OPTIMAL = 3
    """Found, and proved to cost the least, KG18 eq. (5), of all paths on the map; who proves the
    least of something else, as of the length, says FOUND."""

    @property
    def sentence(self) -> str:
        """The status in words for people."""
        return (
            "a feasible path was found",
            "the planner stopped without a feasible path",
            "no path exists on the map, or in the graph that the planner made of it",
            "a path was found, and the planner proved that none costs less",
        )[self]


@dataclass(frozen=True, eq=False)
class Problem:
    """One planning query: from start to target on a known map.

    Parameters
    ----------
    map : GridMap
        The map.
    start, target : (x, y)
        Free fields on the map.
    corner_cutting : CornerCutting
        The rule for diagonal steps, the same for every planner.
    maps : mapping of str to GridMap
        What else a task read from files (`gapath.task.Task.read`): setting -> map.
    published_length : float
        Octile length of a shortest path, in fields, as the map's author gives it; NaN if nobody
        does.
    queries : Queries, optional
        Of a run over several pairs of start and target: all of them, of which this is one.

    Raises
    ------
    InputError
        If start or target is outside the map or on an obstacle.
    """

    map: GridMap
    start: Field
    target: Field
    corner_cutting: CornerCutting = CornerCutting.ALLOW
    maps: Mapping[str, GridMap] = field(default_factory=dict, repr=False)
    published_length: float = math.nan
    queries: Queries | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        for name in ("start", "target"):
            given = getattr(self, name)
            place = _pair(given)
            if place is None:
                raise InputError(f"map.{name}", given, "two integers [x, y]")
            object.__setattr__(self, name, place)
            if not self.map.contains(place):
                limits = f"0 <= x < {self.map.cols}, 0 <= y < {self.map.rows}"
                raise InputError(f"map.{name}", list(place), f"a field [x, y] with {limits}")
            if self.map.obstacles[place[1], place[0]]:
                nearest = nearest_told(self.map, self.map.obstacles, place)
                hint = f"; the nearest is {nearest}" if nearest else ", but there is none"
                ends = [e for e in (self.start, self.target) if self.map.contains(e)]
                hint += other_reading(self.map, self.map.weights == 0, ends)
                raise InputError(
                    f"map.{name}", f"{list(place)}, an obstacle", f"a free field{hint}"
                )

    @property
    def told(self) -> str:
        """From where to where, in words; of several queries how many, and one of them."""
        ends = f"{self.start} to {self.target}"
        if self.queries is None:
            return ends
        return f"{len(self.queries)} of them, such as {ends}"

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the map with start and target (`Shown.plot`)."""
        from gapath.pictures.board import draw_map, mark_ends

        ax = axes_for(ax)
        draw_map(ax, self.map.weights)
        mark_ends(ax, self.start, self.target)
        return ax


def _pair(place: Any) -> Field | None:
    try:
        x, y = place
        if type(x) is type(y) is int:  # nearly always
            return x, y
        pair = int(x), int(y)
        return pair if pair == (float(x), float(y)) else None
    except (TypeError, ValueError, OverflowError):
        return None


def no_path() -> NDArray[np.int32]:
    """Give the path of no fields."""
    return np.empty((0, 2), dtype=np.int32)


def nothing() -> None:
    """Tell nothing: what a plan says of what its planner does not have."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What a planning query came to, as rows, events and logs have it.

    Parameters
    ----------
    status : PlanStatus
        How the query ended.
    path : (n, 2) int32
        Fields (x, y) from start to target, each a neighbour of the one before; empty
        unless the status is FOUND or OPTIMAL.
    weights : float
        The sum of the weights of the path's fields, start included; for a genetic algorithm
        without success of its best path's, obstacles left out; infinite where there is nothing
        to sum.
    obstacles : int
        Obstacle fields on the best path, a step that cuts a corner counted as one; 0 if it is
        feasible. Less by `obstacles`, then by `weights`, is fitter.
    vln : float
        What the planner shows an obstacle field to cost (KG18 eq. (5)).
    epochs, evaluations : int
        Epochs of a genetic algorithm, and chromosomes whose fitness it computed.
    expansions : int
        Fields that a graph search expanded.
    """

    status: PlanStatus
    path: NDArray[np.int32] = field(default_factory=no_path, repr=False)
    weights: float = math.inf
    obstacles: int = 0
    vln: float = 0.0
    epochs: int = 0
    evaluations: int = 0
    expansions: int = 0

    @property
    def cost(self) -> float:
        """KG18 eq. (5) for people: the sum of the weights, each obstacle field counted as VLN."""
        return self.obstacles * self.vln + self.weights

    @property
    def feasible(self) -> bool:
        """True if the path joins start and target without an obstacle."""
        return self.status in (PlanStatus.FOUND, PlanStatus.OPTIMAL)

    @property
    def answer(self) -> "Answer":
        """The answer alone, without what a planner can tell besides."""
        return Answer(*(getattr(self, each.name) for each in fields(Answer)))


@dataclass(frozen=True, eq=False)
class Plan(Answer, Shown):
    """A planner's answer, and what it can tell of how it came to it.

    Parameters
    ----------
    status, path, weights, obstacles, vln, epochs, evaluations, expansions
        As of `Answer`.
    trace : callable
        Computes the history of a genetic algorithm, None for other planners; called only if
        somebody wants it.
    lines : callable
        Gives the way points (n, 2) that straight lines join, from start to target; none where the
        path is not made of such lines, as A*'s, one found on a smaller picture, or no path.
    survey : callable
        Gives what the planner made of the map before it searched, the same for every stream; None
        if it made nothing.
    stages : mapping of str to float
        Wall time of each stage in seconds, for a planner that has stages.
    problem : Problem, optional
        What was asked; `gapath.plan` sets it.
    """

    trace: Callable[[], Evolution | None] = field(default=nothing, repr=False)
    lines: Callable[[], NDArray[np.int32]] = field(default=no_path, repr=False)
    survey: Callable[[], Graph | None] = field(default=nothing, repr=False)
    stages: Mapping[str, float] = field(default_factory=dict, repr=False)
    problem: Problem | None = field(default=None, repr=False)

    @cached_property
    def evolution(self) -> Evolution | None:
        """The history of a genetic algorithm, epoch by epoch; None for other planners."""
        return self.trace()

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the map, the path and its way points; without a path the map (`Shown.plot`)."""
        from gapath.pictures.board import draw_path, legend_below

        problem = self._asked()
        ax = problem.plot(ax)
        if self.feasible:
            draw_path(ax, self.path, self.lines())
            legend_below(ax, ax.get_lines())
            ax.set_title(f"{problem.map.name}: a path of cost {self.cost:g}", parse_math=False)
        else:
            ax.set_title(f"{problem.map.name}: {self.status.sentence}", parse_math=False)
        return ax

    def convergence(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the best and the mean fitness by epoch, as `evolution` has them (`Shown.plot`).

        Raises
        ------
        InputError
            If there is no history: a graph search keeps none, and without any path nothing evolves.
        """
        from gapath.pictures.curves import draw_convergence

        history, ax = self._history(), axes_for(ax)
        draw_convergence(ax, history.best, history.mean)
        return ax

    def animate(self, most: int = FRAMES) -> "Animation":
        """Show the best path of each epoch in which it became another one.

        Parameters
        ----------
        most : int
            Pictures at most, spread evenly.

        Returns
        -------
        Animation
            A notebook plays it, `save` writes it; with a population all polygons are shown.

        Raises
        ------
        InputError
            If there is no history: a graph search keeps none, and without any path nothing evolves.
        """
        from gapath.pictures.animation import growing_path

        problem, history = self._asked(), self._history()
        shape, best, population = problem.map.weights.shape, history.best, history.population
        crowds = population.crowds(len(best)) if population else ()
        return growing_path(problem.plot, shape, history.way_points, best, crowds, most)

    def shares(self) -> dict[str, float]:
        """Tell by how much each way of making and changing a path lowered the cost: name -> cost.

        The first one's is what the first path cost; that less all others is the cost of the path.
        Empty for a planner that does not tell it (`gapath.history.evolution.Population`).
        """
        population = self.evolution.population if self.evolution else None
        return dict(zip(population.names, population.shares, strict=True)) if population else {}

    def _asked(self) -> Problem:
        if self.problem is None:
            raise InputError("plan.problem", None, "a plan of gapath.plan, which knows its problem")
        return self.problem

    def _history(self) -> Evolution:
        if self.evolution is None:
            found, right = "no history", "the plan of a genetic algorithm: other planners keep none"
            if self.status is PlanStatus.INFEASIBLE:
                found = "no history, as no path exists"
                right = "a genetic algorithm's plan of a problem with a path: else nothing evolves"
            raise InputError("plan.evolution", found, right)
        return self.evolution

    def _told(self) -> dict[str, object]:
        status = f"{self.status.name.lower()}: {self.status.sentence}"
        effort = {n: getattr(self, n) for n in ("epochs", "evaluations", "expansions")}
        return {"status": status, "cost": f"{self.cost:g}", "fields": len(self.path), **effort}


class Query(Protocol):
    """What planners are asked: a `Problem`, or a robot's question about what it knows."""

    @property
    def map(self) -> PlanningMap:
        """The map."""

    @property
    def start(self) -> Field:
        """A free field."""

    @property
    def target(self) -> Field:
        """A free field."""

    @property
    def corner_cutting(self) -> CornerCutting:
        """The rule for diagonal steps."""
