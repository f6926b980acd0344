"""From run folders to tidy frames, one for each task: a row a trial."""

import json
import math
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import pandas as pd
from pandas.api.types import is_bool_dtype, is_numeric_dtype
from tqdm import tqdm

from gapath.discovery import kinds
from gapath.errors import InputError, require
from gapath.pipelines.reading.counted import superseded
from gapath.pipelines.reading.names import told_apart
from gapath.store.records import CONFIG, TRIALS, RunRecord
from gapath.store.runfolder import RunFolder
from gapath.task import columns, find_task, metrics

_CHECKS: dict[type, tuple[Callable[[pd.Series], bool], str]] = {
    int: (is_numeric_dtype, "numbers"),
    float: (is_numeric_dtype, "numbers"),
    bool: (is_bool_dtype, "booleans"),
}


class Skipped(NamedTuple):
    """A run that no number is made from, and why."""

    run: str
    reason: str


class Collected(NamedTuple):
    """What `read_trials` gives."""

    trials: dict[str, pd.DataFrame]
    """For each task one row a trial: the columns of ``trials.parquet``, and `key`, the name of
    the run's folder."""
    skipped: list[Skipped]
    runs: list[RunRecord]
    """The runs that they come from, under names that tell them apart."""


def read_trials(runs: Iterable[RunRecord]) -> Collected:
    """Read the trials of runs.

    Of several runs of one setting only one counts (`superseded`).

    Parameters
    ----------
    runs : iterable of RunRecord
        The runs.

    Returns
    -------
    trials : dict of str to DataFrame
        Task -> one row a trial, failures included; empty if no run of the task can be used.
    skipped : list of Skipped
        The runs that were left out, and why.
    runs : list of RunRecord
        The runs that the trials come from, under names that tell them apart.
    """
    frames: dict[str, list[pd.DataFrame]] = {task: [] for task in kinds("task")}
    used: list[RunRecord] = []
    skipped: list[Skipped] = []
    runs = sorted(runs, key=lambda run: run.name)
    older = superseded(runs)
    skipped += [Skipped(run.name, run.fault) for run in runs if run.fault]
    skipped += [Skipped(run.name, f"{new.name} counts, of the same setting") for run, new in older]
    left_out = {each.run for each in skipped}
    for run in tqdm([run for run in runs if run.name not in left_out], "runs", disable=None):
        try:
            frames[run.known.task].append(_trials(run))
            used.append(run)
        except InputError as error:
            skipped.append(Skipped(run.name, str(error)))
    used = told_apart(used)
    trials = {task: _joined(task, mine, used) for task, mine in frames.items()}
    return Collected(trials, sorted(skipped), used)


def _joined(task: str, frames: list[pd.DataFrame], runs: Sequence[RunRecord]) -> pd.DataFrame:
    if not frames:
        return pd.DataFrame(columns=[*columns(find_task(task).row), "key"])
    trials = pd.concat(frames, ignore_index=True)
    known = {run.folder.name: run.known for run in runs}
    names = {"map": "map", find_task(task).groups[0]: "method"}
    return trials.assign(
        **{
            column: trials["key"].map({key: getattr(each, name) for key, each in known.items()})
            for column, name in names.items()
        }
    )


def _trials(run: RunRecord) -> pd.DataFrame:
    """Read ``trials.parquet``; its hash is checked, as every number comes from it."""
    expected = run.known.files[TRIALS].sha256
    try:
        found = RunFolder(run.folder).sha256(TRIALS)
        require(found == expected, TRIALS, f"SHA-256 {found[:12]}", f"{expected[:12]}, as the "
                "manifest says")  # fmt: skip
        trials = pd.read_parquet(run.folder / TRIALS)
    except InputError:
        raise
    except Exception as error:  # pyarrow raises more kinds than it documents
        raise InputError(TRIALS, type(error).__name__, "readable Parquet") from error
    # A metric that was added since, by a package perhaps, is missing; the run is still good.
    trials = trials.assign(**{name: math.nan for name in metrics() if name not in trials})
    types = columns(find_task(run.known.task).row)
    missing = sorted(set(types) - set(trials.columns))
    require(not missing, TRIALS, f"no column {', '.join(missing)}", "all columns of a trial")
    for name, kind in types.items():
        if kind in _CHECKS:
            fits, what = _CHECKS[kind]
            require(fits(trials[name]), f"{TRIALS}, {name}", "another type", what)
    if "stage_times_s" in trials:
        _check_stages(trials["stage_times_s"])
    require(bool(run.settings), CONFIG, "nothing", "settings")  # sections rely on them
    return trials.assign(key=run.folder.name)


def _check_stages(texts: pd.Series) -> None:
    try:
        stages = [json.loads(text) for text in texts.unique()]
    except (TypeError, ValueError) as error:
        raise InputError(f"{TRIALS}, stage_times_s", "no JSON", "stages and seconds") from error
    good = all(isinstance(each, dict) for each in stages)
    require(good, f"{TRIALS}, stage_times_s", "no mapping", "stages and seconds")
