"""What a section of the report is made of.

A section is one file of pipelines, ``table*.py`` or ``figure_*.py``, that offers

- ``TASK``: the name of a task, of whose trials alone it sees any, or `ALL`: it is asked once for
  each task, whose name the runs tell;
- ``EXPERIMENT``: the experiment whose trials it wants, or None: it is asked once for each that no
  other wants, or `ALL` for every one;
- ``ORDER``: its place on the page, a number;
- ``section(trials, runs)``: a frame of trials and the runs they come from -> `Section`, or several
  in a list, or None where there is nothing to show.

Text in the frame but its `key` is categorical, or a million trials would not fit: `numbers.grouped`
groups it and gives plain text, and `reading.of_run` what a trial has from its run, as settings are.
"""

import importlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

import pandas as pd
from pandas.api.types import is_numeric_dtype

from gapath.discovery import entry_points, imported
from gapath.errors import require, require_all
from gapath.pipelines.numbers.behind import keys_behind
from gapath.pipelines.numbers.text import in_csv, in_latex, in_markdown, number

ALL = "*"
"""What a section declares that wants the trials of every task, or of every experiment."""

OFFERS = {"ORDER": int | float, "TASK": str, "EXPERIMENT": str | None, "section": Callable}
"""What a section must have."""

RECONSTRUCTED = (
    "The maps marked reconstructed are not the paper's: its figures are lost. They were drawn "
    "anew by a seeded generator from what the text says of each class."
)

DRAWN = (
    "The search spaces marked reconstructed are not the paper's: its figures are lost. They were "
    "drawn anew, each of the class that the paper's table shows, which is proved."
)


MOST_ROWS = 1000
"""Rows of a table that people are shown."""


@dataclass(frozen=True)
class Table:
    """A table of the report; of very many rows people are shown the first, and told so.

    Parameters
    ----------
    name : str
        Of its files, without a suffix.
    caption : str
        What it shows.
    data : DataFrame
        The plain numbers, for the CSV file.
    shown : DataFrame
        The text of its cells, for people.
    heads : int
        The first so many columns name the row.
    runs : tuple of tuple of str
        For each row of `shown` the keys of the runs behind it, to whose pages it leads; empty
        where rows lead nowhere.
    sortable : bool
        Whether the rows say the same in another order.

    Raises
    ------
    InputError
        If there are runs, but not for each row.
    """

    name: str
    caption: str
    data: pd.DataFrame
    shown: pd.DataFrame
    heads: int = 2
    runs: tuple[tuple[str, ...], ...] = ()
    sortable: bool = True

    def __post_init__(self) -> None:
        given, rows = len(self.runs), len(self.shown)
        require(given in (0, rows), f"table {self.name}, runs", given, f"one entry a row, {rows}")
        if rows > MOST_ROWS:
            said = f"The first {number(MOST_ROWS)} of {number(rows)} rows; the CSV file has all."
            shorter = {"caption": f"{self.caption} {said}", "shown": self.shown.head(MOST_ROWS)}
            for name, value in (*shorter.items(), ("runs", self.runs[:MOST_ROWS])):
                object.__setattr__(self, name, value)

    def with_runs(self, trials: pd.DataFrame, by: Sequence[str]) -> "Table":
        """Lead each row to the runs behind it.

        Parameters
        ----------
        trials : DataFrame
            One row a trial, with the columns `by` and `key`.
        by : sequence of str
            The columns that name a row, in `data` too.

        Returns
        -------
        Table
            With `runs`.
        """
        return replace(self, runs=keys_behind(trials, by, self.data.head(len(self.shown))))

    def csv(self) -> str:
        """Write the numbers as CSV."""
        return csv_of(self.data)

    def markdown(self) -> str:
        """Write the text of the cells as Markdown."""
        text = self.shown.rename(columns=in_markdown).map(in_markdown)
        table = text.to_markdown(index=False, disable_numparse=True)
        return f"{table}\n\n{in_markdown(self.caption)}\n"

    def latex(self) -> str:
        """Write the text of the cells as LaTeX (booktabs)."""
        escaped = in_latex(self.caption)
        text = self.shown.rename(columns=in_latex).map(in_latex)
        table: str = text.to_latex(index=False, caption=escaped, label=f"tab:{self.name}")
        return table


@dataclass(frozen=True)
class Figure:
    """A figure of the report.

    Parameters
    ----------
    name : str
        Of its files, without a suffix.
    caption : str
        How to read it.
    alt : str
        What it shows, for who cannot see it.
    svg, png : bytes
        The picture.
    """

    name: str
    caption: str
    alt: str
    svg: bytes
    png: bytes


@dataclass(frozen=True)
class Section:
    """A section of the report.

    Parameters
    ----------
    title : str
        Its heading.
    text : tuple of str
        Paragraphs before the tables and figures.
    tables : tuple of Table
        Its tables.
    figures : tuple of Figure
        Its figures.
    remarks : tuple of str
        How the numbers were made and what they do not say.
    skipped : tuple of (str, str)
        Runs that it could not use, and why.
    runs : tuple of str
        Keys of the runs that it is about; empty where it is about all it was asked with.
    """

    title: str
    text: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    figures: tuple[Figure, ...] = ()
    remarks: tuple[str, ...] = ()
    skipped: tuple[tuple[str, str], ...] = ()
    runs: tuple[str, ...] = ()


def csv_of(data: pd.DataFrame) -> str:
    """Write plain numbers and texts as CSV."""
    texts = {name: data[name].map(in_csv) for name in data if not is_numeric_dtype(data[name])}
    written = data.assign(**texts).rename(columns=in_csv)
    text: str = written.to_csv(index=False, lineterminator="\n")
    return text


def find_sections() -> list[ModuleType]:
    """Find the modules that make a section, in the order of the page.

    Returns
    -------
    list of module
        Those of pipelines, and entry points of installed packages (`gapath.discovery`).

    Raises
    ------
    InputError
        If one of a package is no section.
    """
    own = [module for module in _find("table*.py", "figure_*.py") if hasattr(module, "section")]
    others = [imported(entry) for entry in entry_points("gapath.pipelines").values()]
    for module in others:
        require_all(module, module.__name__, OFFERS)
    return sorted([*own, *others], key=lambda module: module.ORDER)


def find_bench_figures() -> list[ModuleType]:
    """Find the modules that draw a figure of a benchmark, in the order of the page."""
    return sorted(_find("bench/figure_*.py"), key=lambda module: module.ORDER)


def _find(*patterns: str) -> list[ModuleType]:
    """Find modules of pipelines whose files are called so."""
    top = Path(__file__).parents[1]
    paths = sorted(path for pattern in patterns for path in top.rglob(pattern))
    names = [".".join(path.relative_to(top).with_suffix("").parts) for path in paths]
    return [importlib.import_module(f"gapath.pipelines.{name}") for name in names]
