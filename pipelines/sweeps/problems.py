"""The problems of a map one by one: instances, or pairs of start and target."""

import math

import pandas as pd

from gapath.pipelines.numbers.text import number
from gapath.pipelines.page.section import Table
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.sweeps.view import View, rounded, text

_ROWS = 30
"""A page shows so many problems."""
_METHODS = 6
"""Each of so many methods has a column."""


def problems_table(view: View) -> list[Table]:
    """List problems one by one where a map has several.

    Parameters
    ----------
    view : View
        A sweep.

    Returns
    -------
    list of Table
        None, or one: for each problem and method the numbers, for people the problems that
        were solved least often.
    """
    if view.cells["problems"].max() == 1:
        return []
    data = _by_problem(view)
    names = ["place", "map_instance", "start", "target"]
    title, column, scale, sign = _hardness(view)
    several = view.cells.groupby("place")["problems"].max() > 1
    problems = data[data["place"].map(several)].groupby(names, sort=True)
    sums = problems.agg(n=("n", "sum"), hard=(column, "mean"))
    hardest = sums.iloc[(sign * sums["hard"]).argsort(kind="stable")[:_ROWS]]
    methods = view.sweep.methods[view.sweep.choice]
    methods = methods.loc[sorted(methods.index, key=rank)] if len(methods) <= _METHODS else []
    values = data.set_index([*names, "method"])[column] * scale
    shown = []
    for key, row in hardest.iterrows():
        cells = {"Map": view.labels[key[0]]}
        cells |= dict(zip(("Instance", "From", "To"), map(text, key[1:]), strict=True))
        cells[view.measures.unit.capitalize()] = number(row["n"])
        cells[title] = number(rounded(row["hard"] * scale))
        for method, name in dict(methods).items():
            cells[label(name)] = number(rounded(values.get((*key, method), math.nan)))
        shown.append(cells)
    columns = f", {title.lower()} of each {view.sweep.choice}" if len(methods) else ""
    return [
        Table(
            f"{view.stem}_problems",
            f"The problems one by one, {len(hardest)} of {len(sums)}, the hardest first"
            f"{columns}. The CSV has every problem and method.",
            data,
            pd.DataFrame(shown),
            heads=4,
        )
    ]


def _hardness(view: View) -> tuple[str, str, float, int]:
    """Say by what problems are sorted: success, or if all succeeded the median time."""
    efforts = view.efforts
    if efforts and view.cells["success"].min() == 1:
        last = efforts[-1]
        title = f"Median {last.title}"
        return title, f"{last.name}_median", last.scale, -1
    return f"{view.measures.succeeded}, %", "success", 100.0, 1


def _by_problem(view: View) -> pd.DataFrame:
    trials, success = view.trials, view.measures.success
    columns = ["map_instance", "start", "target"]
    spent = trials.assign(
        **{effort.name: effort.read(trials) for effort in view.efforts},
        **{middle.name: middle.read(trials) for middle in view.measures.middles},
    )
    groups = spent.groupby(["cell", "problem"], sort=True)
    first = groups[columns].first()
    first["n"], first["succeeded"] = groups.size(), groups[success].sum()
    first["success"] = first["succeeded"] / first["n"]
    names = [effort.name for effort in view.efforts]
    names += [middle.name for middle in view.measures.middles]
    first = first.join(groups[names].median().add_suffix("_median"))
    cells = view.cells.set_index("cell")[["place", "method"]]
    rows = first.join(cells, on="cell").reset_index(drop=True)
    return rows[["place", *columns, "method", *rows.columns[3:-2]]]
