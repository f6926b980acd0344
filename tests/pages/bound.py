"""Numbers of the pages that are bound to tables of results; `docs/numbers.toml` says which."""

import re
import tomllib
from decimal import Decimal
from itertools import zip_longest
from pathlib import Path
from typing import NamedTuple

import duckdb

ROOT = Path(__file__).parents[2]
RESULTS, BENCH = "docs/results", "bench"

_SHOWN = r"(?:[<>] )?-?\d+(?:[ \u202f]\d{3}(?!\d))*(?:\.\d+)?|∞"
_HOLES = {
    "{}": rf"(?<![\d.])({_SHOWN})(?!\d|\.\d)",
    "{?}": rf"(?<![\d.])(?:{_SHOWN})(?!\d|\.\d)",
}
_MACROS = """
create macro z2() as 3.841458820694124;
create macro around(p, n) as sqrt(z2() * (p * (1 - p) / n + z2() / (4 * n * n)));
create macro low(p, n) as (p + z2() / (2 * n) - around(p, n)) / (1 + z2() / n);
create macro high(p, n) as (p + z2() / (2 * n) + around(p, n)) / (1 + z2() / n);
create macro plain(x) as regexp_replace(x::decimal(18, 6)::varchar, '\\.?0*$', '');
create macro percent(p) as case when p > 0 and p < 0.0005 then '< 0.1'
    when p < 1 and p >= 0.9995 then '> 99.9' else plain(round(100 * p, 1)) end;
create macro rate(p, n, digits) as
    [percent(p), plain(round(100 * low(p, n), digits)), plain(round(100 * high(p, n), digits))];
create macro significant(x, n) as case when isinf(x) then '∞' when x = 0 then '0'
    else plain(round(x, n - 1 - floor(log10(abs(x)))::int)) end;
create macro short(x) as case when abs(x) >= 999.5
    then replace(format('{:,}', round(x)::bigint), ',', ' ') else significant(x, 3) end;
create macro brief(x) as short(significant(x, 2)::double);
create macro quartiles(x, lower, upper) as
    coalesce(format('{} [{}, {}]', short(x), short(lower), short(upper)), '');
"""
"""What queries may use beside DuckDB's own: Wilson's 95 % interval of a rate p of n, and text as
`gapath.pipelines.numbers.text` writes it: a rate in percent, with both ends of its interval or
without, a number of n significant digits, of three or two or else
a whole one, and one with its quartiles."""


class Bound(NamedTuple):
    """A text of a page with {} for each number that a query gives, {?} for others."""

    where: str
    text: str
    query: str
    given: str = ""
    """What the other numbers are that rows of a table have behind their first cell."""

    def found(self, pages):
        """Give the places of the text in its page: matches, a group a number."""
        parts = re.split(r"(\{\??\})", self.text.strip())
        pattern = "".join(_HOLES.get(part) or _anyhow_broken(part) for part in parts)
        return list(re.finditer(pattern, pages[self.where]))


class Table(NamedTuple):
    """A table of a page, all of whose rows below the head are what a query gives, cells as text."""

    where: str
    head: str
    query: str

    def found(self, pages):
        """Give the places of its rows in its page."""
        rows = rf"(?m:^){re.escape(self.head.strip())}\n\|[-| :]+\|\n((?:\|.*\|(?:\n|\Z))+)"
        return list(re.finditer(rows, pages[self.where]))


def _anyhow_broken(text):
    return r"\s+".join(map(re.escape, re.split(r"\s+", text)))


class Fault(NamedTuple):
    """A number that is not what its query gives, or a text for which that cannot be said."""

    where: str
    line: int
    said: str
    start: int = 0
    shown: str = ""
    value: str | None = None
    """What would be right, as the page would show it."""

    def __str__(self):
        return f"{self.where}:{self.line}: {self.said}"


def read():
    """Read `docs/numbers.toml`: what is bound, and the sections whose tables are so wholly."""
    found = tomllib.loads((ROOT / "docs" / "numbers.toml").read_text("utf-8"))
    whole = found["whole"]
    bound = [
        (Table if "head" in each else Bound)(page, **each)
        for page, entries in found.items()
        if page != "whole"
        for each in entries
    ]
    return bound, whole


def read_pages(bound, whole):
    """Read the pages that are named: name -> text."""
    names = {each.where for each in bound} | {name.partition("#")[0] for name in whole}
    return {name: (ROOT / name).read_text("utf-8") for name in sorted(names)}


def tables(*folders):
    """Open the tables of results: each CSV under its name, of the last folder that has it.

    Those of benchmarks are in a schema of their own, ``bench``.
    """
    connection = duckdb.connect()
    connection.execute(_MACROS)
    connection.execute(f"create schema {BENCH}")
    for folder in folders:
        for schema, place in ("main", folder), (BENCH, folder / BENCH):
            for path in sorted(place.glob("*.csv")):
                made = f"from read_csv('{path}', sample_size = -1)"
                connection.execute(f"create or replace table {schema}.{path.stem} as {made}")
    return connection


def faults(bound, pages, connection):
    """Give what is wrong: a text that is not in its page once, a number that is another."""
    return [fault for each in bound for fault in _faults(each, pages, connection)]


def _faults(each, pages, connection):
    page, places = pages[each.where], each.found(pages)
    line = page.count("\n", 0, places[0].start()) + 1 if places else 0
    if len(places) != 1:
        text = each.head if isinstance(each, Table) else each.text
        yield Fault(each.where, line, f"{len(places)} times, not once: {text.strip()}")
        return
    try:
        rows = connection.execute(each.query).fetchall()
    except duckdb.Error as error:
        yield Fault(each.where, line, f"{error}: {each.query.strip()}")
        return
    if isinstance(each, Table):
        yield from _of_table(each, places[0], line, rows)
    else:
        yield from _of_text(each, places[0], line, rows, page)


def _of_table(each, place, line, rows):
    made = [f"| {' | '.join('' if cell is None else str(cell) for cell in row)} |" for row in rows]
    shown = place[1].splitlines()
    if shown != made:
        said = [f"{a} -> {b}" for a, b in zip_longest(shown, made, fillvalue="no row") if a != b]
        new = "\n".join([*made, ""]) if made else None
        yield Fault(each.where, line, "\n".join(said), place.start(1), place[1], new)


def _of_text(each, place, line, rows, page):
    values = list(_flat(rows))
    if len(values) != len(place.groups()) or None in values:
        said = f"{values} for {len(place.groups())} numbers: {each.query.strip()}"
        yield Fault(each.where, line, said)
        return
    for i, (shown, value) in enumerate(zip(place.groups(), values, strict=True), 1):
        if not agrees(shown, value):
            start, new = place.start(i), written(shown, value)
            line = page.count("\n", 0, start) + 1
            around = " ".join(page[max(0, start - 30) : start + len(shown) + 20].split())
            yield Fault(each.where, line, f"{shown} -> {new} in {around}", start, shown, new)


def _flat(values):
    for value in values:
        if isinstance(value, list | tuple):
            yield from _flat(value)
        else:
            yield value


def agrees(shown, value):
    """Tell whether a number is what a query gave: text as it is, else to the digits shown."""
    digits = _plain(shown)
    if isinstance(value, str):
        return digits == _plain(value)
    if not re.fullmatch(r"-?[\d.]+", digits):
        return False
    unit = Decimal(10) ** -_decimals(digits)
    return abs(Decimal(digits) - Decimal(value)) <= unit * (Decimal("0.5") + Decimal("1e-9"))


def written(shown, value):
    """Write a new value as the old one was: its decimals, and its space between thousands."""
    text = _plain(value) if isinstance(value, str) else f"{value:.{_decimals(_plain(shown))}f}"
    whole, dot, rest = text.partition(".")
    if whole.isdigit() and (len(whole) > 4 or _plain(shown) != shown):
        whole = f"{int(whole):,}".replace(",", " ")
    return whole + dot + rest


def _plain(shown):
    return re.sub(r"(?<=\d)[ \u202f](?=\d{3})", "", shown)


def _decimals(digits):
    return len(digits.partition(".")[2])


def unbound(whole, bound, pages):
    """Give the rows of tables in these sections with a number that no query gives."""
    known = {name: [] for name in pages}
    for each in bound:
        for place in each.found(pages):
            wholly = isinstance(each, Bound) and each.given
            known[each.where] += [place.span()] if wholly else place.regs[1:]
    for name in whole:
        page, _, heading = name.partition("#")
        section = _section(pages[page], heading)
        for row in re.finditer(r"(?<=\n)\|.*\|$", section.text, re.MULTILINE):
            heads = re.match(r"\|[ |]*-{3}", section.text[row.end() + 1 :])
            behind = row[0].index("|", 1)  # the first cell names the row
            numbers = re.finditer(r"\d+(?:\.\d+)?", row[0][behind:])
            places = [section.start + row.start() + behind + each.start() for each in numbers]
            spans = known[page]
            if not heads and not all(any(a <= at < b for a, b in spans) for at in places):
                yield f"{name}: {row[0]}"


class _Section(NamedTuple):
    start: int
    text: str


def _section(page, heading):
    for found in re.finditer(r"^(#+) (.+)$", page, re.MULTILINE):
        if anchor(found[2]) == heading:
            rest = page[found.end() :]
            end = re.search(rf"^#{{1,{len(found[1])}}} ", rest, re.MULTILINE)
            return _Section(found.end(), rest[: end.start()] if end else rest)
    raise KeyError(heading)


def anchor(heading):
    """Give the name that a heading has in links, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
