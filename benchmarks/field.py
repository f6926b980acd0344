"""Planners on the same problems: what an answer is worth, and times taken in turn."""

import random
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from benchmarks.measure import Calls, Row, make_planner, quartiles
from benchmarks.posed import solvable
from gapath.discovery import yaml_names
from gapath.errors import InputError
from gapath.kernels.graph_search import BY_LENGTH, FIELD_BITS, path_to, search
from gapath.kernels.memetic.evolution import evolve
from gapath.kernels.rivals.jump_points import jump_search, jumped_path
from gapath.kernels.rng import Stream, stream
from gapath.planners import grid_search, jump_point, memetic
from gapath.planning.flaw import flaw
from gapath.planning.planner import Particular, Planner
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Plan, PlanStatus, Problem

TAKES = 3
"""Of so many times of a call the least counts: whatever disturbs one makes it longer."""
ASTAR = "A*"
CHEAPEST = ("astar", "dijkstra", "jps")
"""Planners whose paths are to cost what A*'s does."""


def contenders(
    names: Iterable[str], settings: Mapping[str, Mapping[str, Any]] | None = None
) -> dict[str, Planner | str]:
    """Make planners by name; the reason instead where there is none of that name.

    Parameters
    ----------
    names : iterable of str
        Names in ``conf/planner``, or keys of `settings`.
    settings : mapping of str to mapping, optional
        What replaces a planner's settings; "base" is the name of its YAML.

    Returns
    -------
    dict of str to Planner or str
        In the order of the names.
    """
    made: dict[str, Planner | str] = {}
    for name in names:
        changes = dict((settings or {}).get(name, {}))
        base = str(changes.pop("base", name))
        if base in yaml_names("planner"):
            made[name] = make_planner(base, **changes)
        else:
            made[name] = f"skipped: there is no planner {base}"
    return made


def unsuited(planner: Planner, problems: Iterable[Problem]) -> str | None:
    """Say why a planner does not take one of some problems, if so."""
    if isinstance(planner, Particular):
        try:
            for problem in problems:
                planner.check(problem)
        except InputError as error:
            return f"skipped: {error}"
    return None


def verdict(problem: Problem, plan: Plan) -> str:
    """Judge an answer.

    Parameters
    ----------
    problem : Problem
        What was asked.
    plan : Plan
        The answer.

    Returns
    -------
    str
        "found" a path that is one; "missed" one, or the proof that there is none; "proved" that
        there is none; "false", any answer that is not so, or a dearer path said to be optimal.
    """
    if plan.feasible:
        claims = plan.status is PlanStatus.OPTIMAL
        wrong = flaw(problem, plan.path, plan.cost) is not None
        wrong = wrong or (claims and plan.cost > shortest_path(problem).cost)
        return "false" if wrong else "found"
    if plan.status is PlanStatus.INFEASIBLE:
        return "false" if solvable(problem) else "proved"
    return "missed"


def graph_search(planner: grid_search.Planner, problem: Problem, _: Stream) -> Callable[[], Any]:
    """Give A* or Dijkstra as calls of kernels, with nothing around but the memory that it needs."""
    table, rule = problem.map.table, int(problem.corner_cutting)
    ends, least = (
        (*problem.start, *problem.target),
        problem.map.least_weight(problem.start, problem.target),
    )
    counted = BY_LENGTH if planner.minimise == "length" else FIELD_BITS
    expansions = np.zeros(1, dtype=np.int64)

    def call() -> Any:
        states = np.zeros(table.size, dtype=np.int64)
        search(table, *ends, rule, counted, planner.informed, least, states, expansions)
        return path_to(states, table.shape[1], *problem.target)

    return call


def memetic_algorithm(
    planner: memetic.Planner, problem: Problem, random: Stream
) -> Callable[[], Any]:
    """Give the memetic algorithm as a call of its kernel, or A* where that is what it asks."""
    if problem.map.table.size <= memetic.SMALL:
        return graph_search(grid_search.Planner(True, "weights"), problem, random)
    ends, rule = (*problem.start, *problem.target), int(problem.corner_cutting)
    least = problem.map.least_weight(problem.start, problem.target)
    query = (problem.map.table, *ends, rule, least)
    return partial(evolve, *query, planner.kernel_settings, np.empty(0, dtype=np.uint32), random)


def jump_point_search(
    planner: jump_point.Planner, problem: Problem, _: Stream
) -> Callable[[], Any]:
    """Give jump point search as calls of kernels."""
    table, rule = problem.map.table, int(problem.corner_cutting)
    query = (table, *problem.start, *problem.target, rule, *jump_point.STEPS[planner.minimise])
    expansions = np.zeros(1, dtype=np.int64)

    def call() -> Any:
        turns = np.empty(table.size, dtype=np.int64)
        return jumped_path(turns[: jump_search(*query, turns, expansions)], table.shape[1], rule)

    return call


KERNELS: dict[type, Callable[[Any, Problem, Stream], Callable[[], Any]]] = {
    grid_search.Planner: graph_search,
    jump_point.Planner: jump_point_search,
    memetic.Planner: memetic_algorithm,
}
"""Planners whose kernel can be called by itself: how that is prepared."""


_shuffle = random.Random(0).shuffle
"""Goes on from call to call: what ran before decides what the caches hold."""


def least_times(
    make: Callable[[], Calls], takes: int = TAKES
) -> tuple[dict[str, float], dict[str, Any]]:
    """Time rivals in turn, several times, by the clock of this thread; the least counts.

    Parameters
    ----------
    make : callable
        Prepares one call of each rival; not timed.
    takes : int
        How many times, at least once.

    Returns
    -------
    times : dict of str to float
        Microseconds.
    results : dict of str to object
        Of each rival's last call.
    """
    best: dict[str, float] = {}
    results: dict[str, Any] = {}
    for _ in range(takes):
        calls = make()
        names = list(calls)
        _shuffle(names)
        for name in names:
            call = calls[name]
            begin = time.thread_time_ns()
            results[name] = call()
            spent = (time.thread_time_ns() - begin) / 1e3
            best[name] = min(spent, best.get(name, spent))
    return best, results


@dataclass(frozen=True)
class Heat:
    """A planner beside A* on one problem."""

    verdict: str
    """As `verdict` gives it; "false" also for one that is cheaper than A*'s, or for one of the
    `CHEAPEST` planners' that is dearer."""
    ratio: float
    """Cost over A*'s; NaN if nothing was found."""
    times: Mapping[str, float]
    """Microseconds of `plan` and, where it can be called, of the kernel ("NAME, kernel"); of all
    rivals, A* among them."""


def race(problem: Problem, planners: Mapping[str, Planner], seed: int = 0) -> dict[str, Heat]:
    """Let planners plan; what they find is checked before any time is taken.

    Parameters
    ----------
    problem : Problem
        One that can be solved.
    planners : mapping of str to Planner
        By name; A* always takes part.
    seed : int
        Key of the random streams, the same for all.

    Returns
    -------
    dict of str to Heat
        By name; A*'s own costs and times are in those of the others.
    """
    optimum = shortest_path(problem)
    assert optimum.feasible
    plans = {name: planner.plan(problem, stream(seed)) for name, planner in planners.items()}
    rivals = {ASTAR: make_planner("astar"), **planners}

    def calls() -> Calls:
        called: Calls = {}
        for name, planner in rivals.items():
            called[name] = partial(planner.plan, problem, stream(seed))
            if prepare := KERNELS.get(type(planner)):
                called[f"{name}, kernel"] = prepare(planner, problem, stream(seed))
        return called

    times, _ = least_times(calls)
    heats = {}
    for name, plan in plans.items():
        judged, ratio = verdict(problem, plan), np.nan
        if judged == "found":
            ratio = plan.cost / optimum.cost if optimum.cost else 1.0
            if plan.cost < optimum.cost or (name in CHEAPEST and plan.cost > optimum.cost):
                judged = "false"
        heats[name] = Heat(judged, float(ratio), times)
    return heats


def summary(name: str, heats: Sequence[Heat]) -> Row:
    """Sum up what a planner did on some problems, beside A*.

    "dearer" is by how much it costs more than A*, in per cent: mean, percentiles and most. Ratios
    of times are of totals; "a problem" is the median of the problems' own, with quartiles.
    """
    row: Row = {"problems": len(heats)}
    for judged in ("found", "false"):
        row[judged] = sum(heat.verdict == judged for heat in heats)
    row["found %"] = 100 * row["found"] / len(heats)
    if row["found"]:
        more = 100 * np.array([heat.ratio - 1 for heat in heats if heat.verdict == "found"])
        row["dearer %"] = float(more.mean())
        for share in (90, 99):
            row[f"dearer %, {share}th"] = float(np.quantile(more, share / 100))
        row["dearer %, most"] = float(more.max())
    row |= _times("A* ms", "ms", "A* / planner", name, heats, "")
    if all(f"{name}, kernel" in heat.times for heat in heats):
        row |= _times("A* kernel ms", "kernel ms", "A* / kernel", name, heats, ", kernel")
    if all("jps" in heat.times for heat in heats):
        row["jps / planner"] = sum(h.times["jps"] for h in heats) / (1e3 * row["ms"])
    return row


def _times(astar: str, own: str, over: str, name: str, heats: Sequence[Heat], level: str) -> Row:
    above = [heat.times[f"{ASTAR}{level}"] for heat in heats]
    below = [heat.times[f"{name}{level}"] for heat in heats]
    pairs = zip(above, below, strict=True)
    return {
        astar: sum(above) / 1e3,
        own: sum(below) / 1e3,
        over: sum(above) / sum(below),
        f"{over}, a problem": quartiles([a / b for a, b in pairs]),
    }


def compared(
    problems: Sequence[Problem], planners: Mapping[str, Planner | str]
) -> Iterator[tuple[str, str | list[Heat]]]:
    """Let planners plan on the same problems that can be solved.

    Parameters
    ----------
    problems : sequence of Problem
        At least one.
    planners : mapping of str to Planner or str
        As of `contenders`.

    Yields
    ------
    name : str
        The planner.
    heats : list of Heat or str
        One a problem, or why there is none.
    """
    reasons = {
        name: planner if isinstance(planner, str) else unsuited(planner, problems)
        for name, planner in planners.items()
    }
    able = {n: p for n, p in planners.items() if not isinstance(p, str) and not reasons[n]}
    race(problems[0], able)  # compiles the kernels before a clock runs
    heats = [race(problem, able, seed) for seed, problem in enumerate(problems)] if able else []
    for name, reason in reasons.items():
        yield name, reason or [heat[name] for heat in heats]
