"""The commands behind numbers, written as few as they can be."""

from collections.abc import Iterable

_LISTS = set(",'\"")
"""A value with these would read as several in a sweep, or is part of one."""


def as_sweep(commands: Iterable[str]) -> list[str]:
    """Write the commands of a sweep's jobs as the one that does them all.

    Parameters
    ----------
    commands : iterable of str
        One a run, ``gapath key=value ...``.

    Returns
    -------
    list of str
        ``gapath -m key=value,value ...`` if they are all combinations of some values; else the
        commands, each once.
    """
    commands = sorted(set(commands))
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
