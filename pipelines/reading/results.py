"""What a run's trials come to, as sums: those of several runs can be added."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pandas as pd

from gapath.errors import InputError
from gapath.store.records import TRIALS, RunRecord
from gapath.task import columns, find_task

NO_RESULTS = ("seed", "trial", "map_instance")


class Results(NamedTuple):
    """What trials come to."""

    trials: int
    succeeded: int
    counts: Mapping[str, int]
    """For every numeric column of how many trials it is defined."""
    sums: Mapping[str, float]


def results_of(run: RunRecord) -> Results:
    """Sum up a run's trials; raises InputError if they cannot be read."""
    task = find_task(run.known.task)
    try:
        trials = pd.read_parquet(run.folder / TRIALS)
        numeric = [name for name, kind in columns(task.row).items() if kind is not str]
        values = {
            name: trials[name].to_numpy(np.float64)
            for name in numeric
            if name in trials and name not in NO_RESULTS
        }
        succeeded = int(trials[task.success].sum())
    except Exception as error:  # pyarrow raises more kinds than it documents
        raise InputError(TRIALS, type(error).__name__, "readable Parquet") from error
    values = {name: column[~np.isnan(column)] for name, column in values.items()}
    counts = {name: len(column) for name, column in values.items()}
    sums = {name: math.fsum(column) for name, column in values.items()}
    return Results(len(trials), succeeded, counts, sums)
