"""What the runs of the experiment on S04's Table 1 have in common, and what tells them apart."""

from collections.abc import Sequence

import pandas as pd

from gapath.events import Settings
from gapath.pipelines.reading.of_run import of_run
from gapath.running.naming import Method
from gapath.store.records import RunRecord

_OWN: Settings = {"corner_cutting": "no_diagonals"}
"""What the experiment itself sets, whichever planner it tries."""

_FORM = "planner.stop_when_feasible"


def other_changes(run: RunRecord) -> Settings:
    """Give what differs from a planner's YAML, besides what the experiment itself sets.

    Parameters
    ----------
    run : RunRecord
        A run.

    Returns
    -------
    mapping of str to str, int, float, bool or None
        Setting -> value.
    """
    changes = run.known.changes.items()
    return {k: v for k, v in changes if k != _FORM and (k, v) not in _OWN.items()}


def planner_of(run: RunRecord) -> str:
    """Name a run's planner without what the experiment itself sets.

    Parameters
    ----------
    run : RunRecord
        A run.

    Returns
    -------
    str
        "sedighi", or "sedighi[population=50]".
    """
    return Method(run.known.preset, other_changes(run)).name


def with_form(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> pd.DataFrame:
    """Give trials the columns `preset` and `short`, and planners the names of `planner_of`.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    DataFrame
        A copy; `preset` is the name of the planner's YAML, `short` tells whether the run's
        trials end at their first path.
    """
    return trials.assign(
        preset=of_run(trials, runs, lambda run: run.known.preset),
        planner=of_run(trials, runs, planner_of),
        short=of_run(trials, runs, lambda run: bool(run.settings.get(_FORM, False))),
    )
