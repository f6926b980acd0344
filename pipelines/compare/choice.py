"""Which runs stand in which group, and what pairs their trials."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from gapath.errors import InputError, require
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.collect import Skipped, read_trials
from gapath.pipelines.reading.frame import chosen, run_frame
from gapath.pipelines.reading.names import tried_with_contents
from gapath.pipelines.reading.query import near
from gapath.store.records import RunRecord, find_runs
from gapath.store.settings import Value, tabular, written
from gapath.task import Task, find_task

_OWN = ("method", "preset", "experiment", "map", "map_instance", "start", "target", "seed")
"""What `--by` may name besides settings."""

_NAMES = ("method", "preset", "map")
"""Those that the papers have names for, in an order of their own."""


@dataclass(frozen=True)
class Choice:
    """Trials and the groups that they stand in.

    Parameters
    ----------
    task : type
        The task of all of them.
    trials : DataFrame
        One row a trial, with a column for each name in `also`.
    group : Series
        The group of each trial: ordered categories, as people read them.
    also : tuple of str
        Settings that vary within a group, so that trials pair only where these are equal.
    beside : tuple of str
        Settings that differ between the groups besides what was asked for.
    left_out : tuple of Skipped
        Runs that no number is made from, and why.
    versions : tuple of str
        The versions of gapath that made the runs.
    said : tuple of str
        What `gapath.pipelines.numbers.comparing.comparable.comparable` left out, in words.
    """

    task: type[Task]
    trials: pd.DataFrame
    group: pd.Series
    also: tuple[str, ...]
    beside: tuple[str, ...]
    left_out: tuple[Skipped, ...]
    versions: tuple[str, ...]
    said: tuple[str, ...] = ()


def choose(outputs: Path, by: str | None, wheres: Sequence[str]) -> Choice:
    """Read the runs below a folder that are to be compared.

    Parameters
    ----------
    outputs : Path
        The folder that holds ``<experiment>/<key>/``.
    by : str or None
        What tells the groups apart: a setting under its full name, method, or another of `_OWN`.
    wheres : sequence of str
        Conditions (`gapath.pipelines.reading.frame.chosen`): with `by` at most one, that all runs
        fulfil; without, one for each group.

    Returns
    -------
    Choice
        Two groups at least.

    Raises
    ------
    InputError
        If a condition or column is wrong, a group is empty, a run would be in two of them, or
        there is only one group.
    """
    if by is None:
        require(len(wheres) > 1, "compare", f"{len(wheres)} --where and no --by",
                "--by SETTING, or a --where for each of two or more groups")  # fmt: skip
    else:
        require(len(wheres) < 2, "compare", f"--by {by} and {len(wheres)} --where", "one --where "
                "beside --by, its conditions joined by and")  # fmt: skip
    records = find_runs(outputs)
    where_of = _where_of(records, wheres)
    kept = [run for run in records if not wheres or run.folder in where_of]
    trials, skipped, used = read_trials(kept)
    require(bool(used), outputs, f"{len(kept)} runs of which none can be used"
            + "".join(f"; {run}: {reason}" for run, reason in skipped[:1]),
            "a finished run")  # fmt: skip
    if by is None:
        values = {run.folder.name: where_of[run.folder] for run in used}
        for where in wheres:
            require(where in values.values(), "--where", where, "a condition that a run which can "
                    "be used fulfils")  # fmt: skip
        names = list(wheres)
    else:
        facts = {run.folder.name: _facts(run) for run in used}
        columns = list(dict.fromkeys(name for each in facts.values() for name in each))
        require(by in columns, "--by", by, f"a setting of the runs, or one of {', '.join(_OWN)}"
                f"{near(by, columns)}")  # fmt: skip
        lacking = [run for run in used if by not in facts[run.folder.name]]
        skipped += [Skipped(run.name, f"has no {by}") for run in lacking]
        used = [run for run in used if by in facts[run.folder.name]]
        found = _in_order({facts[run.folder.name][by] for run in used}, by)
        names = list(dict.fromkeys(_shown(each, by) for each in found))
        values = {run.folder.name: _shown(facts[run.folder.name][by], by) for run in used}
        only = f"{len(used)} runs, all of {names[0]}"
        require(len(names) > 1, "--by", f"{by}: {only}", "two values or more")
    tasks = sorted({run.known.task for run in used})
    require(len(tasks) == 1, "task", ", ".join(tasks), "runs of one task; choose it by --where "
            "\"task='plan'\"")  # fmt: skip
    return _choice(used, trials[tasks[0]], (by, values, names), sorted(skipped))


def _choice(
    used: Sequence[RunRecord],
    trials: pd.DataFrame,
    groups: tuple[str | None, Mapping[str, str], Sequence[str]],
    left_out: Sequence[Skipped],
) -> Choice:
    by, values, names = groups
    settings = {run.folder.name: tried_with_contents(run) for run in used}
    varying = _varying(settings.values())
    mine: dict[str, list[Mapping[str, Value]]] = {each: [] for each in names}
    for run in used:
        mine[values[run.folder.name]].append(settings[run.folder.name])
    within = {setting for each in mine.values() for setting in _varying(each)}
    also = tuple(setting for setting in varying if setting in within)
    method = by in ("method", "preset")
    asked = [by] if by else [each for each in varying if _mentioned(each, names)]
    beside = tuple(
        setting for setting in varying if not (method or setting in within or setting in asked)
    )
    trials = trials[trials["key"].isin(list(settings))]
    keys = trials["key"]
    trials = trials.assign(
        **{
            setting: keys.map({key: each.get(setting) for key, each in settings.items()})
            for setting in also
        }
    )
    group = keys.map(values).astype(pd.CategoricalDtype(names, ordered=True))
    versions = sorted({str(run.known.versions.get("gapath", "?")) for run in used})
    return Choice(find_task(used[0].known.task), trials, group, also, beside, tuple(left_out),
                  tuple(versions))  # fmt: skip


def _where_of(records: Sequence[RunRecord], wheres: Sequence[str]) -> dict[Path, str]:
    """Give each run the condition that it fulfils, of those that fulfil one."""
    if not wheres:
        return {}
    frame = run_frame(records).reset_index()  # a run is its place: a copy has the same key
    found: dict[Path, str] = {}
    for where in wheres:
        try:
            places = chosen(frame, where).index
        except InputError as error:
            raise InputError("--where", error.value, error.expected) from error
        require(len(places) > 0, "--where", where, "a condition that a run fulfils")
        for run in (records[place] for place in places):
            other = found.setdefault(run.folder, where)
            if other is not where:
                raise InputError("--where", f"{run.name} in two groups, {other} and {where}",
                                 "a run in one group only")  # fmt: skip
    return found


def _facts(run: RunRecord) -> dict[str, Any]:
    """Give what may tell runs apart: as `run_frame` calls it."""
    known = vars(run.known)
    return {**tabular(run.settings), **{name: known[name] for name in _OWN}}


def _in_order(values: set[Any], by: str) -> list[Any]:
    if by in _NAMES:
        return sorted(values, key=lambda value: rank(str(value)))
    return sorted(
        values,
        key=lambda value: (value is None, isinstance(value, str), 0 if value is None else value),
    )


def _shown(value: Any, by: str) -> str:
    if by in _NAMES:
        return label(str(value))
    return f"{value:.12g}" if isinstance(value, float) else written(value)


def _mentioned(setting: str, wheres: Sequence[str]) -> bool:
    """Tell whether conditions name a setting, as SQL does in letters of any size."""
    name = re.compile(rf"(?<![\w.]){re.escape(setting)}(?![\w.])", re.IGNORECASE)
    return any(name.search(where) for where in wheres)


def _varying(settings: Any) -> list[str]:
    """Give the settings that differ, or are not everywhere."""
    settings = list(settings)
    names = dict.fromkeys(name for each in settings for name in each)
    return [name for name in names if len({str(each.get(name)) for each in settings}) > 1]
