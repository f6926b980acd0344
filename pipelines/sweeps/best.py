"""Which of a sweep's methods is best on each map, and whether the next can be told from it."""

from collections.abc import Iterator
from itertools import chain
from typing import NamedTuple

import numpy as np
import pandas as pd

from gapath.pipelines.numbers.comparing.comparison import Comparison, Pair, compare
from gapath.pipelines.numbers.comparing.groups import side_by_side
from gapath.pipelines.numbers.text import NOTHING, number
from gapath.pipelines.page.section import Table
from gapath.pipelines.sweeps.cells import wilson_of
from gapath.pipelines.sweeps.measures import Effort
from gapath.pipelines.sweeps.view import EVERYWHERE, View, amount, rate, rounded, text

_HELD = 12
"""The best are held against one another, not more than so many."""
_QUANTITIES = {"evaluations": "expected_evaluations", "seconds": "expected_time"}
"""What a comparison calls what efforts are expected to be."""


class Best(NamedTuple):
    """The best method on a map, by success or by an effort, and those held against it."""

    place: str
    """The map; `EVERYWHERE` for all together."""
    effort: Effort | None
    """What it is best in; None: success."""
    row: pd.Series
    """Its cell."""
    next: pd.Series
    """The next one's."""
    pairs: list[Pair]
    """The best with each of the others."""

    @property
    def apart(self) -> bool:
        """Whether the next can be told from it."""
        return any(pair.apart for pair in self.pairs if pair.second == self.next["method"])

    @property
    def alike(self) -> list[str]:
        """The others that cannot be told from it."""
        return [pair.second for pair in self.pairs if not pair.apart]


def find_best(view: View) -> list[Best]:
    """Find on each map the best method by success, and by what is expected to be spent.

    Those that succeed alike are sorted by the effort. Only the best dozen are held against one
    another, by tests that pair trials of one problem and seed, with Holm's correction over them.

    Parameters
    ----------
    view : View
        A sweep.

    Returns
    -------
    list of Best
        Two a map, or one of a task without efforts, and by success one on all maps together;
        none without a second method.
    """
    parts = [(place, view.cells[view.cells["place"] == place]) for place in view.sweep.places]
    found = []
    for place, rows in parts:
        if len(rows) > 1:
            found += [_best(view, place, *order) for order in _orders(view, rows)]
    together = _together(view)
    if len(parts) > 1 and len(together) > 1:
        found.append(_best(view, EVERYWHERE, together, None))
    return found


def _orders(view: View, rows: pd.DataFrame) -> Iterator[tuple[pd.DataFrame, Effort | None]]:
    """Give cells best first: by success, then by the first effort that all of them have."""
    every = [each for each in view.efforts if rows[f"expected_{each.name}"].notna().all()]
    names = [f"expected_{each.name}" for each in every[:1]]
    ascending = [False, *(True for _ in names)]
    yield rows.sort_values(["success", *names], ascending=ascending, kind="stable"), None
    compared = [each for each in every if each.name in _QUANTITIES]
    if compared and rows["succeeded"].any():
        effort = compared[0]
        yield rows.sort_values(f"expected_{effort.name}", kind="stable"), effort


def _together(view: View) -> pd.DataFrame:
    """Sum up, over all maps, the methods that were tried on each; best first."""
    groups = view.cells.groupby("method", sort=False)
    everywhere = groups.size() == len(view.sweep.places)
    spent = [f"{effort.name}_total" for effort in view.efforts]
    sums = groups[["n", "succeeded", *spent]].sum()
    sums["runs"] = groups["runs"].agg(lambda runs: tuple(sorted(set(chain.from_iterable(runs)))))
    rows = groups.first().assign(**sums)[everywhere].reset_index()
    rows["success"] = rows["succeeded"] / rows["n"]
    low, high = wilson_of(rows["success"].to_numpy(), rows["n"].to_numpy())
    chance = rows["success_low"].notna()
    rows["success_low"], rows["success_high"] = np.where(chance, (low, high), np.nan)
    least = spent[-1:]  # every method has spent time
    ascending = [False, *(True for _ in least)]
    return rows.sort_values(["success", *least], ascending=ascending, kind="stable")


def _best(view: View, place: str, rows: pd.DataFrame, effort: Effort | None) -> Best:
    quantity = _QUANTITIES[effort.name] if effort else "success"
    held = rows.iloc[:_HELD]
    pairs = _compared(view, place, list(held["method"]), quantity).against_best()
    return Best(place, effort, rows.iloc[0], rows.iloc[1], pairs)


def _compared(view: View, place: str, methods: list[str], quantity: str) -> Comparison:
    cells = view.cells[view.cells["method"].isin(methods)]
    if place != EVERYWHERE:
        cells = cells[cells["place"] == place]
    trials = view.trials[view.trials["cell"].isin(cells["cell"])]
    names = dict(zip(cells["cell"], cells["method"], strict=True))
    group = pd.Categorical(trials["cell"].map(names), categories=methods)
    groups = side_by_side(trials, view.measures.success, pd.Series(group, index=trials.index))
    return compare(groups, quantity)


def sentences(view: View, found: list[Best]) -> list[str]:
    """Say in words which is best, where there is one map only."""
    if len(view.sweep.places) > 1:
        return []
    return [_sentence(view, each) for each in found]


def _sentence(view: View, best: Best) -> str:
    word = view.measures.succeeded.lower()
    what = f"Most often {word}" if best.effort is None else f"Least expected {best.effort.title}"
    unit = " %" if best.effort is None else ""
    others = len(best.alike) - (not best.apart)
    told = "can be told from it" if best.apart else "cannot be told from it"
    more = f", nor can {others} of the {len(best.pairs) - 1} after it" if others else ""
    return (
        f"{what}: {named(view, best.row)}, {value_of(best)}{unit}. "
        f"The next, {named(view, best.next)}, {told}{more}."
    )


def value_of(best: Best) -> str:
    """Write the best one's number, with its interval."""
    if best.effort is None:
        return rate(best.row)
    return amount(best.row, best.effort)


def named(view: View, row: pd.Series) -> str:
    """Name a method by what varied."""
    sweep = view.sweep
    if not sweep.factors:
        return text(row[sweep.choice])
    return ", ".join(
        text(row[factor.name])
        if factor.name == sweep.choice
        else f"{factor.title} {text(row[factor.name])}"
        for factor in sweep.factors
    )


def best_table(view: View, found: list[Best]) -> list[Table]:
    """List the best of each map; none where no map has two methods."""
    if not found:
        return []
    word = view.measures.succeeded
    lines, data = [], []
    for best in found:
        pair = next((p for p in best.pairs if p.second == best.next["method"]), None)
        by = word if best.effort is None else f"Expected {best.effort.title}"
        place = view.labels.get(best.place, "All maps")
        name = "success" if best.effort is None else f"expected_{best.effort.name}"
        lines.append(
            {
                "Map": place,
                "By": by,
                "Best": named(view, best.row),
                "Its number": value_of(best),
                "Next": named(view, best.next),
                "Difference": _difference(best, pair),
                "Told apart": "yes" if best.apart else "no",
                "Not told from it": f"{len(best.alike)} of {len(best.pairs)}",
            }
        )
        data.append(
            {
                "place": best.place,
                "by": name,
                "method": best.row["method"],
                "value": best.row[name],
                "low": best.row[f"{name}_low"],
                "high": best.row[f"{name}_high"],
                "next": best.next["method"],
                "difference": pair.difference.effect if pair else None,
                "difference_low": pair.difference.low if pair else None,
                "difference_high": pair.difference.high if pair else None,
                "p_adjusted": pair.adjusted if pair else None,
                "told_apart": best.apart,
                "alike": len(best.alike),
                "held": len(best.pairs),
            }
        )
    caption = (
        "The best on each map, and whether the next can be told from it: the difference of "
        "success in points, or how many times the next one's effort it expects, with the 95 % "
        f"interval; by tests that pair trials of one problem and seed, Holm's correction over the "
        f"best {_HELD}. Those not told from it are as good as far as these trials say."
    )
    behind = tuple(best.row["runs"] for best in found)
    name, shown = f"{view.stem}_best", pd.DataFrame(lines)
    return [Table(name, caption, pd.DataFrame(data), shown, heads=3, runs=behind)]


def _difference(best: Best, pair: Pair | None) -> str:
    found = pair.difference if pair else None
    if found is None or found.effect is None:
        return NOTHING
    scale, unit = (100.0, " points") if best.effort is None else (1.0, " times")
    value = f"{number(rounded(found.effect * scale))}{unit}"
    if found.low is None or found.high is None:
        return value
    low, high = (number(rounded(end * scale)) for end in (found.low, found.high))
    return f"{value} ({low} to {high})"
