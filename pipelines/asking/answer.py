"""Answers as text for people, as CSV and as JSON."""

import csv
import json
import math
from collections.abc import Mapping
from typing import Any, NamedTuple, TextIO

import pandas as pd

from gapath.errors import printable, require
from gapath.pipelines.numbers.text import NOTHING, in_csv, number

_GAP = "  "
_LEAST = 8
"""Characters of a text that are left when it is shortened."""


class Answer(NamedTuple):
    """A table of plain values, a list a column; None where there is no value."""

    names: list[str]
    columns: list[list[Any]]

    @classmethod
    def of(cls, frame: pd.DataFrame) -> "Answer":
        """Take a frame's columns, without its index."""
        columns = [frame[name].astype(object) for name in frame]
        return cls(list(frame), [column.where(column.notna(), None).tolist() for column in columns])


def write_csv(answer: Answer, file: TextIO) -> None:
    """Write every value with all its digits; an empty cell where there is none."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(map(in_csv, answer.names))
    writer.writerows(zip(*(map(_lower, column) for column in answer.columns), strict=True))


def _lower(value: Any) -> Any:
    return str(value).lower() if isinstance(value, bool) else in_csv(value)


def write_json(answer: Answer, file: TextIO) -> None:
    """Write a list of objects, one a row; null where there is no value, or no finite one.

    Raises
    ------
    InputError
        If two columns have one name: an object has each once.
    """
    for name in answer.names:
        once = answer.names.count(name) == 1
        require(once, "--json", f"two columns {name}", "another name for one of them, with as")
    columns = [map(_finite, column) for column in answer.columns]
    rows = [dict(zip(answer.names, row, strict=True)) for row in zip(*columns, strict=True)]
    json.dump(rows, file, indent=2, default=str)
    file.write("\n")


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_text(
    answer: Answer, file: TextIO, width: int | None, importance: Mapping[str, float]
) -> None:
    """Write a table for people.

    Parameters
    ----------
    answer : Answer
        The table.
    file : TextIO
        Where to.
    width : int or None
        Characters of a line; None: as many as it takes. Where the table is wider, headings
        are broken at their dots, columns are left out, and at last long texts are shortened.
    importance : mapping of str to float
        Columns that may be left out, the least important first.
    """
    heads = [name.split(".") if width else [name] for name in map(printable, answer.names)]
    heads = [[f"{part}." for part in parts[:-1]] + parts[-1:] for parts in heads]
    high = max(map(len, heads))
    texts = [list(map(_text, column)) for column in answer.columns]
    widths = [max(map(len, [*head, *column])) for head, column in zip(heads, texts, strict=True)]
    shown = list(range(len(heads)))

    def room() -> int:
        return sum(widths[i] for i in shown) + len(_GAP) * (len(shown) - 1)

    while width and room() > width:
        losable = [i for i in shown if answer.names[i] in importance]
        if not losable:
            break
        shown.remove(min(losable, key=lambda i: importance[answer.names[i]]))
    while width and room() > width:
        widest = max(shown, key=lambda i: widths[i])
        if widths[widest] <= _LEAST:
            break
        widths[widest] -= 1
    padded = []
    for i in shown:
        right = all(isinstance(value, int | float | None) for value in answer.columns[i])
        lines = [""] * (high - len(heads[i])) + heads[i] + ["-" * widths[i]] + texts[i]
        short = (_shortened(line, widths[i]) for line in lines)
        padded.append([line.rjust(widths[i]) if right else line.ljust(widths[i]) for line in short])
    for line in zip(*padded, strict=True):
        file.write(_GAP.join(line).rstrip() + "\n")


def _shortened(text: str, width: int) -> str:
    return text if len(text) <= width else text[: width - 1] + "\N{HORIZONTAL ELLIPSIS}"


def _text(value: Any) -> str:
    if value is None:
        return NOTHING
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return number(value)
    return printable(" ".join(str(value).split()))
