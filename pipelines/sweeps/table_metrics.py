"""Every path metric of every experiment, map and method."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from gapath.discovery import kinds, load
from gapath.pipelines.numbers.behind import keys_behind
from gapath.pipelines.numbers.text import middle, number
from gapath.pipelines.page.section import ALL, Section, Table
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.sweeps.cells import QUARTILES, quantiles
from gapath.pipelines.sweeps.varied import cases_of
from gapath.store.records import RunRecord
from gapath.task import find_task

TASK = ALL
EXPERIMENT = ALL
ORDER = 100

_ROWS = 1000
"""A page shows so many."""


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
    method, cases = task.groups[0], cases_of(runs)
    modules: dict[str, Any] = {name: load("metric", name) for name in kinds("metric")}
    trials = trials.assign(map=trials["key"].map(cases["place"]))
    by = ["experiment", "map", "map_source", method]
    groups = trials.groupby(by, sort=False, observed=True)
    group, success = groups.ngroup().to_numpy(), trials[task.success].to_numpy(dtype=bool)
    rows = groups.size().reset_index(name="n")
    problems = cases["problem"].reindex(pd.Index(trials["key"])).groupby(group).nunique()
    rows.insert(len(by), "problems", problems)
    rows["succeeded"] = np.bincount(group, success, len(rows)).astype(np.int64)
    for name in modules:
        values = np.where(success, trials[name].to_numpy(dtype=np.float64), np.nan)
        found = quantiles(values, group, len(rows), list(QUARTILES.values()))
        spread = zip(QUARTILES, found, strict=True)
        rows = rows.assign(**{f"{name}_{key}": values for key, values in spread})
    rows = rows.sort_values(by, key=lambda names: names.map(lambda name: rank(str(name))))
    shown = [
        {
            "Experiment": row["experiment"],
            "Map": label(row["map"], row["map_source"]),
            method.capitalize(): label(row[method]),
            "Problems": number(row["problems"]),
            "Trials": number(row["n"]),
            task.success.capitalize(): number(row["succeeded"]),
            **{
                module.TITLE: middle(*(row[f"{name}_{key}"] for key in QUARTILES))
                for name, module in modules.items()
            },
        }
        for row in rows.head(_ROWS).to_dict("records")
    ]
    more = f" The page has {_ROWS} of {len(rows)} rows, the CSV has all."
    table = Table(
        f"metrics_{task.name}",
        f"Median (quartiles) of each metric over the trials that succeeded ({task.success})."
        + (more if len(rows) > _ROWS else ""),
        rows,
        pd.DataFrame(shown),
        heads=3,
        runs=keys_behind(trials, by, rows.head(_ROWS)),
    )
    return Section(
        title=f"Metrics of paths: {task.name}",
        tables=(table,),
        remarks=tuple(
            module.__doc__.partition("\n")[0] for module in modules.values() if module.__doc__
        ),
    )
