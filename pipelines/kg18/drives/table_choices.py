"""What the paper leaves open: one decision of KG18's drive varied at a time."""

import re
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import pandas as pd

from gapath.events import Settings
from gapath.pipelines.numbers.grouped import Groups
from gapath.pipelines.numbers.summary import over_instances
from gapath.pipelines.numbers.text import middle, number, percent, percent_range
from gapath.pipelines.page.section import Section, Table
from gapath.pipelines.papers.names import label
from gapath.store.records import Manifest, RunRecord

TASK = "drive"
EXPERIMENT = "drive_choices"
ORDER = 80

_DECISIONS = {
    "drive.sensor.range": "Sensor range, layers",
    "drive.sensor.occlusion": "Obstacles hide what lies behind",
    "corner_cutting": "Corner cutting",
    "navigator.explore_interval": "B's interval, fields",
    "navigator.return_penalty": "Penalty on the way back, A",
    "navigator.replan.min_epochs": "Least epochs, C",
    **{f"navigator.{part}.sampling": "Way points per" for part in ("retreat", "explore", "replan")},
}
"""What people read for a setting; one of another name is shown by that."""

_PRESETS = {
    "kg18_fast": {"Least epochs, C": "3"},
    "kg18_astar": {"Last planner, C": "A*"},
}
"""What KG18's presets change in it."""

_VALUES = {"True": "yes", "False": "no", "one_side": "not between two", "forbid": "forbidden"}


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section:
    """Make the section on the decisions that the paper leaves open.

    Parameters
    ----------
    trials : DataFrame
        The drives of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section
        A row a decision, the one without any first.
    """
    methods = {run.known.method: run.known for run in runs}
    tables = tuple(
        _table(group, str(name), source, methods)
        for (name, source), group in trials.groupby(["map", "map_source"], sort=True)
    )
    return Section(
        title="What the paper leaves open",
        text=(
            "Each row changes one decision of KG18's drive and leaves the others as they are; the "
            "first changes none. Instances and random streams are the same in all rows.",
        ),
        tables=tables,
        remarks=(
            "The interval counts instances, not drives, and is of each row by itself. As the rows "
            "share their instances, better and worse than in the first row says more: how many "
            "instances were reached in more, or in fewer, of their drives.",
        ),
    )


def varied(preset: str, changes: Settings) -> dict[str, str]:
    """Tell what differs from KG18 as described.

    Parameters
    ----------
    preset : str
        Name of the navigator's YAML.
    changes : mapping of str to str, int, float, bool or None
        What differs from the YAML.

    Returns
    -------
    dict of str to str
        Decision -> value; none for "kg18". Planners of a list are taken together.
    """
    changed = dict(_PRESETS.get(preset, {} if preset == "kg18" else {"Navigator": label(preset)}))
    for setting, value in sorted(changes.items()):
        name = re.sub(r"\[\d+\]", "", setting)
        changed[_DECISIONS.get(name, name)] = _VALUES.get(str(value), str(value))
    return changed


def _table(trials: pd.DataFrame, name: str, source: str, methods: Mapping[str, Manifest]) -> Table:
    groups = dict(list(trials.groupby("navigator", sort=True)))
    base = min(groups, key=lambda navigator: (navigator != "kg18", navigator))
    reference = _rates(groups[base])
    rows = []
    for navigator, group in groups.items():
        known = methods[navigator]
        changes = varied(known.preset, known.changes)
        reached = over_instances(group, Groups.one(len(group)), "reached", "reached")
        del reached["always"], reached["never"]
        change = (_rates(group) - reference).dropna()
        ratio = group.groupby("map_instance")["steps_ratio"].median()
        row = {
            "navigator": navigator,
            "decision": "; ".join(changes) or "as described",
            "value": "; ".join(dict.fromkeys(changes.values())),
            **{key: values[0].item() for key, values in reached.items()},
            "better": int((change > 0).sum()),
            "worse": int((change < 0).sum()),
            "calls_a": group["calls_a"].mean(),
            "calls_b": group["calls_b"].mean(),
            "calls_c": group["calls_c"].mean(),
        }
        kinds = (("steps_ratio", ratio), ("seconds", group["compute_time_s"]))
        for (kind, values), (key, level) in product(
            kinds, (("median", 0.5), ("q1", 0.25), ("q3", 0.75))
        ):
            row[f"{kind}_{key}"] = values.quantile(level)
        rows.append(row)
    rows.sort(key=lambda row: (row["navigator"] != base, row["decision"], _order(row["value"])))
    data = pd.DataFrame(rows)
    return Table(
        f"drive_choices_{name}",
        f"{label(name, source)}: one decision at a time, over the instances of the class. Reached: "
        "the mean of the instances' rates with its 95 % Wilson interval over instances. Better and "
        "worse: instances reached in more, or in fewer, of their drives than in the first row. "
        "Planner calls: means. Steps / shortest: median (quartiles) of the instances' medians; "
        "computing time: of all drives.",
        data,
        pd.DataFrame([_shown(row) for row in rows]),
        sortable=False,  # rows are held against the first
    ).with_runs(trials, ["navigator"])


def _shown(row: dict[str, Any]) -> dict[str, str]:
    return {
        "Decision": row["decision"],
        "Value": row["value"],
        "Instances": number(row["instances"]),
        "Drives": number(row["n"]),
        "Reached, %": percent(row["reached"]),
        "95 % interval over instances": percent_range((row["reached_low"], row["reached_high"])),
        "Better": number(row["better"]),
        "Worse": number(row["worse"]),
        "Steps / shortest": middle(*(row[f"steps_ratio_{key}"] for key in ("median", "q1", "q3"))),
        **{f"Calls in {part.upper()}": number(row[f"calls_{part}"]) for part in "abc"},
        "Time, ms": middle(*(1000 * row[f"seconds_{key}"] for key in ("median", "q1", "q3"))),
    }


def _rates(trials: pd.DataFrame) -> pd.Series:
    return trials.groupby("map_instance")["reached"].mean()


def _order(value: str) -> tuple[float, str]:
    """Sort numbers as such, before words."""
    try:
        return float(value), value
    except ValueError:
        return float("inf"), value
