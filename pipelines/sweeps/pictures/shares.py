"""How many trials have succeeded within how much: distributions of what they spend."""

from textwrap import fill
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from gapath.pipelines.numbers.statistics import share_within
from gapath.pipelines.numbers.text import percent
from gapath.pipelines.page.figures import Look, looks_of, panels, render, style
from gapath.pipelines.page.section import Figure
from gapath.pipelines.sweeps.measures import Effort
from gapath.pipelines.sweeps.pictures.curves import LINES, WIDE, plain, succeed_most, wide
from gapath.pipelines.sweeps.varied import Factor
from gapath.pipelines.sweeps.view import View, text

CURVES = 8
"""So many values of a setting with an order are drawn."""
PANELS = 4
_STEPS = 300
"""A curve has no more steps: that is finer than a pixel."""


def shares(view: View) -> Figure | None:
    """Draw the share of trials that have succeeded within so much effort, a panel a map or YAML.

    Parameters
    ----------
    view : View
        A sweep over one setting, or over the choice of the method alone.

    Returns
    -------
    Figure or None
        Over the first effort of which anything is known; None where nothing is, or nothing
        succeeded.
    """
    efforts = view.efforts
    if not efforts or not view.cells["succeeded"].any():
        return None
    effort, factor = _effort(view, efforts), view.main
    look = _looks(view, factor)
    parts = list(view.series())[:PANELS]
    trials = view.trials
    spent = pd.Series(effort.read(trials) * effort.scale, index=trials.index)
    success = trials[view.measures.success].astype(bool) & spent.notna()
    within = spent[success]
    log = wide(within)
    low, high = float(within.min()), float(within.max())
    limits = (0.8 * low, 1.25 * high) if log else (low - 0.03 * (high - low or 1), high * 1.05)
    by_cell = trials.groupby("cell").indices
    ends = []
    with style():
        canvas, axes = panels(len(parts), height=2.2)
        for panel, (name, rows) in zip(axes, parts, strict=True):
            if len(parts) > 1:
                panel.set_title(fill(name, WIDE))
            for _, row in rows.iterrows():
                level = row[factor.name]
                if repr(level) in look:
                    place = by_cell[row["cell"]]
                    mine = spent.to_numpy()[place], success.to_numpy()[place]
                    _draw(panel, mine, limits, look[repr(level)])
                    ends.append(f"{name}, {text(level)} {percent(row['success'])} %")
            if log:
                panel.set_xscale("log")
            panel.set(xlim=limits, ylim=(-0.04, 1.06))
            if log:
                plain(panel.xaxis)
        canvas.supxlabel(effort.title, fontsize=10)
        canvas.supylabel(f"share {view.measures.succeeded.lower()}", fontsize=10)
        _legend(canvas, factor, look)
        svg, png = render(canvas)
    return Figure(f"{view.stem}_effort", _caption(view, effort, look), _alt(effort, ends), svg, png)


def _effort(view: View, efforts: tuple[Effort, ...]) -> Effort:
    """Take the first of which every method has any: a graph search beside others has its time."""
    whole = [each for each in efforts if view.cells[f"expected_{each.name}"].notna().all()]
    return (whole or list(efforts))[0]


def _looks(view: View, factor: Factor) -> dict[str, Look]:
    """Give the values that are drawn their looks, by what is printed of them."""
    if factor.numeric:
        places = np.linspace(0, len(factor.levels) - 1, min(len(factor.levels), CURVES))
        levels = [factor.levels[i] for i in np.unique(places.round().astype(int))]
        colors = matplotlib.colormaps["viridis"](np.linspace(0.25, 0.88, len(levels)))
        hexes = [matplotlib.colors.to_hex(color) for color in colors]
        return {repr(v): Look(color, "-") for v, color in zip(levels, hexes, strict=True)}
    best = set(map(repr, succeed_most(view, factor, LINES)))
    return looks_of([repr(level) for level in factor.levels if repr(level) in best])


def _draw(panel: Axes, trials: Any, limits: tuple[float, float], look: Look) -> None:
    spent, share = share_within(*trials)
    if len(spent) > _STEPS:
        kept = np.unique(np.linspace(0, len(spent) - 1, _STEPS).round().astype(int))
        spent, share = spent[kept], share[kept]
    ends = np.r_[limits[0], spent, limits[1]]
    steps = np.r_[0, share, share[-1:] if share.size else 0]
    panel.step(ends, steps, where="post", color=look.color, linestyle=look.dashes, linewidth=1.5)


def _legend(canvas: Any, factor: Factor, look: dict[str, Look]) -> None:
    names = {repr(level): text(level) for level in factor.levels}
    handles = [
        Line2D([], [], color=color, linestyle=dashes, label=names[key])
        for key, (color, dashes) in look.items()
    ]
    longest = max(len(names[key]) for key in look)
    cols = 1 if longest > 24 else 2 if longest > 12 else 3 if len(look) in (3, 5, 6) else 4
    canvas.legend(
        handles=handles, loc="outside upper center", ncols=cols, handlelength=2.2,
        title=factor.title, alignment="center",
    )  # fmt: skip


def _caption(view: View, effort: Effort, look: dict[str, Look]) -> str:
    unit, levels = view.measures.unit, len(view.main.levels)
    left_out = []
    if len(look) < levels:
        how = "evenly chosen" if view.main.numeric else "that succeed most"
        left_out.append(f"{len(look)} of {levels} values, {how}")
    count = len(list(view.series()))
    if count > PANELS:
        left_out.append(f"the first {PANELS} of {count} panels")
    drawn = f" Drawn are {' and '.join(left_out)}." if left_out else ""
    return (
        f"Share of all {unit} that succeeded within so much ({effort.title}), by "
        f"{view.main.title}: further left and higher is better. One that failed never counts, so "
        f"a curve that ends below 1 failed that often.{drawn}"
    )


def _alt(effort: Effort, ends: list[str]) -> str:
    return f"Steps over {effort.title}. The curves end at: {'; '.join(ends)}."
