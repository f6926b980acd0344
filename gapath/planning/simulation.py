"""Planning queries, trial by trial, and their times."""

import math
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from gapath.errors import InputError
from gapath.kernels.rng import stream
from gapath.planning.device import CPU, device_of
from gapath.planning.flaw import flaw
from gapath.planning.planner import Batching, Planner
from gapath.planning.threads import in_order
from gapath.problem import Plan, PlanStatus, Problem


@dataclass(frozen=True, eq=False)
class TimedPlan:
    """A planner's answer and the time that it took.

    Parameters
    ----------
    number : int
        The trial's number within its run.
    plan : Plan
        The answer.
    plan_time_s : float
        Wall time of the planner's call in seconds; NaN if it was not called.
    """

    number: int
    plan: Plan
    plan_time_s: float


def plan_once(problem: Problem, planner: Planner, seed: int, trial: int = 0) -> Plan:
    """Plan with the random stream of one trial.

    Parameters
    ----------
    problem : Problem
        Start and target on a known map.
    planner : Planner
        Any planner.
    seed, trial : int
        Keys of the random stream.

    Returns
    -------
    Plan
        The answer; INFEASIBLE if the target is walled in, without calling a planner that is not
        exact.

    Raises
    ------
    InputError
        If the planner returns no `Plan`.
    RuntimeError
        If the planner returns a path that is none.
    """
    ends, rule = (problem.start, problem.target), int(problem.corner_cutting)
    if not planner.exact and not problem.map.joined(*ends, rule):
        return Plan(PlanStatus.INFEASIBLE)
    plan = planner.plan(problem, stream(seed, trial))
    _check(problem, planner, plan, seed, trial)
    return plan


def _check(problem: Problem, planner: Planner, plan: Plan, seed: int, trial: int) -> None:
    if not isinstance(plan, Plan):  # its module is not where it shows
        raise InputError(f"{type(planner).__module__}, plan", plan, "a gapath.problem.Plan")
    if plan.feasible and (wrong := flaw(problem, plan.path, plan.cost)):
        name = type(planner).__module__
        raise RuntimeError(f"the path of {name} for seed {seed}, trial {trial}: {wrong}")


def plan_timed(
    problem: Problem, planner: Planner, number: int, keys: tuple[int, int, int]
) -> TimedPlan:
    """Plan once, and take the time of the planner's call.

    Parameters
    ----------
    problem : Problem
        Start and target on a known map, which a path joins.
    planner : Planner
        Any planner, whose kernels are compiled.
    number : int
        Of the trial.
    keys : (int, int, int)
        Those of the random stream.

    Returns
    -------
    TimedPlan
        The answer.

    Raises
    ------
    InputError
        If the planner returns no `Plan`.
    RuntimeError
        If the planner returns a path that is none.
    """
    random = stream(*keys)
    begin = time.perf_counter()
    plan = planner.plan(problem, random)
    seconds = time.perf_counter() - begin
    _check(problem, planner, plan, keys[0], number)
    return TimedPlan(number, plan, seconds)


def plan_trials(
    problem: Problem,
    optimum: Plan,
    planner: Planner,
    seed: int,
    trials: int,
    threads: int = 1,
    first: int = 0,
) -> Iterator[TimedPlan]:
    """Plan with the random streams (seed, first) to (seed, trials - 1).

    Parameters
    ----------
    problem : Problem
        Start and target on a known map.
    optimum : Plan
        A shortest path; if there is none, the planner is not called.
    planner : Planner
        Any planner.
    seed, trials : int
        Keys of the random streams.
    threads : int
        Threads that plan. With more than one a trial's time may hold a wait for another, and
        where the planner plans batches each trial has its batch's mean time, as it has where a
        GPU plans.
    first : int
        The trial to begin with.

    Yields
    ------
    TimedPlan
        In order. Each depends on the seed and its own number alone.

    Raises
    ------
    InputError
        If the planner returns no `Plan`.
    RuntimeError
        If the planner returns a path that is none.
    """
    if optimum.status is PlanStatus.INFEASIBLE:
        for number in range(first, trials):
            yield TimedPlan(number, Plan(PlanStatus.INFEASIBLE), math.nan)
        return
    planner.plan(problem, stream(seed, 0))  # compiles the kernels before the clock runs

    elsewhere = device_of(planner) != CPU
    many = planner if (threads > 1 or elsewhere) and isinstance(planner, Batching) else None

    def work(batch: range) -> Iterator[TimedPlan]:
        randoms = [stream(seed, number) for number in batch]
        begin = time.perf_counter()
        plans: Iterable[Plan]
        if many:
            plans = many.plan_many(problem, np.array(randoms))
        else:
            plans = [planner.plan(problem, random) for random in randoms]
        mean = (time.perf_counter() - begin) / len(batch)
        return (TimedPlan(number, plan, mean) for number, plan in zip(batch, plans, strict=True))

    most = many.most_at_once if many else 1
    pieces = batches(trials, threads, most, first)
    if elsewhere:  # nobody waits for the last ones
        pieces = (range(at, min(at + most, trials)) for at in range(first, trials, most))
    for answers in in_order(work, pieces, threads):
        for answer in answers:
            _check(problem, planner, answer.plan, seed, answer.number)
            yield answer


def batches(trials: int, threads: int, most: int, first: int = 0) -> Iterator[range]:
    """Divide trials into batches, the last ones small, so that all threads end at about one time.

    Parameters
    ----------
    trials : int
        How many trials.
    threads : int
        Threads that take batches, one after the other.
    most : int
        Trials of the largest batch.
    first : int
        The trial to begin with.

    Yields
    ------
    range
        Numbers of trials, in order.
    """
    begin = first
    while begin < trials:
        size = min(max((trials - begin) // (4 * threads), 1), most)
        yield range(begin, begin + size)
        begin += size
