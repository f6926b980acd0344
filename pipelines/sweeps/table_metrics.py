"""Every path metric of every experiment, map and method."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from gapath.discovery import kinds, load
from gapath.pipelines.numbers.grouped import Groups
from gapath.pipelines.numbers.summary import summarise_by
from gapath.pipelines.numbers.text import middle, number
from gapath.pipelines.page.section import ALL, Section, Table
from gapath.pipelines.papers.names import label
from gapath.pipelines.reading.of_run import of_run
from gapath.pipelines.sweeps.varied import cases_of
from gapath.store.records import RunRecord
from gapath.task import find_task

TASK = ALL
EXPERIMENT = ALL
ORDER = 100

_CELL = ("median", "q1", "q3")


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

    def measure(trials: pd.DataFrame, groups: Groups) -> dict[str, Any]:
        succeeded = trials[task.success].to_numpy(dtype=np.bool_)
        row: dict[str, Any] = {"problems": groups.distinct(trials["problem"])}
        row |= {"n": groups.sizes, "succeeded": groups.counts(succeeded)}
        for name in modules:
            quartiles = groups.quartiles(np.where(succeeded, trials[name], np.nan))
            row |= {f"{name}_{key}": getattr(quartiles, key) for key in _CELL}
        return row

    by = ["experiment", "map", "map_source", method]
    cases = cases_of(runs)
    places, problems = cases["place"].to_dict(), cases["problem"].to_dict()
    trials = trials.assign(
        map=of_run(trials, runs, lambda run: places[run.folder.name]),
        problem=of_run(trials, runs, lambda run: problems[run.folder.name]),
    )
    rows = summarise_by(trials, by, measure)
    shown = [
        {
            "Experiment": row["experiment"],
            "Map": label(row["map"], row["map_source"]),
            method.capitalize(): label(row[method]),
            "Problems": number(row["problems"]),
            "Trials": number(row["n"]),
            task.success.capitalize(): number(row["succeeded"]),
            **{
                module.TITLE: middle(*(row[f"{name}_{key}"] for key in _CELL))
                for name, module in modules.items()
            },
        }
        for row in rows.to_dict("records")
    ]
    table = Table(
        f"metrics_{task.name}",
        f"Median (quartiles) of each metric over the trials that succeeded ({task.success}).",
        rows,
        pd.DataFrame(shown),
        heads=3,
    ).with_runs(trials, by)
    return Section(
        title=f"Metrics of paths: {task.name}",
        tables=(table,),
        remarks=tuple(
            module.__doc__.partition("\n")[0] for module in modules.values() if module.__doc__
        ),
    )
