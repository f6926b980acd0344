"""How much a run is to do: counted before it begins, so that nobody waits for hours unawares."""

from collections.abc import Iterable, Mapping
from typing import Any

from gapath.store.settings import Flat, nested

MUCH = 10**10
"""Individuals tried and fields searched that take an hour or more, at some millions a second."""

_COUNTS = ("population", "max_epochs", "iterations", "tries", "effort", "step_limit")
"""Settings whose product bounds what a planner tries each time it plans."""


def work(settings: Flat, groups: Iterable[str], fields: int) -> int:
    """Bound what a trial does each time it plans.

    Parameters
    ----------
    settings : mapping
        Flat settings of a run.
    groups : iterable of str
        The groups of its task (`gapath.task.Task.groups`).
    fields : int
        Of the map.

    Returns
    -------
    int
        Individuals that its planners try at most, and fields that are searched.
    """
    given = nested(settings)
    return fields + sum(_tried(given.get(group)) for group in groups)


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
    trials = sum(trials for trials, _ in works)
    each = max(each for _, each in works)
    return (
        f"{trials} trials, each of up to {each:.2g} individuals and fields whenever it plans: "
        "this may take hours; Control-C ends it"
    )
