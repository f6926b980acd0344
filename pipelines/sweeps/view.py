"""A sweep with its numbers, as its tables and figures see it."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import pandas as pd

from gapath.pipelines.numbers.text import number, percent, span
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.sweeps.cells import Cells, summarise_cells
from gapath.pipelines.sweeps.measures import Effort, Measures
from gapath.pipelines.sweeps.varied import Factor, Sweep
from gapath.store.settings import Value, written

EVERYWHERE = "all"
"""The place of what is about all maps together."""

_LETTERS = 60
"""A value has no more letters."""
_NAMED = 6
"""So many values are named in a sentence."""


@dataclass(frozen=True)
class View:
    """A sweep and what its trials come to.

    Parameters
    ----------
    sweep : Sweep
        What varied.
    measures : Measures
        What is measured, without what is known of none of its cells.
    cells : DataFrame
        The rows of `cells.summarise_cells` that belong to the sweep, with its methods' columns.
    trials : DataFrame
        Their trials.
    labels : dict of str to str
        What each map is called.
    stem : str
        How the names of its files begin.
    """

    sweep: Sweep
    measures: Measures
    cells: pd.DataFrame
    trials: pd.DataFrame
    labels: dict[str, str]
    stem: str

    @property
    def efforts(self) -> tuple[Effort, ...]:
        """What its trials spend."""
        return self.measures.efforts

    @property
    def main(self) -> Factor:
        """The factor that axes are about: the setting, else the choice of the method."""
        return (*self.sweep.settings, *self.sweep.factors)[0]

    def series(self) -> Iterator[tuple[str, pd.DataFrame]]:
        """Give the cells of each map and, where settings varied, YAML, under what names them."""
        split = ["place", "preset"] if self.sweep.settings else ["place"]
        groups = [(key, rows) for key, rows in self.cells.groupby(split, sort=False)]
        groups.sort(key=lambda group: [rank(name) for name in group[0]])
        several = [len(set(self.cells[column])) > 1 for column in split]
        if not any(several):
            several[0] = True
        for key, rows in groups:
            names = [self.labels[key[0]], *map(label, key[1:])]
            yield ", ".join(n for n, s in zip(names, several, strict=True) if s), rows


def view_of(sweep: Sweep, cells: Cells, measures: Measures, stem: str) -> View:
    """Take a sweep's part of all cells.

    Parameters
    ----------
    sweep : Sweep
        What varied.
    cells : Cells
        Those of its experiment.
    measures : Measures
        What is measured.
    stem : str
        How names of files begin.

    Returns
    -------
    View
        The sweep with its numbers.
    """
    pairs = sweep.cases[["place", "method"]].drop_duplicates()
    numbered = cells.table.reset_index(names="cell")
    mine = pairs.merge(numbered, on=["place", "method"]).join(sweep.methods, on="method")
    trials = cells.trials[cells.trials["cell"].isin(mine["cell"])]
    first = trials.drop_duplicates("cell").set_index("cell")["map_source"]
    sources = dict(zip(mine["place"], mine["cell"].map(first), strict=True))
    labels = {place: label(place, source) for place, source in sources.items()}
    return View(sweep, _known(measures, mine), mine, trials, labels, f"{stem}_{sweep.what}")


def together(view: View) -> View:
    """Take all maps of a sweep as one, each of whose problems is one of a map.

    Parameters
    ----------
    view : View
        A sweep on several maps.

    Returns
    -------
    View
        The same trials, a cell a method.
    """
    cases = view.sweep.cases
    problems = cases["place"] + " " + cases["problem"]
    cases = cases.assign(problem=problems, place=EVERYWHERE)
    sweep = replace(view.sweep, cases=cases)
    cells = summarise_cells(view.trials, cases, view.measures)
    whole = view_of(sweep, cells, view.measures, view.stem.removesuffix(f"_{sweep.what}"))
    return replace(whole, labels={EVERYWHERE: f"All {len(view.sweep.places)} maps"})


def _known(measures: Measures, cells: pd.DataFrame) -> Measures:
    known = cells.notna().any()
    return measures._replace(
        efforts=tuple(e for e in measures.efforts if known[f"expected_{e.name}"]),
        middles=tuple(m for m in measures.middles if known[f"{m.name}_median"]),
        shares=tuple(share for share in measures.shares if cells[share.name].any()),
    )


def text(value: Value) -> str:
    """Write a setting's value, or what a method is called, for people."""
    if isinstance(value, str):
        long = len(value) > _LETTERS
        return label(f"{value[: _LETTERS - 1]}\N{HORIZONTAL ELLIPSIS}" if long else value)
    return written(value) if value is None or isinstance(value, bool) else f"{value:g}"


def sentence(view: View) -> str:
    """Say what varied, where, and how often it was tried."""
    sweep = view.sweep
    varied = " and ".join(_took(factor, i == 0) for i, factor in enumerate(sweep.factors))
    if not varied:
        methods = sorted(sweep.methods[sweep.choice], key=rank)
        varied = _several([label(name) for name in methods], f"{sweep.choice}s")
    elif len(sweep.factors) > 1 and sweep.settings:
        whole = math.prod(len(factor.levels) for factor in sweep.factors)
        there = len(sweep.methods)
        varied += (
            ", in all combinations" if there == whole else f", {there} of {whole} combinations"
        )
    if sweep.settings and len(sweep.presets) == 1:
        varied += f" with {label(sweep.presets[0])}"
    if 0 < len(sweep.fixed) <= _NAMED:
        varied += f" ({', '.join(f'{name}={text(value)}' for name, value in sweep.fixed)})"
    places = _several([view.labels[place] for place in sweep.places], "maps")
    return f"{varied}, on {places}, {_often(view)}."


def _took(factor: Factor, first: bool) -> str:
    count = len(factor.levels)
    levels = [text(level) for level in factor.levels]
    if factor.numeric and count > _NAMED:
        shown = f" ({levels[0]} to {levels[-1]})"
    else:
        shown = f" ({', '.join(levels)})" if count <= _NAMED else ""
    return f"{factor.name} {'took ' if first else ''}{count} values{shown}"


def _several(names: list[str], what: str) -> str:
    if len(names) == 1:
        return names[0]
    return f"{len(names)} {what}" + (f" ({', '.join(names)})" if len(names) <= _NAMED else "")


def _often(view: View) -> str:
    n, problems = view.cells["n"], view.cells["problems"]
    unit = view.measures.unit
    trials = f"{span(n.min(), n.max())} {unit if n.max() > 1 else unit.removesuffix('s')}"
    if problems.max() == 1:
        return f"{trials} each"
    return f"{trials} each, over {span(problems.min(), problems.max())} problems a map"


def interval(low: float, high: float, scale: float = 1.0) -> str:
    """Write an interval behind a number; nothing where there is none."""
    if pd.isna(low) or pd.isna(high):
        return ""
    return f" ({number(rounded(low * scale))} to {number(rounded(high * scale))})"


def rate(row: Mapping[str, Any], name: str = "success") -> str:
    """Write a rate in percent with its interval."""
    low, high = row[f"{name}_low"], row[f"{name}_high"]
    ends = "" if pd.isna(low) else f" ({100 * low:.1f} to {100 * high:.1f})"
    return percent(row[name]) + ends


def amount(row: Mapping[str, Any], effort: Effort) -> str:
    """Write what is expected until a success, with its interval."""
    name = f"expected_{effort.name}"
    value = row[name]
    ends = interval(row[f"{name}_low"], row[f"{name}_high"], effort.scale)
    if pd.isna(value):
        return number(value)
    if row[f"{name}_high"] == float("inf"):
        return f"\N{INFINITY} (at least {number(rounded(row[f'{name}_low'] * effort.scale))})"
    return number(rounded(value * effort.scale)) + ends


def rounded(value: float) -> float:
    """Keep three significant digits: more than intervals are worth."""
    return float(f"{value:.3g}") if pd.notna(value) else value
