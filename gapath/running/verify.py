"""A log held against its run done again: what came of it, and what was not as it was then."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from gapath.discovery import component_of
from gapath.errors import FAULTS, InputError, require
from gapath.events import Event, RunStarted
from gapath.planning.acceleration import AUTO
from gapath.recorders import mcap
from gapath.running.again import Again, events_again, made_again
from gapath.running.work import work
from gapath.store.keys import versions

MOST_WORK = 10**9
"""Individuals tried, and fields searched, that take some minutes; more is asked for."""


class Elsewhere(InputError):
    """A log's run cannot be done with what is installed; `others` says what it was made with."""

    others: Mapping[str, tuple[str, str]]


class Verified(NamedTuple):
    """What came of it.

    Parameters
    ----------
    found : Comparison
        The log against the one written anew.
    others : mapping of str to (str, str)
        What made the log in another version: name -> then, now; empty where there is none.
    remarks : list of str
        What of the log's words nobody can prove.
    """

    found: mcap.Comparison
    others: Mapping[str, tuple[str, str]]
    remarks: list[str]


def verify(
    path: Path, limits: mcap.Limits, kernels: str = AUTO, much_work: bool = False
) -> Verified:
    """Do a log's run again, and compare.

    Parameters
    ----------
    path : Path
        The log.
    limits : Limits
        What it may take.
    kernels : str
        Which kernels compute (`gapath.planning.acceleration.with_kernels`).
    much_work : bool
        Do it also if it takes long.

    Returns
    -------
    Verified
        What came of it.

    Raises
    ------
    Elsewhere
        If the run cannot be done here, and was done with something else.
    InputError
        If the log cannot be read, is not of a run, or its run takes long.
    """
    remarks: list[str] = []

    def again(logged: RunStarted) -> Iterator[Event]:
        try:
            made = made_again(logged, kernels)
        except InputError as error:
            told = error.within(path)
            found = Elsewhere(told.where, told.value, told.expected)
            found.others = _others(logged)
            raise (found if found.others else told) from error
        except FAULTS as error:  # of a component whose settings are anybody's
            raise _fault(path, error) from error
        try:
            remarks.extend(made.remarks)
            if not much_work:
                _check_work(made, path, limits)
            yield from events_again(made)
        except InputError as error:
            raise error.within(path) from error
        except FAULTS as error:
            raise _fault(path, error) from error

    found = mcap.compare(path, again, limits)
    others = _others(found.run)
    if found.version != mcap.LOG_VERSION:
        others = {"log version": (found.version, mcap.LOG_VERSION)} | others
    return Verified(found, others, remarks)


def _check_work(made: Again, path: Path, limits: mcap.Limits) -> None:
    """Raise InputError if it may take long to do again what is in a log.

    A trial that does more than the log says differs from it, and is the last one that is done.
    """
    run = made.started
    each = work(made.task, run.settings, run.problem.map.weights.size)
    most = run.trials * each
    if most > MOST_WORK:
        told = (1 + plan.evaluations + plan.expansions for plan in mcap.answers(path, limits))
        most = min(most, each + sum(told))
    much = f"up to {most:.1e} individuals and fields in what the log has"
    require(most <= MOST_WORK, "work", much, f"at most {MOST_WORK:.0e}, or --yes to do it")


def _fault(path: Path, error: BaseException) -> InputError:
    what = f"{component_of(error)}: {type(error).__name__} {error}"
    return InputError(path, what, "a run that can be done again")


def _others(run: RunStarted) -> dict[str, tuple[str, str]]:
    now, then = versions(), run.versions
    names = [name for name in {**then, **now} if then.get(name) != now.get(name)]
    return {name: (then.get(name, ""), now.get(name, "")) for name in names}


def made_with(others: Mapping[str, tuple[str, str]]) -> str:
    """Say with which versions a log was made that are not those here; nothing if there are none."""
    told = [f"{name} {then} ({now or 'none'} here)" for name, (then, now) in others.items() if then]
    told += [f"no version of {name} told" for name, (then, _) in others.items() if not then]
    return f"made with {', '.join(told)}" if told else ""
