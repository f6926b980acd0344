"""Two settings: success and what it takes for each pair of values, a panel a map."""

from textwrap import fill
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure as Canvas
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from gapath.pipelines.numbers.text import number, percent
from gapath.pipelines.page.figures import WIDTH, render, style
from gapath.pipelines.page.section import Figure
from gapath.pipelines.sweeps.pictures.curves import WIDE, Quantity, plain, quantities, wide
from gapath.pipelines.sweeps.varied import Factor
from gapath.pipelines.sweeps.view import View, text

PANELS = 6
"""So many are drawn."""
_WRITTEN = 10
"""Numbers are written into cells where there are no more columns than this."""
_TICKS = 10
_NEVER = "#4d4d4d"
_NOT_TRIED: dict[str, Any] = {"fill": False, "hatch": "////", "ec": "#b0b0b0", "lw": 0}
Cells = NDArray[np.float64]


def heat_maps(view: View) -> list[Figure]:
    """Draw success and the first effort of every pair of values.

    Parameters
    ----------
    view : View
        A sweep over two settings.

    Returns
    -------
    list of Figure
        One for each quantity.
    """
    return [_figure(view, quantity) for quantity in quantities(view)[:2]]


def _figure(view: View, quantity: Quantity) -> Figure:
    # The longer one runs to the right, as numbers do in a table.
    across, down = sorted(view.sweep.settings, key=lambda factor: -len(factor.levels))
    parts = list(view.series())[:PANELS]
    tables = [(name, values_of(rows, quantity, across, down)) for name, rows in parts]
    norm = _norm(tables, quantity)
    colors = matplotlib.colormaps["viridis" if quantity.name == "success" else "viridis_r"]
    with style():
        two = len(parts) > 1 and len(across.levels) <= 6
        rows, cols = (-(-len(parts) // 2), 2) if two else (len(parts), 1)
        high = 0.75 + min(0.27 * len(down.levels), 3.2)
        canvas = Canvas(figsize=(WIDTH, 1.0 + high * rows), layout="constrained")
        axes = list(canvas.subplots(rows, cols, squeeze=False, sharex=True, sharey=True).flat)
        for panel, (name, table) in zip(axes, tables, strict=False):
            image = _draw(panel, table, (norm, colors), quantity)
            if len(parts) > 1:
                panel.set_title(fill(name, WIDE if two else 2 * WIDE))
        for empty in axes[len(parts) :]:
            empty.set_axis_off()
        _ticks(axes[0], across, down)
        canvas.supxlabel(across.title, fontsize=10)
        canvas.supylabel(down.title, fontsize=10)
        bar = canvas.colorbar(
            image, ax=axes, location="top", aspect=45, pad=0.02, label=quantity.title
        )
        bar.outline.set_visible(False)
        if quantity.log:
            plain(bar.ax.xaxis)
        svg, png = render(canvas)
    name = "success" if quantity.name == "success" else "expected"
    return Figure(
        f"{view.stem}_{name}",
        _caption(view, quantity, tables, (across, down)),
        _alt(quantity, tables, (across, down)),
        svg,
        png,
    )


def values_of(rows: pd.DataFrame, quantity: Quantity, across: Factor, down: Factor) -> Cells:
    """Give a value for each pair: NaN where it was not tried, infinity where none succeeded."""
    table = np.full((len(down.levels), len(across.levels)), np.nan)
    place = [{repr(level): i for i, level in enumerate(f.levels)} for f in (down, across)]
    values = rows[quantity.name].astype(float) * quantity.scale
    for one, other, value in zip(rows[down.name], rows[across.name], values, strict=True):
        table[place[0][repr(one)], place[1][repr(other)]] = value
    return table


def _norm(tables: list[tuple[str, Cells]], quantity: Quantity) -> Normalize:
    if quantity.name == "success":
        return Normalize(0, 100)
    every = pd.Series(np.concatenate([table.ravel() for _, table in tables]))
    finite = every[np.isfinite(every)]
    low, high = (finite.min(), finite.max()) if len(finite) else (1.0, 2.0)
    high = high if high > low else low * 1.1
    return LogNorm(low, high) if wide(every) else Normalize(low, high)


def _draw(panel: Axes, table: Cells, colors: tuple[Any, Any], quantity: Quantity) -> Any:
    norm, cmap = colors
    shown = np.ma.masked_invalid(table)
    image = panel.imshow(shown, cmap=cmap, norm=norm, aspect="auto", interpolation="nearest")
    panel.grid(visible=False)
    for spine in panel.spines.values():
        spine.set_visible(False)
    for (i, j), value in np.ndenumerate(table):
        if np.isnan(value):
            panel.add_patch(Rectangle((j - 0.5, i - 0.5), 1, 1, **_NOT_TRIED))
            continue
        if np.isposinf(value):
            panel.add_patch(Rectangle((j - 0.5, i - 0.5), 1, 1, fc=_NEVER, lw=0))
        if table.shape[1] <= _WRITTEN:
            dark = np.isposinf(value) or sum(cmap(norm(value))[:3]) < 1.5
            word = _short(value, quantity)
            panel.text(j, i, word, ha="center", va="center", fontsize=8,
                       color="white" if dark else "black")  # fmt: skip
    return image


def _short(value: float, quantity: Quantity) -> str:
    if quantity.name == "success":
        return f"{value:.0f}"
    if value >= 10000 and np.isfinite(value):
        return f"{number(float(f'{value / 1000:.3g}'))}k"
    return number(float(f"{value:.3g}"))


def _ticks(panel: Axes, across: Factor, down: Factor) -> None:
    for factor, put in ((across, panel.set_xticks), (down, panel.set_yticks)):
        step = -(-len(factor.levels) // _TICKS)
        places = range(0, len(factor.levels), step)
        put(places, [text(factor.levels[i]) for i in places])


def _caption(
    view: View, quantity: Quantity, tables: list[tuple[str, Cells]], factors: tuple[Factor, Factor]
) -> str:
    what = quantity.title[0].upper() + quantity.title[1:]
    parts = [f"{what}, for each {factors[0].title} (across) and {factors[1].title} (down)"]
    if quantity.name != "success":
        parts[0] += ", if a failed trial is tried again until one succeeds"
    missing = sum(int(np.isnan(table).sum()) for _, table in tables)
    if missing:
        were = "combination was not tried and is" if missing == 1 else (
            "combinations were not tried and are")  # fmt: skip
        parts.append(f"{missing} {were} hatched")
    never = sum(int(np.isposinf(table).sum()) for _, table in tables)
    if never:
        parts.append(f"in {never} no trial succeeded: {number(np.inf)}, dark grey")
    count = len(list(view.series()))
    if count > PANELS:
        parts.append(f"the first {PANELS} of {count} panels are drawn, the table has all")
    n = view.cells["n"]
    each = number(n.min()) if n.min() == n.max() else f"{number(n.min())} to {number(n.max())}"
    parts.append(f"{each} {view.measures.unit} each")
    return "; ".join(parts) + "."


def _alt(
    quantity: Quantity, tables: list[tuple[str, Cells]], factors: tuple[Factor, Factor]
) -> str:
    across, down = factors
    sentences = []
    for name, table in tables:
        finite = np.where(np.isfinite(table), table, np.nan)
        if np.isnan(finite).all():
            sentences.append(f"{name}: no trial succeeded.")
            continue
        ends = []
        for place in (int(np.nanargmin(finite)), int(np.nanargmax(finite))):
            i, j = divmod(place, table.shape[1])
            value = finite[i, j]
            shown = percent(value / 100) if quantity.name == "success" else number(value)
            ends.append(
                f"{shown} at {across.title} {text(across.levels[j])}, {down.title} "
                f"{text(down.levels[i])}"
            )
        sentences.append(f"{name}: from {ends[0]} to {ends[1]}.")
    return f"Heat map of {quantity.title}. {' '.join(sentences)}"
