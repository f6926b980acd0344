"""From run folders to two tidy frames: a row for each planning query, a row for each drive."""

import json
import math
from collections.abc import Callable, Iterable
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd
from pandas.api.types import is_bool_dtype, is_numeric_dtype
from tqdm import tqdm

from gapath.driving.row import DriveRow
from gapath.errors import InputError, require
from gapath.pipelines.reading.runs import Run, find_runs
from gapath.store.runfolder import sha256
from gapath.tasks.plan import PlanRow

_ROWS: dict[str, type[Any]] = {"plan": PlanRow, "drive": DriveRow}
"""The rows of each task."""

_LATER = {"start": "", "target": "", "line_length": math.nan, "stage_times_s": "{}"}
"""Columns that the rows of older runs lack, and what stands there."""

_CHECKS: dict[Any, tuple[Callable[[pd.Series], bool], str]] = {
    int: (is_numeric_dtype, "numbers"),
    float: (is_numeric_dtype, "numbers"),
    bool: (is_bool_dtype, "booleans"),
}


class Skipped(NamedTuple):
    """A run that no number is made from, and why."""

    run: str
    reason: str


class Collected(NamedTuple):
    """What `collect` gives."""

    plans: pd.DataFrame
    """One row a planning query: the columns of ``trials.parquet``, and ``key``."""
    drives: pd.DataFrame
    """One row a drive, likewise."""
    skipped: list[Skipped]


def collect(folder: str | Path) -> Collected:
    """Read the trials of all runs below a folder.

    Of several runs of the same experiment, map, method and seed (made by other versions, or
    with another number of trials) only the newest counts: pooled, its trials would be
    counted twice.

    Parameters
    ----------
    folder : path
        The folder that holds ``<experiment>/<key>/``.

    Returns
    -------
    plans, drives : DataFrame
        One row a trial, failures included; empty if no run of the task can be used.
    skipped : list of Skipped
        The runs that were left out, and why.

    Raises
    ------
    InputError
        If there is no such folder, or no run in it.
    """
    return read_trials(find_runs(Path(folder)))


def read_trials(runs: Iterable[Run]) -> Collected:
    """Read the trials of runs, as `collect` does of a folder's.

    Parameters
    ----------
    runs : iterable of Run
        The runs.

    Returns
    -------
    plans, drives : DataFrame
        One row a trial.
    skipped : list of Skipped
        The runs that were left out, and why.
    """
    frames: dict[str, list[pd.DataFrame]] = {task: [] for task in _ROWS}
    skipped = []
    kept, older = _newest(runs)
    skipped += [Skipped(run.name, run.fault) for run in kept if run.fault]
    skipped += [Skipped(run.name, f"older than {new}, of the same setting") for run, new in older]
    for run in tqdm([run for run in kept if not run.fault], "runs", disable=None):
        try:
            frames[run.task].append(_trials(run))
        except InputError as error:
            skipped.append(Skipped(run.name, str(error)))
    plans, drives = (_joined(task, frames[task]) for task in ("plan", "drive"))
    return Collected(plans, drives, sorted(skipped))


def _joined(task: str, frames: list[pd.DataFrame]) -> pd.DataFrame:
    if frames:
        return pd.concat(frames, ignore_index=True)
    return pd.DataFrame(columns=[*(field.name for field in fields(_ROWS[task])), "key"])


def _newest(runs: Iterable[Run]) -> tuple[list[Run], list[tuple[Run, str]]]:
    """Split runs into those to read and the superseded ones with the name of their successor."""
    runs = sorted(runs, key=lambda run: (run.date, run.name), reverse=True)
    newest: dict[str, Run] = {}
    kept, older = [], []
    for run in runs:
        first = run if run.fault else newest.setdefault(run.setting, run)
        if first is run:
            kept.append(run)
        else:
            older.append((run, first.name))
    return sorted(kept, key=lambda run: run.name), older


def _trials(run: Run) -> pd.DataFrame:
    """Read ``trials.parquet``; its hash is checked, as every number comes from it."""
    kind = _ROWS[run.task]
    path = run.folder / "trials.parquet"
    expected = run.manifest["files"][path.name].get("sha256")
    try:
        found = sha256(path)
        require(found == expected, path.name, f"SHA-256 {found[:12]}", f"{str(expected)[:12]}, as "
                "the manifest says")  # fmt: skip
        trials = pd.read_parquet(path)
    except InputError:
        raise
    except Exception as error:  # pyarrow raises more kinds than it documents
        raise InputError(path.name, type(error).__name__, "readable Parquet") from error
    trials = trials.assign(**{name: v for name, v in _LATER.items() if name not in trials})
    missing = sorted({field.name for field in fields(kind)} - set(trials.columns))
    require(not missing, path.name, f"no column {', '.join(missing)}", "all columns of a trial")
    for field in fields(kind):
        if field.type in _CHECKS:
            fits, what = _CHECKS[field.type]
            require(fits(trials[field.name]), f"{path.name}, {field.name}", "another type", what)
    if "stage_times_s" in trials:
        _check_stages(path, trials["stage_times_s"])
    return trials.assign(key=run.folder.name)


def _check_stages(path: Path, texts: pd.Series) -> None:
    try:
        stages = [json.loads(text) for text in texts.unique()]
    except (TypeError, ValueError) as error:
        raise InputError(f"{path.name}, stage_times_s", "no JSON", "stages and seconds") from error
    good = all(isinstance(each, dict) for each in stages)
    require(good, f"{path.name}, stage_times_s", "no mapping", "stages and seconds")
