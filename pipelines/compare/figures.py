"""What a comparison comes to in pictures."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from gapath.pipelines.compare.words import WORDINGS
from gapath.pipelines.numbers.comparing.comparison import Comparison, Estimate, Pair
from gapath.pipelines.numbers.comparing.pairwise import LEVEL
from gapath.pipelines.page.figures import WIDTH, render, style
from gapath.pipelines.page.section import Figure

_APART, _ALIKE, _BEST = "#D55E00", "#0072B2", "#009E73"
_FEW = 20
"""More groups than these stand side by side, not all of them with their names."""

_DRAWN = ("success", "expected_evaluations", "expected_time", "cost")
"""What is spent in a trial differs much from trial to trial: that is what ranks are for."""

_RANKED = 12
"""Of more groups ranks would not be legible."""


def figures(comparisons: Sequence[Comparison], by: str, order: Sequence[str]) -> list[Figure]:
    """Draw what was found.

    Parameters
    ----------
    comparisons : sequence of Comparison
        One a quantity.
    by : str
        What tells the groups apart.
    order : sequence of str
        The groups, as they stand below each other.

    Returns
    -------
    list of Figure
        For success, the expected amounts and the cost the groups with their intervals, and how
        they do against the best one; then mean ranks, if three groups or more differ.
    """
    with style():
        found = [
            _intervals(each, by, order)
            for each in comparisons
            if each.pairs and each.quantity in _DRAWN
        ]
        ranked = [each for each in comparisons if _has_ranks(each)]
        return [*found, *([_ranks(ranked, by)] if ranked else [])]


def _intervals(comparison: Comparison, by: str, order: Sequence[str]) -> Figure:
    best, quantity = comparison.best, comparison.quantity
    assert best is not None
    wording = WORDINGS[quantity]
    known = {each.group: each for each in comparison.estimates if each.value is not None}
    names = [name for name in order if name in known]
    pairs = {pair.second: pair for pair in comparison.against_best()}
    colors = [_BEST if name == best.group else _color(pairs[name]) for name in names]
    scale = {"%": 100, "ms": 1000}.get(wording.unit, 1)
    own = [_scaled(known[name][2:5], scale) for name in names]
    against = [_against(pairs.get(name), quantity) for name in names]
    title = f"{wording.short}, {wording.unit}".removesuffix(", ")
    behind = f"points behind {best.group}" if quantity == "success" else f"times {best.group}"
    equal = 0 if quantity == "success" else 1
    if len(names) <= _FEW:
        canvas = Canvas(figsize=(WIDTH, 1 + 0.24 * len(names)))
        left, right = canvas.subplots(1, 2, sharey=True)
        for panel, bars, text in ((left, own, title), (right, against, behind)):
            _draw(panel.hlines, panel.scatter, bars, colors)
            panel.set_xlabel(text)
        right.axvline(equal, color="#888888", linewidth=1)
        left.set_yticks(range(len(names)), names)
        left.set_ylim(len(names) - 0.5, -0.5)
        left.set_ylabel(by)
    else:
        canvas = Canvas(figsize=(WIDTH, 4.6))
        upper, lower = canvas.subplots(2, 1, sharex=True)
        for panel, bars, text in ((upper, own, title), (lower, against, behind)):
            _draw(panel.vlines, _upright(panel), bars, colors)
            panel.set_ylabel(text)
        lower.axhline(equal, color="#888888", linewidth=1)
        step = -(-len(names) // 8)
        lower.set_xticks(range(0, len(names), step), names[::step], rotation=20, ha="right")
        lower.set_xlabel(by)
    svg, png = render(canvas)
    caption = (
        f"{wording.title}, with 95 % intervals; then against the best. Green: the best; orange: "
        "told apart from it (Holm); blue and hollow: not."
    )
    values = ", ".join(f"{name} {wording.value(known[name].value or 0)}" for name in names)
    return Figure(f"comparison_{quantity}", caption, f"{wording.title}: {values}", svg, png)


def _color(pair: Pair) -> str:
    return _APART if pair.apart else _ALIKE


_Bar = tuple[float, float, float]
"""A value and the ends of its interval; NaN is not drawn."""


def _scaled(numbers: Iterable[float | None], scale: float) -> _Bar:
    value, low, high = (math.nan if each is None else scale * each for each in numbers)
    return value, low, high


def _against(pair: Pair | None, quantity: str) -> _Bar:
    if pair is None:
        return math.nan, math.nan, math.nan
    found = (pair if quantity == "success" else pair.swapped()).difference
    return _scaled((found.effect, found.low, found.high), 100 if quantity == "success" else 1)


def _draw(
    lines: Callable[..., object],
    points: Callable[..., object],
    bars: Sequence[_Bar],
    colors: Sequence[str],
) -> None:
    """Draw values and intervals with two calls: many artists would take long."""
    value, low, high = np.array(bars).T
    places = np.arange(len(bars))
    lines(places, low, high, colors=colors, linewidth=1.4)
    inner = ["white" if color == _ALIKE else color for color in colors]
    points(value, places, facecolors=inner, edgecolors=colors, s=16, zorder=3)


def _upright(panel: Axes) -> Callable[..., object]:
    return lambda value, places, **look: panel.scatter(places, value, **look)


def _has_ranks(comparison: Comparison) -> bool:
    every = comparison.omnibus
    ranked = [each for each in comparison.estimates if each.rank is not None]
    differ = every is not None and every.p is not None and every.p < LEVEL
    return differ and comparison.quantity != "success" and 2 < len(ranked) <= _RANKED


def _ranks(comparisons: Sequence[Comparison], by: str) -> Figure:
    """Draw mean ranks on a line, groups that are not told apart joined (Demsar 2006)."""
    most = max(len(each.estimates) for each in comparisons)
    height = 0.75 + 0.11 * most
    canvas = Canvas(figsize=(WIDTH, height * len(comparisons)))
    panels = canvas.subplots(len(comparisons), 1, squeeze=False)[:, 0]
    canvas.subplots_adjust(hspace=0.35)
    for panel, comparison in zip(panels, comparisons, strict=True):
        _rank_line(panel, comparison)
    svg, png = render(canvas)
    titles = ", ".join(WORDINGS[each.quantity].short.lower() for each in comparisons)
    caption = (
        f"Mean ranks of {by} in blocks of trials, 1 for the least: {titles}. A bar joins groups of "
        "which no two are told apart (Wilcoxon, Holm)."
    )
    alt = "; ".join(
        f"{WORDINGS[each.quantity].short}: "
        + ", ".join(f"{own.group} {own.rank:.2f}" for own in _by_rank(each) if own.rank)
        for each in comparisons
    )
    return Figure("comparison_ranks", caption, alt, svg, png)


def _by_rank(comparison: Comparison) -> list[Estimate]:
    ranked = [each for each in comparison.estimates if each.rank is not None]
    return sorted(ranked, key=lambda each: each.rank or 0)


def _rank_line(panel: Axes, comparison: Comparison) -> None:
    ranked = _by_rank(comparison)
    k = len(ranked)
    half = -(-k // 2)
    bars = list(_cliques(ranked, comparison.pairs))
    below = 0.5 + 0.35 * len(bars)
    panel.set_title(WORDINGS[comparison.quantity].short, loc="left")
    panel.plot([1, k], [0, 0], color="black", linewidth=1)
    for tick in range(1, k + 1):
        panel.plot([tick, tick], [0, -0.2], color="black", linewidth=1)
        panel.text(tick, -0.3, str(tick), ha="center", va="bottom", fontsize=8)
    for place, each in enumerate(ranked):
        assert each.rank is not None
        left = place < half
        level = below + 0.7 * (place if left else k - 1 - place)
        end = 0.9 if left else k + 0.1
        panel.plot([each.rank, each.rank, end], [0, level, level], color="#555555", linewidth=1)
        side = "right" if left else "left"
        text = f"{each.group} " if left else f" {each.group}"
        panel.text(end, level, text, ha=side, va="center", fontsize=9)
    for at, (low, high) in enumerate(bars):
        level = 0.3 + 0.35 * at
        panel.plot([low, high], [level, level], color="black", linewidth=3, solid_capstyle="butt")
    panel.set_xlim(1 - 0.35 * (k - 1), k + 0.35 * (k - 1))
    panel.set_ylim(below + 0.7 * half, -0.9)
    panel.set_axis_off()


def _cliques(ranked: Sequence[Estimate], pairs: Sequence[Pair]) -> Iterator[tuple[float, float]]:
    """Give the ends of the longest stretches of which no two groups are told apart."""
    apart = {frozenset((pair.first, pair.second)) for pair in pairs if pair.apart}
    last = 0
    for start in range(len(ranked)):
        end = start + 1
        while end < len(ranked) and not any(
            frozenset((each.group, ranked[end].group)) in apart for each in ranked[start:end]
        ):
            end += 1
        if end - start > 1 and end > last:
            yield ranked[start].rank or 0, ranked[end - 1].rank or 0
            last = end
