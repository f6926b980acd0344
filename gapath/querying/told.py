"""A planning query told as events."""

from collections.abc import Iterable, Iterator

from gapath.events import (
    Event,
    Evolved,
    Posed,
    RunStarted,
    Surveyed,
    TrialFinished,
    TrialStarted,
)
from gapath.planning.simulation import TimedPlan
from gapath.problem import Plan


def trial_events(
    answer: TimedPlan, seed: int, step: int, surveyed: bool | None = None
) -> Iterator[Event]:
    """Tell a planning query as events.

    Parameters
    ----------
    answer : TimedPlan
        The planner's answer.
    seed : int
        The run's seed.
    step : int
        The step at which the trial begins.
    surveyed : bool, optional
        Whether to tell what the planner made of the map; without it the first trial tells.

    Yields
    ------
    Event
        Its start, what the planner made of the map, its evolution if it has one, its end.
    """
    plan = answer.plan
    surveyed = answer.number == 0 if surveyed is None else surveyed
    yield TrialStarted(step, answer.number, seed)
    if surveyed and (graph := plan.survey()) is not None:
        yield Surveyed(step, answer.number, graph)
    if plan.evolution is not None:
        yield Evolved(step, answer.number, 0, plan.evolution)
    yield TrialFinished(step + duration(plan) - 1, answer.number, plan.answer)


def duration(plan: Plan) -> int:
    """Give the number of steps that a query takes: one an epoch, at least one."""
    return max(plan.epochs, 1)


def posed_in(run: RunStarted, events: Iterable[Event]) -> Posed:
    """Tell what a trial was asked.

    Parameters
    ----------
    run : RunStarted
        The first event of its run.
    events : iterable of Event
        Those of the trial.

    Returns
    -------
    Posed
        What it says itself, else what all trials of the run share.
    """
    shared = (run.problem.start, run.problem.target, run.optimal_path, run.optimal_cost)
    return next((event for event in events if isinstance(event, Posed)), Posed(0, 0, 0, *shared))
