"""From run folders to one tidy frame, a row for each trial."""

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import pandas as pd
from pandas.api.types import is_bool_dtype, is_numeric_dtype
from tqdm import tqdm

from gapath.errors import InputError, require
from gapath.runfolder import sha256

from .runs import Run, find_runs

TEXT = ("experiment", "map", "map_source", "corner_cutting", "planner", "status")
NUMBERS = (
    "map_instance", "width", "height", "seed", "trial", "cost", "optimal_cost", "optimality_ratio",
    "length", "turns", "clearance", "curvature", "epochs", "evaluations", "expansions",
    "plan_time_s",
)  # fmt: skip
_SETTING = ["experiment", "map", "map_instance", "planner", "seed"]


class Skipped(NamedTuple):
    """A run that no number is made from, and why."""

    run: str
    reason: str


class Collected(NamedTuple):
    """What `collect` gives."""

    frame: pd.DataFrame
    """One row a trial: the columns of ``trials.parquet``, and ``key``."""
    skipped: list[Skipped]


def collect(folder: str | Path) -> Collected:
    """Read the trials of all runs below a folder.

    Of several runs of the same experiment, map, planner and seed (made by other versions, or
    with another number of trials) only the newest counts: pooled, its trials would be
    counted twice.

    Parameters
    ----------
    folder : path
        The folder that holds ``<experiment>/<key>/``.

    Returns
    -------
    frame : DataFrame
        One row a trial, failures included; empty if no run can be used.
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
    frame : DataFrame
        One row a trial.
    skipped : list of Skipped
        The runs that were left out, and why.
    """
    frames, skipped = [], []
    kept, older = _newest(runs)
    skipped += [Skipped(run.name, run.fault) for run in kept if run.fault]
    skipped += [Skipped(run.name, f"older than {new}, of the same setting") for run, new in older]
    for run in tqdm([run for run in kept if not run.fault], "runs", disable=None):
        try:
            frames.append(_trials(run).assign(key=run.folder.name))
        except InputError as error:
            skipped.append(Skipped(run.name, str(error)))
    columns = [*TEXT, *NUMBERS, "feasible", "key"]
    frame = pd.concat(frames, ignore_index=True) if frames else pd.DataFrame(columns=columns)
    return Collected(frame, sorted(skipped))


def _newest(runs: Iterable[Run]) -> tuple[list[Run], list[tuple[Run, str]]]:
    """Split runs into those to read and the superseded ones with the name of their successor."""
    runs = sorted(runs, key=lambda run: (run.date, run.name), reverse=True)
    newest: dict[tuple[object, ...], Run] = {}
    kept, older = [], []
    for run in runs:
        setting = tuple(run.manifest.get(name) for name in _SETTING)
        first = run if run.fault else newest.setdefault(setting, run)
        if first is run:
            kept.append(run)
        else:
            older.append((run, first.name))
    return sorted(kept, key=lambda run: run.name), older


def _trials(run: Run) -> pd.DataFrame:
    """Read ``trials.parquet``; its hash is checked, as every number comes from it."""
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
    missing = sorted({*TEXT, *NUMBERS, "feasible"} - set(trials.columns))
    require(not missing, path.name, f"no column {', '.join(missing)}", "all columns of a trial")
    wrong = [name for name in NUMBERS if not is_numeric_dtype(trials[name])]
    wrong += [] if is_bool_dtype(trials["feasible"]) else ["feasible"]
    require(not wrong, path.name, f"{wrong} of another type", "numbers, and feasible as booleans")
    return trials
