"""The commands behind numbers, written as few as they can be."""

import re
import shlex
from collections.abc import Iterable

_LIST = re.compile(r"\[[^][]*\]")
_QUOTING = re.compile(r"""['"\\]""")
_MANY = 8
"""More values than these are a range, if they are one."""
_SEVERAL = re.compile(r"[,'\"\s]")
"""A value with these outside of a list would read as several in a sweep, or as part of one."""

_MOST = 200
"""A page shows so many commands of a section."""


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
        some values; else its commands, each once, of very many the first and how many follow.
    """
    by_experiment: dict[str, list[str]] = {}
    for command in sorted(set(commands)):
        words = [word for word in command.split() if word.startswith("experiment=")]
        by_experiment.setdefault(" ".join(words), []).append(command)
    lines = [line for _, jobs in sorted(by_experiment.items()) for line in _as_sweep(jobs)]
    more = len(lines) - _MOST
    return lines if more <= 0 else [*lines[:_MOST], f"# and {more} more: each run's manifest.json"]


def _words(command: str) -> list[str]:
    """Split a command as a shell does, which takes a while where it may have quotes."""
    return shlex.split(command) if _QUOTING.search(command) else command.split()


def _as_sweep(commands: list[str]) -> list[str]:
    try:
        jobs = [_words(command) for command in commands]
    except ValueError:  # a manifest was edited: quotes without an end
        return commands
    words, combinations = [], 1
    for column in zip(*jobs, strict=False):
        keys = {word.partition("=")[0] for word in column}
        values = {word.partition("=")[2] for word in column}
        several = any(_SEVERAL.search(_LIST.sub("", value)) for value in values)
        if len(set(column)) > 1 and (len(keys) > 1 or several):
            return commands
        joined = _joined(values)
        words.append(column[0] if len(set(column)) == 1 else f"{keys.pop()}={joined}")
        combinations *= len(set(column))
    whole = len({len(job) for job in jobs}) == 1 and combinations == len(jobs) > 1
    return [shlex.join([words[0], "-m", *words[1:]])] if whole else commands


def _joined(values: set[str]) -> str:
    """Write values as Hydra sweeps over them, many whole numbers on end as their range."""
    ordered = sorted(values, key=lambda value: (len(value), value))
    first, count = ordered[0], len(ordered)
    if count > _MANY and first.isdecimal():
        end = int(first) + count
        if ordered == [str(value) for value in range(int(first), end)]:
            return f"range({first},{end})"
    return ",".join(ordered)
