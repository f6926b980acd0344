"""What trials have from their run."""

from collections.abc import Callable, Sequence
from typing import Any

import pandas as pd

from gapath.store.records import RunRecord


def of_run(
    trials: pd.DataFrame, runs: Sequence[RunRecord], tell: Callable[[RunRecord], Any]
) -> pd.Series:
    """Give each trial something of its run.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the column `key`.
    runs : sequence of RunRecord
        The runs they come from.
    tell : callable
        Tells it of a run.

    Returns
    -------
    Series
        A value a trial, in the frame's order; text as such, never as categories.
    """
    codes, keys = pd.factorize(trials["key"])
    known = {run.folder.name: run for run in runs}
    told = pd.Series([tell(known[key]) for key in keys])
    return told.iloc[codes].set_axis(trials.index)
