"""What a comparison comes to in pictures."""

from collections.abc import Iterator, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from gapath.pipelines.compare.words import WORDINGS
from gapath.pipelines.numbers.comparison import Comparison, Estimate, Pair
from gapath.pipelines.numbers.pairwise import LEVEL
from gapath.pipelines.page.figures import WIDTH, render, style
from gapath.pipelines.page.section import Figure

_APART, _ALIKE, _BEST = "#D55E00", "#0072B2", "#009E73"
_FEW = 20
"""More groups than these stand closer together."""

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
        For each quantity that has numbers the groups with their intervals, and how they do against
        the best one; then mean ranks, if there are three groups or more that differ.
    """
    with style():
        found = [
            _intervals(each, by, order)
            for each in comparisons
            if each.best is not None and each.pairs
        ]
        ranked = [each for each in comparisons if _has_ranks(each)]
        return [*found, *([_ranks(ranked, by)] if ranked else [])]


def _intervals(comparison: Comparison, by: str, order: Sequence[str]) -> Figure:
    best, quantity = comparison.best, comparison.quantity
    assert best is not None
    wording = WORDINGS[quantity]
    scale = {"%": 100, "ms": 1000}.get(wording.unit, 1)
    known = {each.group: each for each in comparison.estimates if each.value is not None}
    names = [name for name in order if name in known]
    pairs = {pair.second: pair for pair in comparison.against_best()}
    few = len(names) <= _FEW
    canvas = Canvas(figsize=(WIDTH, 1 + (0.24 if few else 0.14) * len(names)))
    left, right = canvas.subplots(1, 2, sharey=True)
    for place, name in enumerate(names):
        color = _BEST if name == best.group else _color(pairs[name])
        _bar(left, place, _own(known[name], scale), color)
        if name in pairs:
            _bar(right, place, _against(pairs[name], quantity), color)
    left.set_yticks(range(len(names)), names, fontsize=10 if few else 7)
    left.set_ylim(len(names) - 0.5, -0.5)
    left.set_ylabel(by)
    unit = f", {wording.unit}" if wording.unit else ""
    left.set_xlabel(f"{wording.short}{unit}")
    right.axvline(0 if quantity == "success" else 1, color="#888888", linewidth=1)
    behind = f"points behind {best.group}" if quantity == "success" else f"times {best.group}"
    right.set_xlabel(behind)
    svg, png = render(canvas)
    caption = (
        f"{wording.title}, with 95 % intervals; on the right against the best. Green: the best; "
        "orange: told apart from it (Holm); blue: not."
    )
    values = ", ".join(f"{name} {wording.value(known[name].value or 0)}" for name in names)
    return Figure(f"comparison_{quantity}", caption, f"{wording.title}: {values}", svg, png)


def _color(pair: Pair) -> str:
    return _APART if pair.apart else _ALIKE


_Bar = tuple[float, float | None, float | None]


def _own(each: Estimate, scale: float) -> _Bar:
    low, high = (None if end is None else scale * end for end in (each.low, each.high))
    return scale * (each.value or 0), low, high


def _against(pair: Pair, quantity: str) -> _Bar | None:
    mine = pair if quantity == "success" else pair.swapped()
    found, scale = mine.difference, 100 if quantity == "success" else 1
    if found.effect is None:
        return None
    low, high = (None if end is None else scale * end for end in (found.low, found.high))
    return scale * found.effect, low, high


def _bar(panel: Axes, place: int, bar: _Bar | None, color: str) -> None:
    if bar is None:
        return
    value, low, high = bar
    if low is not None and high is not None:
        panel.plot([low, high], [place, place], color=color, linewidth=1.4)
    panel.plot(value, place, "o", color=color, markersize=4)


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
        panel.plot([low - 0.03, high + 0.03], [level, level], color="black", linewidth=3)
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
