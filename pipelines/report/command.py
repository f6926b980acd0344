"""The commands behind numbers, written as few as they can be."""

from collections.abc import Iterable

_LISTS = set(",'\"")
"""A value with these would read as several in a sweep, or is part of one."""


def as_sweeps(commands: Iterable[str]) -> list[str]:
    """Write the commands of sweeps' jobs as those that do them all.

    Parameters
    ----------
    commands : iterable of str
        One a run, ``gapath key=value ...``.

    Returns
    -------
    list of str
        For each experiment ``gapath -m key=value,value ...`` if its jobs are all combinations of
        some values; else its commands, each once.
    """
    by_experiment: dict[str, list[str]] = {}
    for command in sorted(set(commands)):
        words = [word for word in command.split() if word.startswith("experiment=")]
        by_experiment.setdefault(" ".join(words), []).append(command)
    return [line for _, jobs in sorted(by_experiment.items()) for line in _as_sweep(jobs)]


def _as_sweep(commands: list[str]) -> list[str]:
    jobs = [command.split() for command in commands]
    words, combinations = [], 1
    for column in zip(*jobs, strict=False):
        keys = {word.partition("=")[0] for word in column}
        values = {word.partition("=")[2] for word in column}
        if len(set(column)) > 1 and (len(keys) > 1 or any(set(value) & _LISTS for value in values)):
            return commands
        joined = ",".join(sorted(values, key=lambda value: (len(value), value)))
        words.append(column[0] if len(set(column)) == 1 else f"{keys.pop()}={joined}")
        combinations *= len(set(column))
    whole = len({len(job) for job in jobs}) == 1 and combinations == len(jobs) > 1
    return [" ".join([words[0], "-m", *words[1:]])] if whole else commands
