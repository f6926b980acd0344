"""One setting: success and what it takes, as curves over numbers or as points of other values."""

from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, NullFormatter

from gapath.pipelines.numbers.text import number, percent
from gapath.pipelines.page.figures import WIDTH, Look, looks_of, render, style
from gapath.pipelines.page.section import Figure
from gapath.pipelines.sweeps.measures import Effort
from gapath.pipelines.sweeps.varied import Factor
from gapath.pipelines.sweeps.view import View, text

LINES = 7
"""So many lines can be told apart."""
WIDE = 22
"""So many letters fit above one of two panels side by side."""
POINTS = 30
"""So many values of a setting without an order are drawn."""


class Quantity(NamedTuple):
    """What an axis shows."""

    name: str
    title: str
    scale: float
    log: bool


def quantities(view: View) -> list[Quantity]:
    """Give success, and what it takes, as axes show them."""
    success = Quantity("success", f"{view.measures.succeeded.lower()}, %", 100.0, False)
    return [success, *(_quantity(effort, view.cells) for effort in view.efforts)]


def _quantity(effort: Effort, cells: pd.DataFrame) -> Quantity:
    name = f"expected_{effort.name}"
    return Quantity(name, f"expected {effort.title}", effort.scale, wide(cells[name]))


def wide(values: pd.Series) -> bool:
    """Tell whether values ask for a logarithmic axis."""
    finite = values[np.isfinite(values.astype(float))].astype(float)
    return len(finite) > 0 and finite.min() > 0 and finite.max() >= 10 * finite.min()


def curves(view: View) -> Figure:
    """Draw success and what it takes over a setting, a line a map or method.

    Parameters
    ----------
    view : View
        A sweep over one setting, or over the choice of the method alone.

    Returns
    -------
    Figure
        A panel for success and one for each effort.
    """
    factor, shown = view.main, quantities(view)
    lines = list(view.series())[:LINES]
    look = looks_of([name for name, _ in lines])
    levels = _levels(view, factor)
    drawn = set(map(repr, levels))
    draw = _draw_curves if factor.numeric else _draw_points
    high = 1.75 if factor.numeric else 0.75 + (0.14 + 0.07 * len(lines)) * len(levels)
    with style():
        canvas = Canvas(figsize=(WIDTH, 0.6 + high * len(shown)), layout="constrained")
        axes = canvas.subplots(
            len(shown), 1, squeeze=False, sharex=factor.numeric, sharey=not factor.numeric
        )
        for panel, quantity in zip(axes.flat, shown, strict=True):
            for i, (name, rows) in enumerate(lines):
                mine = rows if factor.numeric else rows[rows[factor.name].map(repr).isin(drawn)]
                draw(panel, mine, (factor, quantity), look[name], (i, len(lines)))
            _finish(panel, factor, quantity, levels)
        if factor.numeric:
            axes.flat[-1].set_xlabel(factor.title)
        if len(lines) > 1:
            draw_legend(canvas, look, factor.numeric)
        svg, png = render(canvas)
    return Figure(
        f"{view.stem}_curves",
        _caption(view, shown, len(levels)),
        _alt(view, factor, lines),
        svg,
        png,
    )


def _levels(view: View, factor: Factor) -> list[Any]:
    """Give the values that are drawn; of many without an order those that succeed most."""
    if factor.numeric or len(factor.levels) <= POINTS:
        return list(factor.levels)
    return succeed_most(view, factor, POINTS)


def succeed_most(view: View, factor: Factor, most: int) -> list[Any]:
    """Give the values without an order that succeed most, in the order of the factor's levels."""
    names = view.cells[factor.name].map(repr)  # null is a value, too
    means = view.cells["success"].groupby(names).mean().sort_values(ascending=False, kind="stable")
    best = set(means.index[:most])
    return [level for level in factor.levels if repr(level) in best]


def _draw_curves(
    panel: Axes,
    rows: pd.DataFrame,
    what: tuple[Factor, Quantity],
    look: Look,
    place: tuple[int, int],
) -> None:
    """Draw a line with its interval as a band; where a trial never succeeded the line breaks."""
    factor, quantity = what
    rows = rows.assign(x=rows[factor.name].astype(float)).sort_values("x")
    values, low, high = _scaled(rows, quantity)
    few = len(rows) <= 20
    panel.plot(
        rows["x"], values, color=look.color, linestyle=look.dashes,
        marker="o" if few else None, markersize=3.5,
    )  # fmt: skip
    panel.fill_between(rows["x"], low, high, color=look.color, alpha=0.15, linewidth=0)
    never = rows.loc[np.isposinf(rows[quantity.name].astype(float)), "x"]
    _mark_never(panel, never, look.color, along="x")


def _draw_points(
    panel: Axes,
    rows: pd.DataFrame,
    what: tuple[Factor, Quantity],
    look: Look,
    place: tuple[int, int],
) -> None:
    """Draw a point with its interval for each value, beside those of the other lines."""
    factor, quantity = what
    i, count = place
    at = {repr(level): k for k, level in enumerate(factor.levels)}
    y = np.array([at[repr(value)] for value in rows[factor.name]], dtype=float)
    y += (i - (count - 1) / 2) * 0.7 / max(count, 2)
    values, low, high = _scaled(rows, quantity)
    panel.hlines(y, low, high, color=look.color, linewidth=1.3)
    panel.plot(values, y, "o", color=look.color, markersize=4)
    never = pd.Series(y)[np.isposinf(rows[quantity.name].astype(float)).to_numpy()]
    _mark_never(panel, never, look.color, along="y")


def _scaled(rows: pd.DataFrame, quantity: Quantity) -> tuple[Any, Any, Any]:
    names = (quantity.name, f"{quantity.name}_low", f"{quantity.name}_high")
    values = rows[list(names)].astype(float).replace(np.inf, np.nan) * quantity.scale
    return tuple(values[name].to_numpy() for name in names)


def _mark_never(panel: Axes, at: pd.Series, color: str, along: str) -> None:
    """Mark at the far edge of a panel where no trial succeeded."""
    if len(at):
        edge = np.full(len(at), 0.97)
        x, y = (at, edge) if along == "x" else (edge, at)
        transform = panel.get_xaxis_transform() if along == "x" else panel.get_yaxis_transform()
        panel.plot(x, y, "x", color=color, markersize=5, transform=transform, clip_on=False)


def _finish(panel: Axes, factor: Factor, quantity: Quantity, levels: list[Any]) -> None:
    rate = quantity.name == "success"
    if factor.numeric:
        numbers = pd.Series([float(str(level)) for level in levels])
        if wide(numbers):
            panel.set_xscale("log")
            plain(panel.xaxis)
        panel.set_title(quantity.title, loc="left")
        panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
        if quantity.log:
            panel.set_yscale("log")
            plain(panel.yaxis)
        if rate:
            panel.set_ylim(-4, 104)
        return
    places = {repr(level): k for k, level in enumerate(factor.levels)}
    panel.set_yticks([places[repr(level)] for level in levels], [text(level) for level in levels])
    panel.set_ylim(max(places.values()) + 0.6, -0.6)
    panel.set_title(quantity.title, loc="left")
    if quantity.log:
        panel.set_xscale("log")
        plain(panel.xaxis)
    if rate:
        panel.set_xlim(-4, 104)


def plain(axis: Any) -> None:
    """Write numbers of a logarithmic axis as numbers, and few of them."""
    low, high = axis.get_view_interval()
    decades = np.log10(high / low) if low > 0 else 1
    subs = (1, 2, 5) if decades < 1.5 else (1, 3) if decades < 2.5 else (1,)
    axis.get_major_locator().set_params(subs=subs, numticks=8)
    axis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
    axis.set_minor_formatter(NullFormatter())


def draw_legend(canvas: Canvas, look: dict[str, Look], dashed: bool) -> None:
    """Explain the lines, or the points, above the panels."""
    handles = [
        Line2D([], [], color=color, linestyle=dashes if dashed else "-",
               marker=None if dashed else "o", markersize=4, label=name)
        for name, (color, dashes) in look.items()
    ]  # fmt: skip
    longest = max(len(name) for name in look)
    cols = 1 if longest > 24 else 2 if longest > 12 else min(len(handles), 4)
    canvas.legend(handles=handles, loc="outside upper center", ncols=cols, handlelength=2.4)


def _caption(view: View, shown: list[Quantity], levels: int) -> str:
    factor = view.main
    success = view.measures.succeeded.lower()
    parts = [f"{success}, with the 95 % Wilson interval over {view.measures.unit}"]
    if len(shown) > 1:
        parts.append(
            f"what is expected to be spent until a success, if {view.measures.unit} that fail are "
            "done again, with the 95 % interval by the delta method; a cross at the edge: never"
        )
    left_out = []
    lines = len(list(view.series()))
    if lines > LINES:
        left_out.append(f"the first {LINES} of {lines} lines are drawn")
    if levels < len(factor.levels):
        left_out.append(f"the {levels} of {len(factor.levels)} values that succeed most are drawn")
    more = f" Of these {' and '.join(left_out)}; the table has all." if left_out else ""
    n = view.cells["n"]
    each = number(n.min()) if n.min() == n.max() else f"{number(n.min())} to {number(n.max())}"
    return f"By {factor.title}: {'; '.join(parts)}. {each} {view.measures.unit} each.{more}"


def _alt(view: View, factor: Factor, lines: list[tuple[str, pd.DataFrame]]) -> str:
    kind = "Curves over" if factor.numeric else "Points for each value of"
    sentences = []
    for name, rows in lines:
        best = rows.loc[rows["success"].astype(float).idxmax()]
        worst = rows.loc[rows["success"].astype(float).idxmin()]
        sentences.append(
            f"{name}: from {percent(worst['success'])} % at {text(worst[factor.name])} to "
            f"{percent(best['success'])} % at {text(best[factor.name])}."
        )
    word = view.measures.succeeded.lower()
    return f"{kind} {factor.title}, of the share {word} and what it takes. {' '.join(sentences)}"
