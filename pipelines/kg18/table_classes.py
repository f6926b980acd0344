"""KG18's known maps as classes: the success of each planner over many instances."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.numbers.summary import summarise
from gapath.pipelines.numbers.text import middle, number, percent, percent_range
from gapath.pipelines.page.section import RECONSTRUCTED, Section, Table
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.runs import Run

TASK = "plan"
EXPERIMENT = "classes"
ORDER = 20


def section(trials: pd.DataFrame, runs: Sequence[Run]) -> Section:
    """Make the section on the classes of KG18's known maps.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of Run
        The runs they come from.

    Returns
    -------
    Section
        Success and epochs over the instances of each class.
    """
    rows = over_instances(trials)
    return Section(
        title="The same over classes of maps",
        text=(
            "One reconstructed map could be lucky or unlucky, so each class has many instances "
            "from its seeded generator; the map of Table 1 is the first of them.",
            RECONSTRUCTED,
        ),
        tables=(_table(rows),),
        remarks=(
            "Trials on one instance are not independent evidence about its class, so the interval "
            "counts instances, not trials: Wilson's, with the mean of the instances' rates. Rates "
            "in [0, 1] vary at most as much as coins, so it errs on the wide side.",
        ),
    )


def over_instances(trials: pd.DataFrame) -> pd.DataFrame:
    """Summarise each class of maps and planner over the class's instances.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.

    Returns
    -------
    DataFrame
        map, map_source, planner, instances, n (trials), success (the mean of the instances'
        rates) and its interval over instances, how many instances were always or never
        solved, quartiles of the epochs.
    """
    by = ["map", "map_source", "planner"]
    rows = []
    for key, group in trials.groupby(by):
        rates = group.groupby("map_instance")["feasible"].mean()
        low, high = wilson(float(rates.mean()), len(rates))
        row = summarise(group)
        rows.append(
            {
                **dict(zip(by, key, strict=True)),
                "instances": len(rates),
                "n": len(group),
                "success": rates.mean(),
                "success_low": low,
                "success_high": high,
                "always": int((rates == 1).sum()),
                "never": int((rates == 0).sum()),
                **{name: row[name] for name in ("epochs_median", "epochs_q1", "epochs_q3")},
            }
        )
    rows.sort(key=lambda row: [rank(str(row[name])) for name in by])
    return pd.DataFrame(rows)


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
            "Epochs": middle(row["epochs_median"], row["epochs_q1"], row["epochs_q3"]),
        }
        for _, row in rows.iterrows()
    ]
    return Table(
        "classes",
        "Success over the instances of each class of KG18's known maps: the mean of the instances' "
        "success rates with its 95 % interval over instances; how many instances were solved in "
        "all trials or in none; median (quartiles) of the epochs of all trials.",
        rows,
        pd.DataFrame(shown),
    )
