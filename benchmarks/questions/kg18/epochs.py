"""One epoch of KG18's genetic algorithm, against the genetic algorithms of four libraries.

Microseconds an epoch: the time that 110 epochs take more than 10 do, divided by 100, so neither
set-up nor imports count. Populations of 40 (GA 1, k = 4) and 100 (GA 3, k = 5) on kg18_test4,
where no path of so few lines exists and every run takes all its epochs. A ratio "library /
gapath" above 1 says that gapath is the faster one. The target is 40.

All search the same genes, the inner control points, for the least value of the same fitness:
gapath's compiled kernel for one chromosome, which the libraries call from Python, as their users
would. gapath itself evaluates a whole population at a time. Each library is set
(`benchmarks/epochs_*.py`) as near to KG18 as it can be: its best quarter survives and breeds, all
others are bred anew and mutated gene by gene with the same probability. None crosses integers
arithmetically, so all cross them uniformly; they start anywhere on the map and keep to it.

Every library evaluates about as many chromosomes as gapath, and the value it gives for its best
one is what the fitness is, or this stops. pygad does not evaluate again what it has among its
elite, so it evaluates the fewest.
"""

from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module, metadata
from importlib.util import find_spec
from typing import NamedTuple, TypeAlias

from benchmarks.measure import (
    Row,
    interleave,
    make_bspline_ga,
    make_problem,
    quartiles,
    ratios,
    timed,
)
from benchmarks.rivals import visibility_library
from benchmarks.rivals.objective import Objective
from gapath.kernels.lines import ONE_OBSTACLE
from gapath.kernels.rng import stream
from gapath.kernels.units import SCALE
from gapath.planners.bspline_ga import Planner
from gapath.problem import Problem

MAP = "kg18_test4"
PLANNERS = ("ga1", "ga3")
LIBRARIES = ("geneticalgorithm2", "deap", "pygad", "pymoo")
"""Packages, each with a module ``epochs_PACKAGE`` that evolves with it; others enter here."""

EPOCHS = 10, 110
TOLERANCE = 0.2
"""Share by which a library's evaluations may differ from gapath's."""


Evolve: TypeAlias = Callable[[Planner, Objective, int], tuple[Sequence[float], float]]
"""Runs `planner.max_epochs` populations with a seed; gives the best genes and their value."""


class BestFound(NamedTuple):
    """What a run came to."""

    genes: Sequence[float]
    value: float
    evaluations: int


Contender: TypeAlias = Callable[[Problem, Planner, int], Callable[[], BestFound]]
"""Runs with a seed, which is timed; the outcome is read later."""


def run_gapath(problem: Problem, planner: Planner, seed: int) -> Callable[[], BestFound]:
    plan = planner.plan(problem, stream(seed))

    def outcome() -> BestFound:
        assert plan.evolution is not None
        value = plan.obstacles * ONE_OBSTACLE + plan.weights * SCALE
        return BestFound(plan.evolution.chromosomes[-1][2:-2], value, plan.evaluations)

    return outcome


def run_library(
    evolve: Evolve, problem: Problem, planner: Planner, seed: int
) -> Callable[[], BestFound]:
    objective = Objective(problem, planner)
    genes, value = evolve(planner, objective, seed)
    return lambda: BestFound(genes, value, objective.calls)


def why_not(library: str) -> str | None:
    """Say why a library cannot run here, if so."""
    if library == "geneticalgorithm2":
        return visibility_library.unavailable()
    return None if find_spec(library) else "skipped: the bench extra is not installed"


def library_run(library: str) -> Contender:
    """Import a library."""
    return partial(run_library, import_module(f"benchmarks.rivals.epochs_{library}").evolve)


def check_alike(name: str, outcome: BestFound, objective: Objective, expected: int) -> None:
    """Raise RuntimeError unless a run did the work and its best is worth what it says."""
    if abs(outcome.evaluations - expected) > TOLERANCE * expected:
        raise RuntimeError(f"{name} evaluates {outcome.evaluations} chromosomes, not {expected}")
    value = objective(outcome.genes)
    if outcome.value != value:
        raise RuntimeError(f"{name}: its best is worth {value}, not {outcome.value}")


def time_epoch(
    run: Contender, problem: Problem, short: Planner, long: Planner, seed: int
) -> tuple[float, Callable[[], BestFound]]:
    """Give the microseconds of one epoch more, and the long run's outcome."""
    run(problem, short, seed)  # its own data in the caches, not the last rival's
    less, _ = timed(partial(run, problem, short, seed))
    more, outcome = timed(partial(run, problem, long, seed))
    return (more - less) / (long.max_epochs - short.max_epochs), outcome


def measure(quick: bool) -> list[Row]:
    epochs, rounds = ((5, 25), 3) if quick else (EPOCHS, 16)
    return [row for name in PLANNERS for row in _compare(name, epochs, rounds)]


def _compare(name: str, epochs: tuple[int, int], rounds: int) -> list[Row]:
    problem = make_problem(MAP)
    short, long = (make_bspline_ga(name, max_epochs=number) for number in epochs)
    runs: dict[str, Contender] = {"gapath": run_gapath}
    runs |= {library: library_run(library) for library in LIBRARIES if not why_not(library)}
    _, results = interleave(
        [
            {
                rival: partial(time_epoch, run, problem, short, long, seed)
                for rival, run in runs.items()
            }
            for seed in range(rounds)
        ]
    )
    objective = Objective(problem, long)
    for found in results:
        outcomes = {rival: outcome() for rival, (_, outcome) in found.items()}
        for rival in runs:
            check_alike(rival, outcomes[rival], objective, outcomes["gapath"].evaluations)

    times = {rival: [found[rival][0] for found in results] for rival in runs}
    rows: list[Row] = [
        {
            "population": long.population,
            "library": f"{rival} {metadata.version(rival)}",
            "us an epoch": quartiles(times[rival]),
            "library / gapath": ratios(times[rival], times["gapath"]),
        }
        for rival in runs
    ]
    return rows + [
        {"population": long.population, "library": library, "us an epoch": why}
        for library in LIBRARIES
        if (why := why_not(library))
    ]
