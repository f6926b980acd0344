"""KG18's unknown maps as classes: drives over many instances, and where they fail."""

from collections.abc import Sequence
from typing import Any

import pandas as pd

from gapath.pipelines.numbers.drive_summary import summarise_drives
from gapath.pipelines.numbers.grouped import Groups
from gapath.pipelines.numbers.summary import over_instances, summarise_by
from gapath.pipelines.numbers.text import middle, number, percent, percent_range
from gapath.pipelines.page.section import RECONSTRUCTED, Section, Table
from gapath.pipelines.papers.names import label, rank
from gapath.store.records import RunRecord

TASK = "drive"
EXPERIMENT = "drive_classes"
ORDER = 70

_BY = ["map", "map_source", "navigator"]


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section:
    """Make the section on the classes of KG18's unknown maps.

    Parameters
    ----------
    trials : DataFrame
        The drives of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section
        How many reached the target over each class, and the instances on which drives failed.
    """
    failures = failing_instances(trials)
    return Section(
        title="The same over classes of unknown maps",
        text=(
            "One reconstructed map could be lucky or unlucky, so each class has many instances "
            "from its seeded generator; the map of the tables above is the first of them.",
            RECONSTRUCTED,
        ),
        tables=(
            _classes(trials).with_runs(trials, _BY),
            *(
                [_failures(failures).with_runs(trials, [*_BY, "map_instance"])]
                if len(failures)
                else []
            ),
        ),
        remarks=(
            "Drives on one instance are not independent evidence about its class, so the interval "
            "counts instances, not drives: Wilson's, with the mean of the instances' rates.",
            _where(failures),
        ),
    )


def summarise_class(trials: pd.DataFrame, groups: Groups) -> dict[str, Any]:
    """Summarise navigators' drives over the instances of classes.

    Parameters
    ----------
    trials : DataFrame
        One row a drive.
    groups : Groups
        The class and navigator of each.

    Returns
    -------
    dict
        What `over_instances` gives, reached being the rate; quartiles of steps / shortest and of
        the seconds.
    """
    row = over_instances(trials, groups, "reached", "reached")
    for name, column in (("steps_ratio", "steps_ratio"), ("seconds", "compute_time_s")):
        quartiles = groups.quartiles(trials[column])._asdict()
        row |= {f"{name}_{key}": values for key, values in quartiles.items()}
    return row


def failing_instances(trials: pd.DataFrame) -> pd.DataFrame:
    """List the instances on which not every drive reached the target.

    Parameters
    ----------
    trials : DataFrame
        One row a drive.

    Returns
    -------
    DataFrame
        map, map_source, navigator, map_instance and the columns of `summarise_drives`.
    """
    rows = summarise_by(trials, [*_BY, "map_instance"], summarise_drives)
    failed = rows[rows["reached"] < rows["n"]]
    order = [(rank(row["map"]), rank(row["navigator"])) for _, row in failed.iterrows()]
    failed = failed.assign(order=order).sort_values(["order", "map_instance"], kind="stable")
    return failed.drop(columns="order")


def _classes(trials: pd.DataFrame) -> Table:
    rows = summarise_by(trials, _BY, summarise_class)
    shown = [
        {
            "Class": label(row["map"], row["map_source"]),
            "Navigator": label(row["navigator"]),
            "Instances": number(row["instances"]),
            "Drives": number(row["n"]),
            "Reached, %": percent(row["reached"]),
            "95 % interval over instances": percent_range(
                (row["reached_low"], row["reached_high"])
            ),
            "Always reached": number(row["always"]),
            "Never reached": number(row["never"]),
            "Steps / shortest": middle(
                row["steps_ratio_median"], row["steps_ratio_q1"], row["steps_ratio_q3"]
            ),
            "Time, ms": middle(*(1000 * row[f"seconds_{key}"] for key in ("median", "q1", "q3"))),
        }
        for _, row in rows.iterrows()
    ]
    return Table(
        "drive_classes",
        "Drives over the instances of each class of KG18's unknown maps: the mean of the "
        "instances' rates with its 95 % interval over instances; how many instances were reached "
        "in all drives or in none; median (quartiles) of steps / shortest of the drives that "
        "reached the target, and of the computing time of all.",
        rows,
        pd.DataFrame(shown),
    )


def _failures(rows: pd.DataFrame) -> Table:
    shown = [
        {
            "Class": label(row["map"], row["map_source"]),
            "Navigator": label(row["navigator"]),
            "Instance": number(row["map_instance"]),
            "Drives": number(row["n"]),
            "Reached": number(row["reached"]),
            "Returned": number(row["returned"]),
            "Overran": number(row["overran"]),
            "Calls in A": number(row["calls_a"]),
            "Steps": middle(row["steps_median"], row["steps_q1"], row["steps_q3"]),
        }
        for _, row in rows.iterrows()
    ]
    return Table(
        "drive_failures",
        "Every instance on which not all drives reached the target: how they ended, mean calls in "
        "part A, and median (quartiles) of the steps of all drives.",
        rows,
        pd.DataFrame(shown),
    )


def _where(failures: pd.DataFrame) -> str:
    kg18 = failures[failures["navigator"] == "kg18"]
    if kg18.empty:
        return "KG18 reached the target in every drive on every instance."
    counts = kg18.groupby("map").size()
    text = ", ".join(
        f"{count} of {label(str(name)).lower()}"
        for name, count in sorted(counts.items(), key=lambda item: rank(str(item[0])))
    )
    text = f"Instances on which a drive of KG18 failed: {text}"
    returns = kg18["returned"]
    if len(returns) > 2 and returns.any():
        share = returns.nlargest(2).sum() / returns.sum()
        text += f"; the two worst make {percent(share)} % of its returns"
    return f"{text}."
