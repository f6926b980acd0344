"""The page of the benchmarks, made from what ``python -m benchmarks`` has written."""

import math
import re
from collections.abc import Collection
from dataclasses import replace
from itertools import takewhile
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import pandas as pd
from pandas.api.types import is_numeric_dtype

from gapath.errors import InputError, require
from gapath.pipelines.numbers.text import middle, number
from gapath.pipelines.page.page import Part, files_of, render
from gapath.pipelines.page.section import Section, Table, find_bench_figures
from gapath.pipelines.reading.collect import Skipped

INDEX = "questions.csv"


class Question(NamedTuple):
    """A question of the benchmarks, and its answer."""

    name: str
    text: str
    rows: pd.DataFrame


def make_bench_page(folder: Path) -> tuple[list[tuple[str, bytes]], list[Skipped]]:
    """Make ``bench.html`` and the files of its tables and figures.

    Parameters
    ----------
    folder : Path
        The ``--output`` of the benchmarks. Of its tables those of the last run count: others
        were measured at another time, or on another machine.

    Returns
    -------
    files : list of (str, bytes)
        Name and content, the page last; none if there are no benchmarks that can be used.
    skipped : list of Skipped
        What was left out, and why.
    """
    if not any(folder.glob("*.csv")):
        return [], []
    try:
        index = _read(folder / INDEX, ("question", "text"), dtype=str, keep_default_na=False)
        targets = _read(folder / "targets.csv", ("what", "target", "measured", "met"))
        machine = (
            _read(folder / "machine.csv", ("kind",), dtype=str, keep_default_na=False)
            .iloc[0]
            .to_dict()
        )
    except InputError as error:
        return [], [Skipped(folder.name, str(error))]
    questions, skipped = [], []
    for name, text in zip(index["question"], index["text"], strict=True):
        try:
            require(str(name).isidentifier(), f"{INDEX}, question", name, "a name")
            needed = {column for module in _figures_of(name) for column in module.COLUMNS}
            questions.append(Question(name, text, _read(folder / f"{name}.csv", needed)))
        except InputError as error:
            skipped.append(Skipped(folder.name, str(error)))
    quick = machine["kind"] != "full"
    mark = f"{machine['kind'].capitalize()}. " if quick else ""
    option = "--quick " if quick else ""
    parts = [Part("targets", _targets(targets, mark), [])]
    for question in questions:
        command = f"python -m benchmarks --output DIR {option}{question.name}"
        parts.append(Part(question.name, _section(question, mark), [command]))
    page = render("bench.html.j2", parts=parts, machine=machine, quick=quick)
    files = [file for part in parts for file in files_of(part.section)]
    return [*files, ("bench.html", page.encode())], skipped


def _read(path: Path, columns: Collection[str] = (), **options: Any) -> pd.DataFrame:
    """Read a table that has rows, and these columns."""
    try:
        rows = pd.read_csv(path, **options)
    except FileNotFoundError as error:
        raise InputError(path.name, "no file", "what a whole run of benchmarks writes") from error
    except (OSError, ValueError) as error:
        raise InputError(path.name, type(error).__name__, "a readable CSV file") from error
    missing = ", ".join(sorted(set(columns) - set(rows)))
    require(not missing, path.name, f"no column {missing}", "a table of the benchmarks")
    require(len(rows) > 0, path.name, "no rows", "a table of the benchmarks")
    return rows


def _targets(rows: pd.DataFrame, mark: str) -> Section:
    caption = f"{mark}What gapath is to reach; medians (lower to upper quartile)."
    shown = _shown(rows)[["what", "target", "measured", "met"]]
    return Section("Targets", tables=(Table("bench_targets", caption, rows, shown, heads=1),))


def _section(question: Question, mark: str) -> Section:
    """Make the section of a question: its table, and the figures of it that there are."""
    name, text, rows = question
    paragraphs = [" ".join(lines.split()) for lines in re.split(r"\n\n|\n(?=- )", text)]
    paragraphs = [re.sub("`+", "", paragraph) for paragraph in paragraphs]
    named = takewhile(lambda column: not is_numeric_dtype(rows[column]), rows.columns)
    table = Table(
        f"bench_{name}",
        f"{mark}{name}: medians (lower to upper quartile).",
        rows,
        _shown(rows),
        heads=max(1, len(list(named))),
    )
    figures = [module.figure(rows) for module in _figures_of(name)]
    return Section(
        title=name,
        text=tuple(text for text in paragraphs if not text.startswith("- ")),
        tables=(table,),
        figures=tuple(replace(each, caption=mark + each.caption) for each in figures),
        remarks=tuple(text.removeprefix("- ") for text in paragraphs if text.startswith("- ")),
    )


def _figures_of(name: str) -> list[ModuleType]:
    """Find the modules that draw a figure of a question's rows."""
    return [each for each in find_bench_figures() if name == each.QUESTION]


def _shown(rows: pd.DataFrame) -> pd.DataFrame:
    """Write the cells for people, those of a median and its two quartiles as one."""
    shown = {}
    for name in rows:
        ends = [f"{name} q1", f"{name} q3"]
        if set(ends) <= set(rows):
            shown[name] = [_middle(*cells) for cells in rows[[name, *ends]].to_numpy()]
        elif not (name.endswith((" q1", " q3")) and name[:-3] in rows):
            shown[name] = [_text(cell) for cell in rows[name]]
    return pd.DataFrame(shown)


def _text(cell: Any) -> str:
    """Write a cell: a number with three digits, text as it is, nothing where there is nothing."""
    try:
        return "" if math.isnan(float(cell)) else number(float(cell))
    except ValueError:
        return str(cell)


def _middle(median: Any, q1: float, q3: float) -> str:
    """Write a median with its quartiles; alone if it is one value, or text."""
    if math.isnan(q1) or q1 == q3:
        return _text(median)
    return middle(float(median), q1, q3).replace("to ", "to\N{NO-BREAK SPACE}")
