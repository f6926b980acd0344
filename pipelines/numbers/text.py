"""How numbers are written for people, and text of others where it may be taken for more."""

import math
import re

from gapath.errors import printable
from gapath.pipelines.numbers.statistics import Interval

NOTHING = "\N{EN DASH}"
"""What a cell shows where there is no number."""

_SPACE = "\N{NARROW NO-BREAK SPACE}"
"""Between thousands: no line ends there."""


def number(value: float) -> str:
    """Write a number for people: three significant digits, no exponent.

    Parameters
    ----------
    value : float
        The number.

    Returns
    -------
    str
        The text; "∞" where it is infinite, `NOTHING` where it is missing.
    """
    if math.isnan(value):
        return NOTHING
    if math.isinf(value):
        return "∞"
    if value == 0 or float(value).is_integer() or abs(value) >= 1000:
        return f"{value:,.0f}".replace(",", _SPACE)
    decimals = max(0, 2 - math.floor(math.log10(abs(value))))
    text = f"{value:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def tenths(value: float) -> str:
    """Write a number with one decimal, also where it is 0; `NOTHING` where it is missing."""
    return NOTHING if math.isnan(value) else f"{value:.1f}"


def span(low: float, high: float) -> str:
    """Write a range of numbers for people."""
    ends = number(low), number(high)
    return ends[0] if ends[0] == ends[1] else f"{ends[0]} to {ends[1]}"


def middle(median: float, q1: float, q3: float) -> str:
    """Write a median with its quartiles."""
    return NOTHING if math.isnan(median) else f"{number(median)} ({span(q1, q3)})"


def percent(rate: float) -> str:
    """Write a rate in percent; what is not quite all or nothing never reads as such."""
    value = 100 * rate
    if 0 < value < 0.05 or 99.95 <= value < 100:
        return "< 0.1" if value < 50 else "> 99.9"
    return f"{value:.1f}".removesuffix(".0")


def percent_range(interval: Interval, decimals: int = 1) -> str:
    """Write an interval of a rate in percent."""
    if math.isnan(interval[0]):
        return NOTHING
    low, high = (f"{100 * end:.{decimals}f}" for end in interval)
    return f"{low} to {high}"


def file_size(count: float) -> str:
    """Write a number of bytes."""
    for unit in ("B", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} {unit}"
        count /= 1000
    return f"{count:.1f} GB"


def in_csv(value: object) -> object:
    """Give a cell of CSV: text `printable`, and such that no spreadsheet takes it for a formula."""
    if not isinstance(value, str):
        return value
    text = printable(value)
    return f"'{text}" if text.startswith(("=", "+", "-", "@")) else text


def in_markdown(text: object) -> str:
    """Write text for Markdown, where HTML would be HTML, and a bar or a code's mark end a cell."""
    return _MARKUP.sub(lambda found: _MARKED[found[0]], printable(text))


_MARKED = {"<": "&lt;", "`": r"\`", "|": r"\|", "](": r"]\("}
_MARKUP = re.compile(r"<(?=[a-zA-Z/!?])|`|\||\]\(")


def in_latex(text: object) -> str:
    """Write text for LaTeX."""
    shown = "".join(_LATEX.get(character, character) for character in printable(text))
    return f"{{[}}{shown[1:]}" if shown[:1] == "[" else shown  # behind a row's end an option


_LATEX = {
    "\\": r"\textbackslash ", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#",
    "_": r"\_", "{": r"\{", "}": r"\}", "~": r"\textasciitilde ", "^": r"\^{}",
    "∞": r"$\infty$", "\N{EN DASH}": "--", "<": "$<$", ">": "$>$",
    "\N{NARROW NO-BREAK SPACE}": r"\,", "\N{NO-BREAK SPACE}": "~",
}  # fmt: skip
