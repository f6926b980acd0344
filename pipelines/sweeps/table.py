"""Experiments that no other section is about: what varied, and what came of it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import pandas as pd

from gapath.pipelines.numbers.text import number, percent
from gapath.pipelines.page.section import ALL, Figure, Section, Table
from gapath.pipelines.papers.names import rank
from gapath.pipelines.sweeps.best import best_table, find_best, sentences
from gapath.pipelines.sweeps.cells import summarise_cells
from gapath.pipelines.sweeps.importance import importance
from gapath.pipelines.sweeps.measures import TRIALS, measures_of
from gapath.pipelines.sweeps.pictures.curves import curves
from gapath.pipelines.sweeps.pictures.heat import heat_maps
from gapath.pipelines.sweeps.pictures.many import (
    effects,
    importances,
    parallel,
    results,
    told_by,
)
from gapath.pipelines.sweeps.pictures.shares import shares
from gapath.pipelines.sweeps.problems import problems_table
from gapath.pipelines.sweeps.varied import Factor, cases_of, find_sweeps
from gapath.pipelines.sweeps.view import View, amount, rate, sentence, text, together, view_of
from gapath.store.records import RunRecord
from gapath.task import find_task

TASK = ALL
EXPERIMENT = None
ORDER = 90

_MAPS = 7
"""More maps than so many are drawn together."""


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> list[Section]:
    """Make the sections of an experiment of a user's own.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment, of one task.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    list of Section
        One for each sweep in it, found from what varies, and one for what is in none.
    """
    views = views_of(trials, runs)
    named = titles(views, trials["experiment"].iloc[0])
    return [_section(*each) for each in zip(views, named, strict=True)]


def views_of(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> list[View]:
    """Find the sweeps of an experiment, and what their trials come to."""
    task = find_task(runs[0].known.task)
    choice, measures, cases = task.groups[0], measures_of(task), cases_of(runs)
    cells = summarise_cells(trials, cases, measures)
    stem = f"sweep_{task.name}_{trials['experiment'].iloc[0]}"
    return [view_of(sweep, cells, measures, stem) for sweep in find_sweeps(cases, choice)]


def _section(view: View, title: str) -> Section:
    sweep, each_map = view.sweep, view
    figures: list[Figure | None] = []
    remarks = _remarks(view)
    if sweep.factors and len(sweep.places) > _MAPS:
        view = together(view)
        remarks.append("Figures, and what is best, are of all maps together.")
    if len(sweep.settings) == 2 and sweep.whole:
        figures += heat_maps(view)
    elif len(sweep.settings) > 1:
        weighed, remark = _weigh(view)
        figures += [parallel(view), effects(view), weighed]
        remarks.append(remark)
    elif sweep.factors:
        figures += [curves(view), shares(view)]
    best = find_best(view) if sweep.factors else []
    tables = [*best_table(view, best), _table(each_map, view), *problems_table(each_map)]
    return Section(
        title=title,
        text=(sentence(each_map), *sentences(view, best)),
        tables=tuple(tables),
        figures=tuple(figure for figure in figures if figure is not None),
        remarks=tuple(remarks),
        runs=tuple(sorted(sweep.cases.index)),
    )


def _weigh(view: View) -> tuple[Figure | None, str]:
    """Tell how much each setting matters, and the map where there are several."""
    quantity, factors = told_by(view), view.sweep.factors
    names = {factor.name: factor.title for factor in factors} | {"map": "map"}
    places = view.sweep.places
    if len(places) > 1:
        factors = (*factors, Factor("map", tuple(places), numeric=False))
    cells = view.cells.assign(map=view.cells["place"])
    found = importance(cells, factors, results(view, quantity))
    knows = "" if math.isnan(found.explained) else (
        f" A forest of {quantity.title} explains {percent(max(found.explained, 0))} % of the "
        "variance of cells that its trees did not see (R², out of bag)."
    )  # fmt: skip
    if found.why:
        return None, f"How much each setting matters cannot be told: {found.why}.{knows}"
    told = [names[weight.name] for weight in found.weights if weight.told]
    others = [names[weight.name] for weight in found.weights if not weight.told]
    words = f"What matters, most first: {', '.join(told) or 'nothing that can be told'}."
    if others:
        words += f" Of {', '.join(others)} it cannot be told that it matters."
    return importances(view, found, names), words + knows


def titles(views: Sequence[View], experiment: str) -> list[str]:
    """Call each section by the experiment, and where there are several by what varied."""
    drives = f" ({views[0].measures.unit})" if views[0].measures.unit != TRIALS else ""
    if len(views) == 1:
        return [experiment + drives]
    return [f"{experiment}{drives}: {_what(view)}" for view in views]


def _what(view: View) -> str:
    factors = view.sweep.settings or view.sweep.factors
    return ", ".join(factor.name for factor in factors[:3]) or "other trials"


def _table(view: View, drawn: View) -> Table:
    """List a sweep's cells, first those of all maps together where these are drawn."""
    rows = _sorted(view)
    if drawn is not view:
        rows = pd.concat([_sorted(drawn), rows])
        view = replace(view, labels=view.labels | drawn.labels)
    data = rows.drop(columns=["cell", "runs"])
    several = bool(rows["problems"].max() > 1)
    shown = pd.DataFrame([_cells(view, row, several) for row in rows.to_dict("records")])
    heads, behind = 1 + len(_heads(view)), tuple(rows["runs"])
    return Table(view.stem, _caption(view), data, shown, heads=heads, runs=behind)


def _sorted(view: View) -> pd.DataFrame:
    """Sort cells by map, and within one by the only setting, or the best first."""
    factors, rows = view.sweep.factors, view.cells.copy()
    columns = {"map": rows["place"].map(rank), "best": -rows["success"]}
    first = view.measures.efforts[0] if view.measures.efforts else None
    columns["effort"] = rows[f"expected_{first.name}"] if first else 0.0
    if len(view.sweep.settings) == 1 or not factors:
        columns["preset"] = rows["preset"].map(rank)
        for factor in view.sweep.settings:
            places = {repr(level): i for i, level in enumerate(factor.levels)}
            columns["level"] = rows[factor.name].map(lambda value, p=places: p[repr(value)])
        by = ["map", "preset", *(["level"] if view.sweep.settings else ["method"])]
    else:
        by = ["map", "best", "effort"]
    columns["method"] = rows["method"].map(rank)
    order = pd.DataFrame(columns).sort_values(by, kind="stable").index
    return rows.loc[order]


def _heads(view: View) -> list[str]:
    """Give the columns of cells that name a row behind its map."""
    return [factor.name for factor in view.sweep.factors] or [view.sweep.choice]


def _cells(view: View, row: Mapping[str, Any], problems: bool) -> dict[str, str]:
    """Write a row's cells; of a map's problems only where a map has several."""
    measures = view.measures
    titles = {factor.name: factor.title.capitalize() for factor in view.sweep.factors}
    titles.setdefault(view.sweep.choice, view.sweep.choice.capitalize())
    shown = {"Map": view.labels[row["place"]]}
    for name in _heads(view):
        shown[titles[name]] = text(row[name])
    if problems:
        shown |= {
            "Problems": number(row["problems"]),
            "Solved once": number(row["once"]),
            "Always": number(row["always"]),
        }
    shown[measures.unit.capitalize()] = number(row["n"])
    shown[f"{measures.succeeded}, %"] = rate(row)
    for effort in view.efforts:
        shown[f"Expected {effort.title}"] = amount(row, effort)
    for effort in view.efforts:
        shown[f"Median {effort.title}"] = number(row[f"{effort.name}_median"] * effort.scale)
    for middle in measures.middles:
        shown[middle.title] = number(middle.shown(row[f"{middle.name}_median"]))
    for share in measures.shares:
        shown[share.title] = percent(row[share.name])
    return shown


def _caption(view: View) -> str:
    measures = view.measures
    parts = [f"{measures.succeeded}: with the 95 % Wilson interval over {measures.unit}"]
    if view.cells["problems"].max() > 1:
        parts[0] += ", of these problems"
        parts.append("solved once, always: in how many problems some or all succeeded")
    if view.efforts:
        parts.append(
            "expected: what all spent for each success, with the 95 % interval by the delta method"
        )
    if measures.middles or view.efforts:
        parts.append("medians are of all, failures included, but what is above the least of "
                     "those that succeeded")  # fmt: skip
    if view.cells["success_low"].isna().any():
        parts.append("what has no chance has no interval")
    return "; ".join(parts) + "."


def _remarks(view: View) -> list[str]:
    remarks = [
        f"{name} changed with {other}: what it does by itself is not told."
        for name, other in view.sweep.together
    ]
    pairs = view.sweep.cases.drop_duplicates(["place", "method", "problem"])
    tried = pairs.groupby(["place", "problem"]).size()
    most = view.cells.groupby("place").size()
    if (tried < most.reindex(tried.index.get_level_values("place")).to_numpy()).any():
        remarks.append("Not all were tried on the same problems: rows of one map may differ by it.")
    return remarks
