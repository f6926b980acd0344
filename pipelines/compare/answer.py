"""The answer to a question: sentences, tables, pictures, and what they rest on."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd
from tabulate import tabulate

from gapath.errors import printable
from gapath.pipelines.compare.choice import Choice, choose
from gapath.pipelines.compare.figures import figures
from gapath.pipelines.compare.tables import (
    groups_frame,
    pairs_frame,
    shown,
    table_by_map,
    whole_table,
)
from gapath.pipelines.compare.words import WORDINGS, sentences, some
from gapath.pipelines.numbers.comparing.comparable import comparable
from gapath.pipelines.numbers.comparing.comparison import QUANTITIES, Comparison, compare
from gapath.pipelines.numbers.comparing.groups import Groups, overlap, side_by_side
from gapath.pipelines.numbers.text import in_markdown, number, span
from gapath.pipelines.page.page import files_of
from gapath.pipelines.page.section import Figure, Section, Table, csv_of

NAMES = frozenset(
    ["groups.csv"]
    + [f"{table}.{suffix}" for table in ("comparison", "maps") for suffix in ("csv", "md", "tex")]
    + [
        f"comparison_{each}.{suffix}"
        for each in (*QUANTITIES, "ranks")
        for suffix in ("svg", "png")
    ]
)
"""The files that answers have, none of them all."""


@dataclass(frozen=True)
class Answer:
    """What groups of runs come to.

    Parameters
    ----------
    by : str
        What tells the groups apart, for people.
    choice : Choice
        The trials and their groups.
    groups : Groups
        The same side by side.
    comparisons : tuple of Comparison
        One a quantity.
    """

    by: str
    choice: Choice
    groups: Groups
    comparisons: tuple[Comparison, ...]

    @property
    def heading(self) -> str:
        """What was compared, in a line."""
        choice, groups = self.choice, self.groups
        maps = choice.trials["map_digest"].nunique()
        where = f"{maps} maps" if maps > 1 else choice.trials["map"].iloc[0]
        return (
            f"{self.by}: {len(groups.names)} groups, {number(len(choice.trials))} trials of "
            f"{choice.task.name} on {where}"
        )

    @cached_property
    def remarks(self) -> list[str]:
        """What trials were paired by, which tests were made, what the numbers do not say."""
        pairing, limits = _pairing(self.choice, self.groups), _limits(self.choice, self.groups)
        return [*pairing, *_tests(self.comparisons), *limits]

    @cached_property
    def by_map(self) -> Table | None:
        """Each map by itself."""
        choice = self.choice
        return table_by_map(choice.trials, choice.task.success, choice.group, choice.also, self.by)

    def said(self) -> dict[str, list[str]]:
        """Give the sentences of each quantity."""
        success = self.choice.task.success
        return {each.quantity: sentences(each, success) for each in self.comparisons}

    def text(self, rows: int) -> str:
        """Write it for a terminal, tables with so many rows."""
        lines = [self.heading]
        for quantity, found in self.said().items():
            lines += ["", WORDINGS[quantity].title, *(f"  {each}" for each in found)]
        for comparison in self.comparisons:
            if comparison.pairs:
                table = shown(comparison, self.by).map(printable)
                text = tabulate(table.head(rows), headers="keys", showindex=False,
                                disable_numparse=True)  # fmt: skip
                more = f"\nand {len(table) - rows} more in the files" if len(table) > rows else ""
                lines += ["", *(text + more).split("\n")]
        return "\n".join(map(printable, [*lines, "", *self.remarks]))

    def files(self) -> list[tuple[str, bytes]]:
        """Give the name and content of each file."""
        tables = [whole_table(self.comparisons, self.by, f"{self.heading}.")]
        tables += [self.by_map] if self.by_map else []
        drawn = figures(self.comparisons, self.by, self.groups.names)
        section = Section(self.heading, tables=tuple(tables), figures=tuple(drawn))
        files = dict(files_of(section))
        page = [f"# {in_markdown(self.heading)}"]
        for quantity, found in self.said().items():
            page += [f"## {WORDINGS[quantity].title}", _items(found)]
            names = [each for each in drawn if each.name == f"comparison_{quantity}"]
            page += map(_picture, names)
        page += [f"## {'Tables' if len(tables) > 1 else 'Table'}"]
        page += [each.markdown().strip() for each in tables]
        ranks = [each for each in drawn if each.name == "comparison_ranks"]
        page += map(_picture, ranks)
        page += ["## Remarks", _items(self.remarks)]
        files["comparison.md"] = ("\n\n".join(page) + "\n").encode()
        files["groups.csv"] = csv_of(groups_frame(self.comparisons)).encode()
        return list(files.items())

    def plain(self) -> dict[str, Any]:
        """Give it as plain data."""
        return {
            "heading": self.heading,
            "sentences": self.said(),
            "groups": _records(groups_frame(self.comparisons)),
            "pairs": _records(pairs_frame(self.comparisons)),
            "remarks": self.remarks,
        }


def answer(
    outputs: Path, by: str | None, wheres: Sequence[str], quantities: Sequence[str]
) -> Answer:
    """Answer which groups differ.

    Parameters
    ----------
    outputs, by, wheres
        As `choose` has them.
    quantities : sequence of str
        Of `gapath.pipelines.numbers.comparing.comparison.QUANTITIES`.

    Returns
    -------
    Answer
        The same for the same runs.

    Raises
    ------
    InputError
        As `choose`.
    """
    choice = choose(outputs, by, wheres)
    choice = replace(choice, **comparable(choice.trials, choice.group, choice.also)._asdict())
    groups = side_by_side(choice.trials, choice.task.success, choice.group, choice.also)
    found = tuple(compare(groups, quantity) for quantity in quantities)
    return Answer(by or "where", choice, groups, found)


def _items(texts: Iterable[str]) -> str:
    return "\n".join(f"- {in_markdown(text)}" for text in texts)


def _picture(figure: Figure) -> str:
    alt, caption = in_markdown(figure.alt), in_markdown(figure.caption)
    return f"![{alt}]({figure.name}.svg)\n\n{caption}"


def _tests(comparisons: Iterable[Comparison]) -> list[str]:
    told = []
    for each in comparisons:
        names = {pair.difference.test for pair in each.pairs if pair.difference.p is not None}
        if names:
            told.append(f"{WORDINGS[each.quantity].short} by {' or '.join(sorted(names))}")
    return [f"Tests of two groups, their p after Holm: {'; '.join(told)}."] if told else []


def _pairing(choice: Choice, groups: Groups) -> list[str]:
    count = overlap(groups.success, groups.blocks)
    k = len(groups.names)
    pairs = [(i, j) for i in range(k) for j in range(i)]
    paired = [int(count.pairs[pair]) for pair in pairs if count.paired(*pair)]
    also = "".join(f", {name}" for name in choice.also)
    what = f"map, start, target, instance, seed, trial{also}"
    if not paired:
        yours = "No two groups have enough trials in common to pair them"
        return [f"{yours} by {what}: the tests are unpaired."]
    found = [f"Trials are paired by {what}: {span(min(paired), max(paired))} pairs."]
    alone = [
        f"{name} {number(n - best)}"
        for at, (name, n) in enumerate(zip(groups.names, count.trials, strict=True))
        if (best := max(int(count.pairs[at, other]) for other in range(k) if other != at)) < n
    ]
    if alone:
        found.append(f"Left unpaired, at the least: {', '.join(alone)} trials.")
    if len(paired) < len(pairs):
        found.append(
            f"Of {len(pairs)} pairs of groups {len(pairs) - len(paired)} have too few trials in "
            "common: their tests are unpaired."
        )
    return found


def _limits(choice: Choice, groups: Groups) -> list[str]:
    found = list(choice.said)
    if groups.copies is not None and groups.copies.any():
        found.append("Trials without chance that repeat another count once, but for times.")
    if groups.repeated:
        found.append(f"{number(groups.repeated)} trials were done twice and count once.")
    if choice.beside:
        found.append(f"The groups differ in {some(choice.beside)}, too.")
    if choice.also:
        found.append(f"Each group holds several values of {some(choice.also)}.")
    if groups.problems > 1:
        found.append(
            f"Intervals are over the trials of these {groups.problems} problems, not over problems "
            "that there might be; maps.csv and comparison.md have each map by itself."
        )
    if len(choice.versions) > 1:
        found.append(f"The runs are of gapath {', '.join(choice.versions)}.")
    return found


def _records(frame: pd.DataFrame) -> list[dict[str, Any]]:
    rows = frame.astype(object).where(frame.notna(), None).to_dict("records")
    return [{str(key): value for key, value in row.items()} for row in rows]
