"""KG18's known maps as classes: the success of each planner over many instances."""

from collections.abc import Sequence
from typing import Any

import pandas as pd

from gapath.pipelines.numbers.grouped import Groups
from gapath.pipelines.numbers.summary import over_instances, summarise, summarise_by
from gapath.pipelines.numbers.text import middle, number, percent, percent_range
from gapath.pipelines.page.section import RECONSTRUCTED, Section, Table
from gapath.pipelines.papers.names import label
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "classes"
ORDER = 20


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section:
    """Make the section on the classes of KG18's known maps.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section
        Success and epochs over the instances of each class.
    """
    by = ["map", "map_source", "planner"]
    rows = summarise_by(trials, by, summarise_class)
    return Section(
        title="The same over classes of maps",
        text=(
            "One reconstructed map could be lucky or unlucky, so each class has many instances "
            "from its seeded generator; the map of Table 1 is the first of them.",
            RECONSTRUCTED,
        ),
        tables=(_table(rows).with_runs(trials, by),),
        remarks=(
            "Trials on one instance are not independent evidence about its class, so the interval "
            "counts instances, not trials: Wilson's, with the mean of the instances' rates. Rates "
            "in [0, 1] vary at most as much as coins, so it errs on the wide side.",
        ),
    )


def summarise_class(trials: pd.DataFrame, groups: Groups) -> dict[str, Any]:
    """Summarise planners' trials over the instances of classes.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.
    groups : Groups
        The class and planner of each.

    Returns
    -------
    dict
        What `over_instances` gives, success being the rate; quartiles of epochs and found_epochs.
    """
    row = summarise(trials, groups)
    epochs = {
        f"{name}_{key}": row[f"{name}_{key}"]
        for name in ("epochs", "found_epochs")
        for key in ("median", "q1", "q3")
    }
    return over_instances(trials, groups, "feasible", "success") | epochs


def _table(rows: pd.DataFrame) -> Table:
    shown = [
        {
            "Class": label(row["map"], row["map_source"]),
            "Planner": label(row["planner"]),
            "Instances": number(row["instances"]),
            "Trials": number(row["n"]),
            "Found, %": percent(row["success"]),
            "95 % interval over instances": percent_range(
                (row["success_low"], row["success_high"])
            ),
            "Always solved": number(row["always"]),
            "Never solved": number(row["never"]),
            **{
                title: middle(*(row[f"{name}_{key}"] for key in ("median", "q1", "q3")))
                for title, name in (("Epochs", "epochs"), ("Epochs, if found", "found_epochs"))
            },
        }
        for _, row in rows.iterrows()
    ]
    return Table(
        "classes",
        "Success over the instances of each class of KG18's known maps: the mean of the instances' "
        "success rates with its 95 % interval over instances; how many instances were solved in "
        "all trials or in none; median (quartiles) of the epochs of all trials, and of "
        "those that found a path.",
        rows,
        pd.DataFrame(shown),
    )
