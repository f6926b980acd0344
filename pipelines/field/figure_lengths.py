"""Many problems on a map: success, cost and time over the length of the shortest path."""

import re
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.ticker import FixedLocator, StrMethodFormatter

from gapath.pipelines.field.problems import FIELD, asked, named, summarised
from gapath.pipelines.numbers.text import number, percent
from gapath.pipelines.page.figures import legend, looks, panels, render, style
from gapath.pipelines.page.section import Figure, Section
from gapath.pipelines.papers.names import label
from gapath.store.records import RunRecord

TASK = "scenario"
EXPERIMENT = FIELD
ORDER = 98

_TICKS = tuple(2**power for power in range(24))
_MOST_TICKS = 5

_PANELS = (
    ("found, %", "success", 100.0, "linear"),
    ("time, ms (median)", "seconds_median", 1000.0, "log"),
    ("cost above least, %: mean", "ratio_mean", 100.0, "linear"),
    ("the same: 99th percentile", "ratio_p99", 100.0, "linear"),
)


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw a figure for each family of maps.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section or None
        None if no problem has a way.
    """
    known = asked(trials, runs)
    if known.empty:
        return None
    rows = summarised(known, ["family", "length_from", "length_to"])
    title, file = named(trials, "Success, cost and time over length", "lengths")
    figures = [_figure(file, *each) for each in rows.groupby("family", sort=True)]
    return Section(title=title, figures=tuple(figures))


def _middle(rows: pd.DataFrame) -> pd.Series:
    """Give the middle of a band of lengths as a logarithmic axis has it."""
    return np.sqrt(np.maximum(rows["length_from"], 2) * rows["length_to"])


def _figure(file: str, family: str, rows: pd.DataFrame) -> Figure:
    look = looks(rows["method"])
    limits = max(rows["length_from"].min(), 2), rows["length_to"].max()  # powers of two
    ticks = [tick for tick in _TICKS if limits[0] <= tick <= limits[1]]
    ticks = ticks[:: -(-len(ticks) // _MOST_TICKS)]
    with style():
        canvas, axes = panels(len(_PANELS), height=2.1, same_axes=False)
        for panel, (title, name, scale, kind) in zip(axes, _PANELS, strict=True):
            panel.set_title(title)
            for method, its_look in look.items():
                mine = rows[rows["method"] == method]
                values = mine[name] - 1 if name.startswith("ratio") else mine[name]
                color, dashes = its_look
                panel.plot(_middle(mine), scale * values, color=color, linestyle=dashes, marker=".")
            panel.set_xscale("log", base=2)
            panel.set_yscale(kind)
            panel.xaxis.set_major_locator(FixedLocator(ticks))
            panel.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
            panel.set_xlim(limits)
        axes[0].set_ylim(-4, 106)
        canvas.supxlabel("length of the shortest path, fields", fontsize=10)
        legend(canvas, look)
        svg, png = render(canvas)
    whole = rows.groupby("method", sort=False)[["n", "seconds_total"]].sum()
    found = (rows["success"] * rows["n"]).groupby(rows["method"], sort=False).sum()
    source = " (Sturtevant 2012)" if family == "MovingAI" else ""
    return Figure(
        f"{file}_{re.sub('[^a-z0-9]+', '_', family.lower()).strip('_')}",
        f"Maps: {family}{source}. Problems by the length of their shortest path, bands each twice "
        "as wide as the one before. Found: of all trials on problems with a way. Time: of the "
        "planner's call, failures included. Cost: of paths found, those of a planner that finds "
        "fewer are the easier ones.",
        f"Four panels for {family}. In all: "
        + "; ".join(
            f"{label(str(method))} found {percent(found[method] / row['n'])} % in "
            f"{number(row['seconds_total'])} s"
            for method, row in whole.iterrows()
        )
        + ".",
        svg,
        png,
    )
