"""What a comparison says, in sentences."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from gapath.pipelines.numbers.comparing.comparison import Comparison, Estimate, Pair
from gapath.pipelines.numbers.comparing.omnibus import Omnibus
from gapath.pipelines.numbers.comparing.pairwise import LEVEL
from gapath.pipelines.numbers.text import number, percent, percent_range, span

_FEW = 5
"""More groups than these are summed up in a sentence."""

_FINDS = {"feasible": "finds a path", "reached": "reaches the target"}
"""What a trial that succeeds does, by the column that says so."""


_BY = {
    "McNemar, exact": "by the exact test of pairs",
    "score test": "by the score test",
    "Fisher, exact": "by the exact test",
    "Wilcoxon, signed rank": "by the ranks of all differences",
    "Mann-Whitney": "by the ranks of all trials",
    "bootstrap": "by the standard error",
}
"""What a test goes by, where an interval says something else."""


class Wording(NamedTuple):
    """How a quantity is written."""

    title: str
    short: str
    unit: str
    least: str
    """What the best group does, of amounts."""
    amount: str
    """What another one has, so many times as much."""

    def value(self, value: float) -> str:
        """Write a value with its unit."""
        return self.span(value, value)

    def span(self, low: float, high: float) -> str:
        """Write a range with its unit."""
        if self.unit == "%":
            text = percent(low) if low == high else percent_range((low, high))
        else:
            factor = 1000 if self.unit == "ms" else 1
            text = span(factor * low, factor * high)
        return f"{text} {self.unit}".rstrip()


_COUNTED = ("", "needs the fewest", "needs {} times as many")
_TIMED = ("ms", "is the fastest", "takes {} times as long")
_PRICED = ("", "has the least", "has {} times as much")
WORDINGS = {
    "success": Wording("Success", "Success", "%", "", ""),
    "evaluations": Wording(
        "Evaluations of a trial, failures included, median", "Evaluations", *_COUNTED
    ),
    "expected_evaluations": Wording(
        "Expected evaluations for each success", "Expected evaluations", *_COUNTED
    ),
    "time": Wording("Time of a trial, failures included, median", "Time", *_TIMED),
    "expected_time": Wording("Expected time for each success", "Expected time", *_TIMED),
    "cost": Wording("Cost of trials that succeeded, median", "Cost", *_PRICED),
}
"""Each quantity's words."""


def probability(p: float) -> str:
    """Write a p-value."""
    return "p < 0.001" if p < 0.001 else f"p = {p:.2g}"


def points(effect: float) -> str:
    """Write a difference of rates in points of a percent."""
    return f"{round(100 * effect, 1) + 0.0:.1f}".removesuffix(".0")


def effect_span(pair: Pair, quantity: str) -> str:
    """Write the interval of a pair's effect; nothing where there is none."""
    low, high = pair.difference.low, pair.difference.high
    if low is None or high is None:
        return ""
    if quantity == "success":
        return f"{points(low)} to {points(high)}"
    return f"{number(low)} to {number(high)}"


def sentences(comparison: Comparison, success: str) -> list[str]:
    """Say what was found of one quantity.

    Parameters
    ----------
    comparison : Comparison
        The quantity and the groups.
    success : str
        The task's column that says whether a trial succeeded.

    Returns
    -------
    list of str
        The best group; those that are told apart from it and those that are not; whether the
        groups differ at all; what is missing, and why.
    """
    return [*_found(comparison, success), *_missing(comparison)]


def _found(comparison: Comparison, success: str) -> Iterable[str]:
    best = comparison.best
    if best is None:
        return
    quantity = comparison.quantity
    against = comparison.against_best()
    yield _leading(comparison, best, success)
    if comparison.omnibus is not None:
        yield _differing(comparison.omnibus, len(against) + 1)
    apart = [pair for pair in against if pair.apart]
    alike = [pair for pair in against if not pair.apart and pair.difference.p is not None]
    if apart:
        yield _apart(apart, quantity, success)
    if alike:
        yield _alike(alike, quantity)


def _leading(comparison: Comparison, best: Estimate, success: str) -> str:
    wording = WORDINGS[comparison.quantity]
    assert best.value is not None
    value = wording.value(best.value)
    tied = [
        each for each in comparison.estimates if (each.value, each.rank) == (best.value, best.rank)
    ]
    of_all = len({(each.low, each.high) for each in tied}) == 1
    if of_all and best.low is not None and best.high is not None:
        value += f" ({wording.span(best.low, best.high).removesuffix(' %')})"
    if len(tied) > 1:
        return f"{some([each.group for each in tied])} share the first place: {value}."
    does = _FINDS.get(success, "succeeds") + " most often"
    if comparison.quantity != "success":
        does = wording.least
    if comparison.by_rank and best.rank is not None:
        known = sum(each.rank is not None for each in comparison.estimates)
        value = f"mean rank {number(best.rank)} of {known}; {value}"
    return f"{best.group} {does}: {value}."


def _differing(omnibus: Omnibus, count: int) -> str:
    over = f" over {omnibus.blocks} blocks" if omnibus.blocks else ""
    if omnibus.p is None:
        return f"Whether the {count} groups differ at all is not known: {omnibus.why}."
    if omnibus.why:
        return f"The {count} groups do not differ: {omnibus.why}."
    told = f"{omnibus.test}{over}, {probability(omnibus.p)}"
    if omnibus.p < LEVEL:
        return f"The {count} groups differ ({told})."
    return f"The {count} groups do not differ noticeably ({told}), so no two are told apart."


def _apart(pairs: Sequence[Pair], quantity: str, success: str) -> str:
    best = pairs[0].first
    if len(pairs) > _FEW:
        shown = sorted(pairs, key=lambda pair: abs(_size(pair, quantity)))
        near, far = shown[0], shown[-1]
        return (
            f"{best} is told apart from {len(pairs)} others, least of all from "
            f"{near.second} ({_more(near, quantity)}), most from {far.second} "
            f"({_more(far, quantity)})."
        )
    if quantity == "success":
        does = _FINDS.get(success, "succeeds").partition(" ")[0]
        each = [f"{_more(pair, quantity)}" for pair in pairs]
        parts = [
            text.replace(" points", f" points more than {pair.second}", 1)
            for text, pair in zip(each, pairs, strict=True)
        ]
        return f"{best} {does} {_listed(parts)}."
    return f"{_listed([f'{pair.second} {_more(pair, quantity)}' for pair in pairs])}."


def _alike(pairs: Sequence[Pair], quantity: str) -> str:
    best, by = pairs[0].first, _counted(pairs)
    if len(pairs) > _FEW:
        return f"{best} cannot be told apart{by} from {some([pair.second for pair in pairs])}."
    names = [f"{pair.second} ({_sized(pair, quantity)})" for pair in pairs]
    return f"{best} cannot be told apart{by} from {_listed(names)}."


def _counted(pairs: Sequence[Pair]) -> str:
    least, most = (end(pair.pairs for pair in pairs) for end in (min, max))
    if not most:
        return " by trials without pairs"
    return f" by {span(least, most)} pairs of trials" if least else ""


def _sized(pair: Pair, quantity: str) -> str:
    """Say how large a difference is, without saying that there is one."""
    told = probability(pair.adjusted) if pair.adjusted is not None else ""
    told += _although(pair, quantity)
    if pair.difference.effect is None:
        return told
    if quantity != "success":
        pair = pair.swapped()
    assert pair.difference.effect is not None
    size = (
        f"{points(pair.difference.effect)} points"
        if quantity == "success"
        else f"{number(pair.difference.effect)} times"
    )
    return ", ".join(each for each in (size, effect_span(pair, quantity), told) if each)


def _although(pair: Pair, quantity: str) -> str:
    """Say why two cannot be told apart although the interval of the effect leaves that out."""
    found, equal = pair.difference, 0 if quantity == "success" else 1
    if found.p is None or pair.adjusted is None or pair.adjusted < LEVEL:
        return ""
    if found.low is None or found.high is None or found.low <= equal <= found.high:
        return ""
    return f" {_BY[found.test]}" if found.p >= LEVEL else f", {probability(found.p)} before Holm"


def _size(pair: Pair, quantity: str) -> float:
    effect = pair.difference.effect
    if effect is None:
        return 0.0
    return effect if quantity == "success" else max(effect, 1 / effect)


def _more(pair: Pair, quantity: str) -> str:
    """Say how a group does against the best, which stands first."""
    told = probability(pair.adjusted) if pair.adjusted is not None else ""
    if pair.difference.effect is None:
        return f"differs in rank, {told}"
    if quantity != "success":
        pair = pair.swapped()
    inner = "; ".join(each for each in (effect_span(pair, quantity), told) if each)
    assert pair.difference.effect is not None
    if quantity == "success":
        return f"{points(pair.difference.effect)} points ({inner})"
    times = number(pair.difference.effect)
    amount = WORDINGS[quantity].amount.format(times)
    if times == "1" and pair.difference.a12 is not None:
        share = percent(pair.difference.a12)
        amount = f"has more in {share} % of all pairings of trials, the same in the median pair"
    return f"{amount} ({inner})"


def _missing(comparison: Comparison) -> Iterable[str]:
    reasons: dict[str, list[str]] = {}
    for each in comparison.estimates:
        if each.why:
            reasons.setdefault(each.why, []).append(each.group)
    for why, groups in reasons.items():
        yield f"{some(groups)}: {why}."
    known = {each.group for each in comparison.estimates if each.value is not None}
    if len(known) == 1 and len(comparison.estimates) > 1:
        yield f"Only {known.pop()} has a number, so there is nothing to compare it with."
    pairs: dict[str, list[str]] = {}
    for pair in comparison.pairs:
        if pair.difference.p is None:
            pairs.setdefault(pair.difference.why, []).append(f"{pair.first} and {pair.second}")
    for why, names in pairs.items():
        yield f"No test of {some(names)}: {why}."


def some(names: Sequence[str]) -> str:
    """List names, the first few of many."""
    if len(names) <= _FEW:
        return _listed(names)
    return f"{', '.join(names[:_FEW])} and {len(names) - _FEW} more"


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
