"""What the runs of the experiment on S04's Table 1 have in common, and what tells them apart."""

import pandas as pd

from gapath.components import yaml_values
from gapath.pipelines.papers.names import join, split
from gapath.pipelines.papers.s04 import PLANNERS


def planner_and_form(name: str) -> tuple[str, bool]:
    """Name a planner without what the experiment itself sets.

    Parameters
    ----------
    name : str
        Of a planner, as in the runs.

    Returns
    -------
    planner : str
        With what differs otherwise: "sedighi", or "sedighi[population=50]".
    short : bool
        Whether its runs end at their first path.
    """
    base, changes = split(name)
    usual = yaml_values("planner", base) if base in PLANNERS else {}
    short = changes.pop("stop_when_feasible", str(usual.get("stop_when_feasible", False)))
    if changes.get("corner_cutting") == "no_diagonals":
        del changes["corner_cutting"]
    return join(base, changes), short == "True"


def with_form(trials: pd.DataFrame) -> pd.DataFrame:
    """Give trials a column `short`, and planners the names of `planner_and_form`.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.

    Returns
    -------
    DataFrame
        A copy.
    """
    forms = {name: planner_and_form(name) for name in trials["planner"].unique()}
    planner = trials["planner"].map({name: form[0] for name, form in forms.items()})
    short = trials["planner"].map({name: form[1] for name, form in forms.items()})
    return trials.assign(planner=planner, short=short.astype(bool))
