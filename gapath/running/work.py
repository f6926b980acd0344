"""How much a run is to do: counted before it begins, so that nobody waits for hours unawares."""

from collections.abc import Iterable, Mapping
from typing import Any

from gapath.store.settings import Flat, nested
from gapath.task import Replanning, Task

MUCH = 10**10
"""Individuals tried and fields searched that may take an hour."""

_A_SECOND = 4 * 10**6  # individuals of GA 3; A* searches 10^7 fields

_COUNTS = ("population", "max_epochs", "iterations", "tries", "effort")
"""Settings whose product bounds what a planner tries each time it plans."""


def work(task: Task, settings: Flat, fields: int) -> int:
    """Bound what a trial does.

    Parameters
    ----------
    task : Task
        Its task.
    settings : mapping
        Flat settings of a run.
    fields : int
        Of the map.

    Returns
    -------
    int
        Individuals that its planners try at most, and fields that are searched: all planners that
        it has, as often as it may plan.
    """
    given = nested(settings)
    once = fields + sum(_tried(given.get(group)) for group in task.groups)
    return once * (task.most_plans(fields) if isinstance(task, Replanning) else 1)


def _tried(settings: Any) -> int:
    if isinstance(settings, list):
        return sum(map(_tried, settings))
    if not isinstance(settings, Mapping):
        return 0
    product = 1
    for name in _COUNTS:
        value = settings.get(name)
        product *= max(1, int(value)) if isinstance(value, int | float) else 1
    return product + sum(map(_tried, settings.values()))


def told(works: Iterable[tuple[int, int]]) -> str | None:
    """Say how much runs are to do, if it is much.

    Parameters
    ----------
    works : iterable of (int, int)
        Of each run its trials, and `work` of each.

    Returns
    -------
    str or None
        A sentence; None if all together are less than `MUCH`.
    """
    works = list(works)
    total = sum(trials * each for trials, each in works)
    if total < MUCH:
        return None
    trials, each = sum(trials for trials, _ in works), max(each for _, each in works)
    return (
        f"{trials} trials of up to {each:.2g} individuals and fields each: up to "
        f"{total / _A_SECOND / 3600:.2g} hours at some millions a second, less where epochs end "
        "early and drives seldom plan; Control-C ends it"
    )
