"""Every path metric of every experiment, map and method."""

from collections.abc import Sequence
from typing import Any

import pandas as pd

from gapath.discovery import kinds, load
from gapath.pipelines.numbers.summary import summarise_by
from gapath.pipelines.numbers.text import middle, number
from gapath.pipelines.page.section import ALL, Section, Table
from gapath.pipelines.papers.names import label
from gapath.store.records import RunRecord
from gapath.task import find_task

TASK = ALL
EXPERIMENT = ALL
ORDER = 100

_QUARTILES = {"median": 0.5, "q1": 0.25, "q3": 0.75}


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section:
    """Make the section on the metrics of a task's paths.

    Parameters
    ----------
    trials : DataFrame
        The trials of a task.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section
        A row for each experiment, map and method.
    """
    task = find_task(runs[0].known.task)
    method = task.groups[0]
    modules: dict[str, Any] = {name: load("metric", name) for name in kinds("metric")}

    def measure(group: pd.DataFrame) -> dict[str, float]:
        paths = group.loc[group[task.success], list(modules)].astype(float)
        levels = {key: paths.quantile(level) for key, level in _QUARTILES.items()}
        spread = {f"{name}_{key}": levels[key][name] for name in modules for key in _QUARTILES}
        return {"n": len(group), "succeeded": len(paths), **spread}

    by = ["experiment", "map", "map_source", method]
    rows = summarise_by(trials, by, measure)
    instances = trials.groupby(by)["map_instance"].nunique()
    rows.insert(len(by), "instances", [instances[tuple(row)] for row in rows[by].to_numpy()])
    shown = [
        {
            "Experiment": row["experiment"],
            "Map": label(row["map"], row["map_source"]),
            method.capitalize(): label(row[method]),
            "Instances": number(row["instances"]),
            "Trials": number(row["n"]),
            task.success.capitalize(): number(row["succeeded"]),
            **{
                module.TITLE: middle(*(row[f"{name}_{key}"] for key in _QUARTILES))
                for name, module in modules.items()
            },
        }
        for _, row in rows.iterrows()
    ]
    table = Table(
        f"metrics_{task.name}",
        f"Median (quartiles) of each metric over the trials that succeeded ({task.success}).",
        rows,
        pd.DataFrame(shown),
        heads=3,
    )
    return Section(
        title=f"Metrics of paths: {task.name}",
        tables=(table.with_runs(trials, by),),
        remarks=tuple(
            module.__doc__.partition("\n")[0] for module in modules.values() if module.__doc__
        ),
    )
