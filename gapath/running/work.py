"""How much a run is to do: counted before it begins, so that nobody waits for hours unawares."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from gapath.store.settings import Flat, nested
from gapath.task import Replanning, Task

MUCH = 10**10
"""Individuals tried and fields searched that may take an hour."""

_A_SECOND = 4 * 10**6  # individuals of GA 3; A* searches 10^7 fields

_COUNTS = ("population", "max_epochs", "iterations", "tries")
"""Settings whose product bounds what a planner tries each time it plans."""

_OF_FIELDS, _MORE = "effort", "shortcuts"
"""Settings of what it may do besides: times the map's fields, and as it is."""


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
    once = fields + sum(_tried(given.get(group), fields) for group in task.groups)
    return once * (task.most_plans(fields) if isinstance(task, Replanning) else 1)


def likely(task: Task, settings: Flat, fields: int) -> int:
    """Say what a trial may come to, for people: `work`, but of a drive a hundredth of it.

    A drive is over long before its step limit, plans in some of its steps, and its epochs end
    early: KG18's through its fourth unknown map do a six hundredth of the bound.
    """
    seldom = 100 if isinstance(task, Replanning) else 1
    return work(task, settings, fields) // seldom


def _tried(settings: Any, fields: int) -> int:
    if isinstance(settings, list):
        return sum(_tried(each, fields) for each in settings)
    if not isinstance(settings, Mapping):
        return 0

    def value(name: str, least: int) -> float:
        found = settings.get(name)
        return max(least, found) if isinstance(found, int | float) else least

    tried = math.prod(int(value(name, 1)) for name in _COUNTS)
    tried += int(value(_OF_FIELDS, 0) * fields) + int(value(_MORE, 0))
    return tried + sum(_tried(each, fields) for each in settings.values())


def told(works: Iterable[tuple[int, int]]) -> str | None:
    """Say how much runs are to do, if it is much.

    Parameters
    ----------
    works : iterable of (int, int)
        Of each run its trials, and what is `likely` of each.

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
        "early; Control-C ends it"
    )
