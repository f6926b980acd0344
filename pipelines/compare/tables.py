"""What a comparison comes to in tables: all numbers for programs, the best ones for people."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.compare.words import WORDINGS, effect_span, points, probability
from gapath.pipelines.numbers.comparing.comparison import Comparison, Estimate, Pair, estimates
from gapath.pipelines.numbers.comparing.groups import side_by_side
from gapath.pipelines.numbers.text import NOTHING, number
from gapath.pipelines.page.section import Table
from gapath.pipelines.papers.names import label

_BY_MAP = ("success", "expected_evaluations", "expected_time")


def pairs_frame(comparisons: Sequence[Comparison]) -> pd.DataFrame:
    """Give all pairs of groups in all quantities, as plain numbers.

    Parameters
    ----------
    comparisons : sequence of Comparison
        One a quantity.

    Returns
    -------
    DataFrame
        One row a pair and quantity: the groups and how many trials they have; pairs of trials, 0 if
        unpaired; the test; its effect, which is a difference of rates for success and else the
        ratio of the first to the second, with its interval; A12; pairs without a difference; p, p
        after Holm, whether they are told apart; the test of all groups and its p; what is missing.
    """
    rows = []
    for comparison in comparisons:
        n = {each.group: each.n for each in comparison.estimates}
        every = comparison.omnibus
        for pair in comparison.pairs:
            found = pair.difference
            rows.append(
                {
                    "quantity": comparison.quantity,
                    "first": pair.first,
                    "second": pair.second,
                    "n_first": n[pair.first],
                    "n_second": n[pair.second],
                    "pairs": pair.pairs,
                    "test": found.test,
                    "effect": found.effect,
                    "low": found.low,
                    "high": found.high,
                    "a12": found.a12,
                    "zeros": found.zeros,
                    "p": found.p,
                    "p_holm": pair.adjusted,
                    "apart": pair.apart,
                    "test_of_all": every.test if every else None,
                    "p_of_all": every.p if every else None,
                    "why": found.why,
                }
            )
    return pd.DataFrame(rows)


def groups_frame(comparisons: Sequence[Comparison]) -> pd.DataFrame:
    """Give each group's own numbers: one row a group and quantity, best first."""
    rows = [
        {"quantity": comparison.quantity, **each._asdict()}
        for comparison in comparisons
        for each in comparison.estimates
    ]
    return pd.DataFrame(rows)


def shown(comparison: Comparison, by: str) -> pd.DataFrame:
    """Write a quantity for people: each group, and how it does against the best one.

    Parameters
    ----------
    comparison : Comparison
        The quantity.
    by : str
        What tells the groups apart.

    Returns
    -------
    DataFrame
        Text; one row a group, best first.
    """
    quantity = comparison.quantity
    against = {pair.second: pair for pair in comparison.against_best()}
    ranked = sum(each.rank is not None for each in comparison.estimates) > 2
    rows = []
    for each in comparison.estimates:
        value, interval = _own(each, quantity)
        row = {by: each.group, "Trials": number(each.n), _heading(quantity): value}
        row["95 %"] = interval
        if ranked and quantity != "success":
            row["Mean rank"] = NOTHING if each.rank is None else number(each.rank)
        rows.append(row | _against(against.get(each.group), quantity))
    return pd.DataFrame(rows).fillna("")


def _heading(quantity: str) -> str:
    wording = WORDINGS[quantity]
    return f"{wording.short}, {wording.unit}".removesuffix(", ")


def _own(each: Estimate, quantity: str) -> tuple[str, str]:
    """Write a group's value and its interval, without their unit."""
    wording = WORDINGS[quantity]
    value = interval = NOTHING
    if each.value is not None:
        value = wording.value(each.value)
    if each.low is not None and each.high is not None:
        interval = wording.span(each.low, each.high)
    return value.removesuffix(f" {wording.unit}"), interval.removesuffix(f" {wording.unit}")


def _against(pair: Pair | None, quantity: str) -> dict[str, str]:
    """Write how a group does against the best one; nothing of the best itself."""
    if pair is None:
        return {}
    mine = pair if quantity == "success" else pair.swapped()
    found = mine.difference
    effect = NOTHING
    if found.effect is not None:
        effect = points(found.effect) if quantity == "success" else number(found.effect)
    told = NOTHING if pair.adjusted is None else probability(pair.adjusted).removeprefix("p = ")
    return {
        "Points behind" if quantity == "success" else "Times the best": effect,
        "95 % of it": effect_span(mine, quantity) or NOTHING,
        **({} if found.a12 is None else {"A12": f"{found.a12:.2f}"}),
        "p (Holm)": told.removeprefix("p "),
        "Pairs": number(pair.pairs) if pair.pairs else "unpaired",
        "Told apart": "yes" if pair.apart else "no",
    }


def whole_table(comparisons: Sequence[Comparison], by: str, caption: str) -> Table:
    """Give all quantities as one table of the report.

    Parameters
    ----------
    comparisons : sequence of Comparison
        One a quantity.
    by : str
        What tells the groups apart.
    caption : str
        What was compared.

    Returns
    -------
    Table
        Its data has all pairs, what is shown each group against the best one.
    """
    parts = []
    for comparison in comparisons:
        part = shown(comparison, by)
        heading = _heading(comparison.quantity)
        best = dict.fromkeys(("Points behind", "Times the best"), "Against the best")
        part = part.rename(columns={heading: "Value", **best})
        part.insert(0, "Quantity", heading)
        parts.append(part)
    rows = pd.concat(parts, ignore_index=True).fillna("")
    return Table("comparison", caption, pairs_frame(comparisons), rows)


def table_by_map(
    trials: pd.DataFrame, success: str, group: pd.Series, also: Sequence[str], by: str
) -> Table | None:
    """Give each group's own numbers on each map; None where there is one problem only.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.
    success : str
        The task's column that says whether a trial succeeded.
    group : Series
        The group of each trial.
    also : sequence of str
        As `side_by_side` has it.
    by : str
        What tells the groups apart.

    Returns
    -------
    Table or None
        One row a map, its start and target, and group; instances of a class of maps together.
    """
    places = ["map", "map_source", "start", "target"]
    parts = list(trials.groupby(places, sort=True))
    if len(parts) < 2:
        return None
    data, text = [], []
    for (name, source, start, target), part in parts:
        groups = side_by_side(part, success, group[part.index], also)
        found = {quantity: estimates(groups, quantity) for quantity in _BY_MAP}
        for at, own in enumerate(groups.names):
            mine = {quantity: found[quantity][at] for quantity in _BY_MAP}
            if not mine["success"].n:
                continue
            row = {"map": name, "start": start, "target": target, "group": own}
            row["n"] = mine["success"].n
            cells = {
                "Map": label(name, source),
                "From, to": f"{start} {target}",
                by: own,
                "Trials": number(row["n"]),
            }
            for quantity, each in mine.items():
                row |= {quantity: each.value, f"{quantity}_low": each.low,
                        f"{quantity}_high": each.high}  # fmt: skip
                value, interval = _own(each, quantity)
                cells[_heading(quantity)] = f"{value} ({interval})".removesuffix(f" ({NOTHING})")
            data.append(row)
            text.append(cells)
    caption = "Each map by itself, with 95 % intervals over its trials."
    return Table("maps", caption, pd.DataFrame(data), pd.DataFrame(text), heads=3)
