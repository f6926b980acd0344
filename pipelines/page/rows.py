"""The rows of a table as the page shows them: what is a number, what stands there again."""

import math
import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from gapath.pipelines.numbers.text import NOTHING
from gapath.pipelines.page.section import Table

_LEAST, _MOST = -math.inf, math.inf
_NUMBER = re.compile(
    r"([<>]?) ?([-+\N{MINUS SIGN}]?)"
    r"(∞|\d[\d\N{NARROW NO-BREAK SPACE}]*(?:\.\d+)?(?:e[-+]?\d+)?)"
    r"(?![^\s,;(%\N{EN DASH}])"
)
"""A number at the beginning of a cell; what follows explains it."""


class Cell(NamedTuple):
    """A cell of a row.

    Parameters
    ----------
    text : str
        For people.
    order : str or None
        The number by which it sorts, empty where there is none; None in a column of text.
    again : bool
        Whether the row above has it, too, and all that stands before it.
    """

    text: str
    order: str | None
    again: bool


class Row(NamedTuple):
    """A row: its cells, whether it begins a group of rows, and the runs behind it."""

    cells: list[Cell]
    first: bool
    runs: tuple[str, ...]


def number_in(text: str) -> float | None:
    """Read the number that a cell begins with.

    Parameters
    ----------
    text : str
        A cell for people: "1 234", "12 (10 to 14)", "< 0.1", "∞".

    Returns
    -------
    float or None
        The number, a little less or more after < or >; None where the text begins with none.
    """
    found = _NUMBER.match(text)
    if found is None:
        return None
    than, sign, digits = found.groups()
    value = _MOST if digits == "∞" else float(re.sub(r"\s", "", digits))
    value = -value if sign in ("-", "\N{MINUS SIGN}") else value
    return math.nextafter(value, {"<": _LEAST, ">": _MOST}[than]) if than else value


def numeric(texts: Sequence[str]) -> bool:
    """Tell whether a column is one of numbers: most of what there is begins with one."""
    known = [text for text in texts if text not in ("", NOTHING)]
    return 2 * sum(number_in(text) is not None for text in known) > len(known)


def rows_of(table: Table) -> list[Row]:
    """Give the rows of a table as the page shows them.

    Parameters
    ----------
    table : Table
        A table.

    Returns
    -------
    list of Row
        In the table's order. Of the heads but the last those that stand in the row above are
        marked: they are written, but not seen.
    """
    columns = [list(map(str, table.shown[name])) for name in table.shown]
    numbers = [numeric(texts) for texts in columns]
    rows: list[Row] = []
    above: tuple[str, ...] = ()
    for i, texts in enumerate(zip(*columns, strict=True)):
        heads = texts[: table.heads - 1]
        same = next((j for j, pair in enumerate(zip(heads, above, strict=False))
                     if pair[0] != pair[1]), min(len(heads), len(above)))  # fmt: skip
        cells = [
            Cell(text, _order(text) if number else None, j < same)
            for j, (text, number) in enumerate(zip(texts, numbers, strict=True))
        ]
        rows.append(Row(cells, bool(heads) and same == 0, table.runs[i] if table.runs else ()))
        above = heads
    return rows


def width_of(texts: Iterable[str]) -> int:
    """Give the least width of a head's column: its longest word, within reason, in characters."""
    return 2 + min(16, max((len(word) for text in texts for word in str(text).split()), default=0))


def _order(text: str) -> str:
    value = number_in(text)
    if value is None:
        return ""
    return ("-Infinity" if value < 0 else "Infinity") if math.isinf(value) else repr(value)
