"""Three or more settings: every cell as a line through its values, and each setting by itself."""

from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure as Canvas

from gapath.pipelines.numbers.text import number
from gapath.pipelines.page.figures import INK, PAPER, WIDTH, looks_of, panels, render, style
from gapath.pipelines.page.section import Figure
from gapath.pipelines.sweeps.cells import wilson_of
from gapath.pipelines.sweeps.importance import Importance
from gapath.pipelines.sweeps.measures import Values
from gapath.pipelines.sweeps.pictures.curves import (
    LINES,
    Quantity,
    draw_legend,
    plain,
    quantities,
    wide,
)
from gapath.pipelines.sweeps.varied import Factor
from gapath.pipelines.sweeps.view import View, text

_LINES = 300
"""More lines than this are one colour."""
_AXES = 8
_TICKS = 8
_SPREAD = 0.05
"""Success that differs by less than this tells settings apart no more than chance does."""


def told_by(view: View) -> Quantity:
    """Choose what tells settings apart: success where it differs, else the first effort."""
    success, *efforts = quantities(view)
    rates = view.cells["success"]
    same = rates.max() - rates.min() < _SPREAD
    return efforts[0] if same and efforts else success


def results(view: View, quantity: Quantity) -> Values:
    """Give what each cell came to; of amounts the logarithm, without which the largest rule."""
    values = view.cells[quantity.name].to_numpy(dtype=np.float64) * quantity.scale
    found: Values = values if quantity.name == "success" else np.log(values)
    return found


def parallel(view: View) -> Figure:
    """Draw each cell as a line through the values of its settings, coloured by its result.

    Parameters
    ----------
    view : View
        A sweep over several settings.

    Returns
    -------
    Figure
        The best lines on top.
    """
    factors, quantity = view.sweep.factors[:_AXES], told_by(view)
    rows = _chosen(view, quantity)
    colors, norm = _colors(rows, quantity)
    with style():
        canvas = Canvas(figsize=(WIDTH, 4.2), layout="constrained")
        panel = canvas.subplots()
        for _, row in rows.iterrows():
            y = np.array([_place(factor, row[factor.name]) for factor in factors])
            value = row[quantity.name] * quantity.scale
            color = colors(norm(value)) if np.isfinite(value) else "#4d4d4d"
            panel.plot(np.arange(len(y)), y + row["shift"], color=color, linewidth=1.2, alpha=0.8)
        for x, factor in enumerate(factors):
            panel.axvline(x, color=INK, linewidth=0.8)
            step = -(-len(factor.levels) // _TICKS)
            for level in factor.levels[::step]:
                panel.text(
                    x + 0.04, _place(factor, level), text(level)[:14], fontsize=8, va="center",
                    bbox={"fc": PAPER, "ec": "none", "pad": 0.6, "alpha": 0.75},
                )  # fmt: skip
        panel.grid(visible=False)
        panel.set_xticks(range(len(factors)), [_broken(factor.title) for factor in factors])
        panel.set(yticks=[], xlim=(-0.15, len(factors) - 0.55))
        for spine in panel.spines.values():
            spine.set_visible(False)
        bar = canvas.colorbar(
            ScalarMappable(norm, colors), ax=panel, location="top", aspect=45,
            label=quantity.title,
        )  # fmt: skip
        bar.outline.set_visible(False)
        if quantity.log:
            plain(bar.ax.xaxis)
        svg, png = render(canvas)
    return Figure(
        f"{view.stem}_parallel", *_parallel_words(view, quantity, len(rows), len(factors)), svg, png
    )


def _chosen(view: View, quantity: Quantity) -> pd.DataFrame:
    """Take evenly from the worst to the best, which is drawn last."""
    rows = view.cells
    worst_first = rows[quantity.name].sort_values(ascending=quantity.name == "success")
    places = np.linspace(0, len(rows) - 1, min(len(rows), _LINES)).round().astype(int)
    random = np.random.Generator(np.random.SFC64(0))
    shift = 0.03 * (random.random(len(places)) - 0.5)
    return rows.loc[worst_first.index[np.unique(places)]].assign(shift=shift)


def _colors(rows: pd.DataFrame, quantity: Quantity) -> tuple[Any, Normalize]:
    if quantity.name == "success":
        return matplotlib.colormaps["viridis"], Normalize(0, 100)
    values = rows[quantity.name].astype(float) * quantity.scale
    finite = values[np.isfinite(values)]
    low, high = (finite.min(), finite.max()) if len(finite) else (1.0, 2.0)
    kind = LogNorm if wide(values) else Normalize
    return matplotlib.colormaps["viridis_r"], kind(low, high if high > low else low * 1.1)


def _place(factor: Factor, value: Any) -> float:
    """Give a value's place on an axis from 0 to 1: by rank, as values often grow by factors."""
    return _rank(factor, value) / max(len(factor.levels) - 1, 1)


def _rank(factor: Factor, value: Any) -> int:
    return [repr(level) for level in factor.levels].index(repr(value))


def _broken(title: str) -> str:
    return title.replace(" ", "\n")


def _parallel_words(view: View, quantity: Quantity, drawn: int, axes: int) -> tuple[str, str]:
    count, every = len(view.cells), len(view.sweep.factors)
    lines = f" Drawn are {drawn} of {count}, evenly from worst to best." if drawn < count else ""
    names = ", ".join(factor.title for factor in view.sweep.factors[:axes])
    also = f" Only {axes} of {every} settings have an axis." if axes < every else ""
    best = view.cells.loc[
        view.cells[quantity.name].idxmax()
        if quantity.name == "success"
        else view.cells[quantity.name].idxmin()
    ]
    values = ", ".join(f"{f.title} {text(best[f.name])}" for f in view.sweep.factors[:axes])
    return (
        f"A line for each combination and map, through its values of {names}; the colour is "
        f"{quantity.title}, the best are drawn last.{lines}{also}",
        f"Parallel coordinates of {names}. The best line has {quantity.title} "
        f"{number(best[quantity.name] * quantity.scale)} and is {values}.",
    )


def effects(view: View) -> Figure:
    """Draw each setting by itself: all trials at each of its values together, whatever the others.

    Parameters
    ----------
    view : View
        A sweep over several settings.

    Returns
    -------
    Figure
        A panel a setting, a line a map.
    """
    factors, quantity = view.sweep.factors[:_AXES], told_by(view)
    places = view.sweep.places[:LINES]
    look = looks_of(view.labels[place] for place in places)
    sentences = []
    with style():
        canvas, axes = panels(len(factors), 1.7, same_axes=False)
        for panel, factor in zip(axes, factors, strict=True):
            panel.set_title(factor.title)
            for place in places:
                rows = _pooled(view, view.cells[view.cells["place"] == place], factor, quantity)
                color, dashes = look[view.labels[place]]
                panel.plot(rows.index, rows["value"], color=color, linestyle=dashes, marker="o",
                           markersize=3.5)  # fmt: skip
                panel.fill_between(rows.index, rows["low"], rows["high"], color=color, alpha=0.15,
                                   linewidth=0)  # fmt: skip
                ends = [number(value) for value in rows["value"].iloc[[0, -1]]]
                sentences.append(f"{factor.title}, {view.labels[place]}: {' to '.join(ends)}.")
            _by_rank(panel, factor)
            if quantity.log:
                panel.set_yscale("log")
                plain(panel.yaxis)
        limits = np.array([panel.get_ylim() for panel in axes])
        for panel in axes:
            panel.set_ylim(limits[:, 0].min(), limits[:, 1].max())
        canvas.supylabel(quantity.title, fontsize=10)
        if len(places) > 1:
            draw_legend(canvas, look, dashed=True)
        svg, png = render(canvas)
    word = "all trials of a value together, whatever the other settings"
    interval = ", with the 95 % Wilson interval" if quantity.name == "success" else ""
    return Figure(
        f"{view.stem}_effects",
        f"Each setting by itself: {quantity.title} of {word}{interval}.",
        f"Panels, one a setting, of {quantity.title} from its first value to its last. "
        + " ".join(sentences),
        svg,
        png,
    )


def _pooled(view: View, rows: pd.DataFrame, factor: Factor, quantity: Quantity) -> pd.DataFrame:
    places = rows[factor.name].map(lambda value: _rank(factor, value))
    columns = ["n", "succeeded", *(f"{effort.name}_total" for effort in view.efforts)]
    sums = rows[columns].groupby(places).sum()
    if quantity.name == "success":
        rate = (sums["succeeded"] / sums["n"]).to_numpy()
        ends = wilson_of(rate, sums["n"].to_numpy())
        values = (rate, *ends)
    else:
        total = sums[quantity.name.removeprefix("expected_") + "_total"]
        value = (total / sums["succeeded"].where(sums["succeeded"] > 0)).to_numpy()
        values = (value, value, value)
    shown = {n: v * quantity.scale for n, v in zip(("value", "low", "high"), values, strict=True)}
    return pd.DataFrame(shown, index=sums.index)


def _by_rank(panel: Axes, factor: Factor) -> None:
    step = -(-len(factor.levels) // 6)
    places = range(0, len(factor.levels), step)
    panel.set_xticks(list(places), [text(factor.levels[i])[:10] for i in places])


def importances(view: View, found: Importance, titles: dict[str, str]) -> Figure | None:
    """Draw how much each setting matters.

    Parameters
    ----------
    view : View
        A sweep over several settings.
    found : Importance
        What a forest knows of it.
    titles : dict of str to str
        What each factor is called.

    Returns
    -------
    Figure or None
        A bar a setting, with its interval; None where it cannot be told.
    """
    if not found.weights:
        return None
    with style():
        canvas = Canvas(figsize=(WIDTH, 0.7 + 0.32 * len(found.weights)), layout="constrained")
        panel = canvas.subplots()
        for y, weight in enumerate(found.weights):
            color = "#0072B2" if weight.told else "#b0b0b0"
            panel.barh(y, 100 * weight.share, color=color, height=0.6)
            panel.hlines(y, 100 * weight.low, 100 * weight.high, color=INK, linewidth=1.2)
        panel.set_yticks(range(len(found.weights)), [titles[w.name] for w in found.weights])
        panel.set_ylim(len(found.weights) - 0.5, -0.5)
        panel.axvline(0, color=INK, linewidth=0.8)
        panel.set_xlabel("share of variance, %")
        svg, png = render(canvas)
    words = "; ".join(
        f"{titles[w.name]} {number(round(100 * w.share, 1))} %"
        + ("" if w.told else ", which cannot be told from none")
        for w in found.weights
    )
    return Figure(
        f"{view.stem}_importance",
        "How much each setting matters: the share of the variance between cells that it has a part "
        "in, alone or together with others, by a random forest that is asked about cells it did "
        "not see with that setting's values shuffled; with the 95 % interval over cells, grey "
        "where it cannot be told from none.",
        f"Bars: {words}.",
        svg,
        png,
    )
