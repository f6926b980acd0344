"""The command `gapath-report runs`: which runs are there, and what they come to."""

import argparse
import shutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pandas as pd

from gapath.errors import printable, require
from gapath.pipelines.asking.answer import Answer, write_csv, write_json, write_text
from gapath.pipelines.asking.groups import FIGURES, SPENT, grouped
from gapath.pipelines.asking.listing import METRICS, importance, listed, short_keys
from gapath.pipelines.asking.sql import asked
from gapath.pipelines.reading.frame import described, matching
from gapath.pipelines.reading.query import near
from gapath.pipelines.reading.tags import said_of
from gapath.store.records import RunRecord, find_run, find_runs


class _Parser(argparse.ArgumentParser):
    """A parser that takes the -success of ``--sort -success`` for no option."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        words = list(sys.argv[1:] if args is None else args)
        for i in range(len(words) - 1, 0, -1):
            if words[i - 1] == "--sort":
                words[i - 1 : i + 1] = [f"--sort={words[i]}"]
        return super().parse_known_args(words, namespace)


def parser() -> argparse.ArgumentParser:
    """Make the parser of the command's arguments."""
    made = _Parser(
        "gapath-report runs",
        description="List the run folders, newest last, and answer questions about them. Columns "
        "are what a list shows, every setting (planner.population) and every result, the mean of "
        "a column of the trials: --json shows all of them.",
        epilog="Runs that cannot be used are named, with the reason. Where trials are pooled, a "
        "run counts once: of several of one setting the newest.",
    )
    add = made.add_argument
    add("outputs", type=Path, nargs="?", default=Path("outputs"), help="folder with "
        "<experiment>/<key>/ [outputs]")  # fmt: skip
    add(
        "keys",
        nargs="*",
        metavar="KEY",
        help="only these runs: folders, files in them, or beginnings of keys",
    )
    add("--where", metavar="SQL", help="only runs that fulfil a condition: \"map = 'kg18_test3' "
        "and planner.population >= 80\"")  # fmt: skip
    add("--last", type=int, metavar="N", help="only the N newest of them")
    add("--columns", metavar="A,B", help="the columns to show; with --group, behind those of it")
    add("--group", metavar="A,B", help="a row for all runs with the same values in these columns: "
        "trials, success, what a success is expected to take")  # fmt: skip
    add("--sort", metavar="COLUMN", help="the column that orders the rows; -COLUMN: descending")
    add("--sql", metavar="SELECT", help="answer a question in DuckDB's SQL to the tables runs "
        "and trials")  # fmt: skip
    shape = made.add_mutually_exclusive_group()
    shape.add_argument("--json", action="store_true", help="write JSON, with all columns")
    shape.add_argument("--csv", action="store_true", help="write CSV, with all columns")
    return made


def main(arguments: Sequence[str]) -> None:
    """Answer on the standard output; raises InputError for what cannot be answered."""
    given = parser().parse_args(list(arguments))
    for name in ("columns", "group", "sort") if given.sql is not None else ():
        require(getattr(given, name) is None, f"--{name}", "--sql, too", "only one of them")
    runs = find_runs(given.outputs)
    frame, came = described(runs)
    for fault in said_of(runs)[1]:
        print(fault, file=sys.stderr)
    places = _places(given, frame)
    if not places:
        print("no such runs", file=sys.stderr)
    if not places and given.sql is not None:  # no trials, so nobody knows what columns they have
        if given.json or given.csv:
            _write(given, Answer([], []))
        return
    if given.sql is not None:
        places = _counting(frame, runs, places)
        answer, bad = asked(given.sql, frame.iloc[places], [runs[place] for place in places])
        for name in bad:
            _tell(f"left out {name}: its trials cannot be read")
        _write(given, answer)
    elif given.group is not None:
        by = _columns("--group", given.group, ["key", *frame])
        places = _counting(frame, runs, places)
        results = [each for each in (came[place] for place in places) if each]
        _group(given, grouped(frame.iloc[places].reset_index(), results, by), by)
    else:
        for place in places:
            if runs[place].fault or frame["fault"].notna().iloc[place]:
                _tell(f"{runs[place].name}: {frame['fault'].iloc[place]}")
        _list(given, frame.iloc[places], frame.index)


def _places(given: argparse.Namespace, frame: pd.DataFrame) -> list[int]:
    """Choose runs: their places in the frame, the oldest first."""
    places: list[int] = frame.reset_index().sort_values(["date", "key"]).index.tolist()
    if given.keys:
        wanted = {find_run(given.outputs, name).name for name in given.keys}
        places = [place for place in places if frame.index[place] in wanted]
    if given.where is not None:
        fulfil = set(matching(frame, given.where))
        places = [place for place in places if place in fulfil]
    if given.last is not None:
        require(given.last > 0, "--last", given.last, "how many runs")
        places = places[-given.last :]
    return places


def _counting(frame: pd.DataFrame, runs: Sequence[RunRecord], places: Sequence[int]) -> list[int]:
    """Keep the runs whose trials count, and name the others."""
    kept = []
    for place, fault, newer in zip(
        places, *(frame[name].iloc[places] for name in ("fault", "superseded")), strict=True
    ):
        if pd.notna(fault):
            _tell(f"left out {runs[place].name}: {fault}")
        elif pd.notna(newer):
            reason = f"{newer} counts, of the same setting"
            _tell(f"left out {runs[place].name}: {reason}")
        else:
            kept.append(place)
    return kept


def _tell(line: str) -> None:
    print(printable(line), file=sys.stderr)


def _list(given: argparse.Namespace, frame: pd.DataFrame, keys: Iterable[str]) -> None:
    rows = _sorted(given, frame.reset_index())
    if given.columns is not None:
        rows = rows[_columns("--columns", given.columns, rows)]
        if "key" in rows and not (given.json or given.csv):
            rows = rows.assign(key=rows["key"].map(short_keys(keys)))
        _write(given, Answer.of(rows))
    elif given.json or given.csv:
        _write(given, Answer.of(rows))
    else:
        rows = listed(rows, keys)
        _write(given, Answer.of(rows), importance(rows))


def _group(given: argparse.Namespace, rows: pd.DataFrame, by: list[str]) -> None:
    rows = _sorted(given, rows)
    if given.columns is not None:
        wanted = _columns("--columns", given.columns, rows)
        rows = rows[[*(name for name in by if name not in wanted), *wanted]]
    elif not (given.json or given.csv):
        wanted = [*by, *FIGURES, *(name for name in METRICS if name not in SPENT)]
        rows = rows[[name for name in rows if name in wanted]]
        rows = rows.loc[:, rows.notna().any() | rows.empty]
    _write(given, Answer.of(rows), {name: -i for i, name in enumerate(METRICS)})


def _columns(where: str, names: str, known: Iterable[str]) -> list[str]:
    found = [name.strip() for name in names.split(",")]
    known = list(known)
    for name in found:
        require(name in known, where, name, f"a column{near(name, known)}")
    return list(dict.fromkeys(found))


def _sorted(given: argparse.Namespace, rows: pd.DataFrame) -> pd.DataFrame:
    if given.sort is None:
        return rows
    (name,) = _columns("--sort", given.sort.removeprefix("-"), rows)
    return rows.sort_values(name, ascending=not given.sort.startswith("-"), kind="stable")


def _write(
    given: argparse.Namespace, answer: Answer, losable: Mapping[str, float] = MappingProxyType({})
) -> None:
    if given.csv:
        write_csv(answer, sys.stdout)
    elif given.json:
        write_json(answer, sys.stdout)
    else:
        width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        write_text(answer, sys.stdout, width, losable)
