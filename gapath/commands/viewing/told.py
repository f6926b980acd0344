"""One trial of a log, as it is drawn, or printed."""

from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path

from gapath.driving.retold import Drive
from gapath.errors import InputError, require
from gapath.events import DriveFinished, Event, Evolved, RunStarted, Surveyed, TrialFinished
from gapath.problem import Answer, Plan, no_path
from gapath.querying.told import posed_in
from gapath.recorders import mcap


def told_trial(path: Path, trial: int, limits: mcap.Limits) -> tuple[RunStarted, list[Event]]:
    """Read one trial of a log.

    Parameters
    ----------
    path : Path
        The log.
    trial : int
        Number of the trial.
    limits : Limits
        What the log may take.

    Returns
    -------
    run : RunStarted
        What the run's trials share.
    events : list of Event
        The trial's; what its planner made of the map lies before the last one.

    Raises
    ------
    InputError
        If the log cannot be read or drawn, or has no such trial.
    """
    events = mcap.read_sound(path, limits)
    run = next(events)
    assert isinstance(run, RunStarted), "the reader gives it first"
    found: list[Event] = []
    survey: list[Event] = []
    last = -1
    for event in events:
        number = getattr(event, "trial", -1)
        last = max(last, number)
        if isinstance(event, Surveyed):
            survey = [event]
        elif number == trial:
            found.append(event)
    expected = f"a trial of this log, 0 to {last}" if last >= 0 else "a log of at least one trial"
    require(bool(found), "trial", trial, expected)
    return run, [*found[:-1], *survey, found[-1]]


def drawn(run: RunStarted, events: list[Event]) -> Plan | Drive:
    """Give a trial as the library has it, to be drawn.

    Parameters
    ----------
    run : RunStarted
        What the run's trials share.
    events : list of Event
        The trial's, its end last.

    Returns
    -------
    Plan or Drive
        As `gapath.plan` and `gapath.drive` give them; a plan has way points where a genetic
        algorithm found it.

    Raises
    ------
    InputError
        If it is neither a plan nor a drive.
    """
    end = events[-1]
    if isinstance(end, DriveFinished):
        return Drive(run.problem, events)
    if not isinstance(end, TrialFinished):
        raise InputError(
            "trial", f"one of task {run.task}", "a plan or a drive, which can be drawn"
        )
    posed = posed_in(run, events)
    problem = replace(run.problem, start=posed.start, target=posed.target)
    evolutions = (event.evolution for event in events if isinstance(event, Evolved))
    history = next(evolutions, None)
    lines = no_path() if history is None else history.way_points[-1]
    answer = {each.name: getattr(end.answer, each.name) for each in fields(Answer)}
    return Plan(**answer, trace=lambda: history, lines=lambda: lines, problem=problem)


def path_rows(path: Path, trial: int, limits: mcap.Limits) -> Iterator[str]:
    """Give the path of a trial as a table.

    Parameters
    ----------
    path : Path
        The log.
    trial : int
        Number of the trial.
    limits : Limits
        What the log may take.

    Yields
    ------
    str
        Lines of CSV: ``x,y``, then the centre of each field in metres in the map's frame (of a map
        without a scale a field is one), to the micrometre.

    Raises
    ------
    InputError
        As `told_trial` and `drawn`, and if there is no path.
    """
    told = drawn(*told_trial(path, trial, limits))
    found = "no path" if isinstance(told, Drive) else f"no path: {told.status.sentence}"
    require(len(told.path) > 0, f"trial {trial}", found, "a trial that found one")
    yield "x,y\n"
    assert told.problem is not None, "a log has it"
    for x, y in told.problem.map.to_metres(told.path).round(6).tolist():
        yield f"{x},{y}\n"
