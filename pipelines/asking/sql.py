"""Questions in SQL to runs and their trials, straight from the files."""

from collections.abc import Iterable, Sequence
from decimal import Decimal
from typing import Any

import pandas as pd

from gapath.errors import InputError
from gapath.pipelines.asking.answer import Answer
from gapath.pipelines.reading.query import connect, literal, quoted, refusal
from gapath.store.records import TRIALS, RunRecord
from gapath.store.settings import tabular

WHERE = "--sql"
_OF_RUN = ("method", "preset", "code")
"""Columns of a run that its trials have, too."""

_NOTHING = "select null::varchar as key where false"
_RIGHT = "one SELECT over the tables runs and trials"


def asked(text: str, frame: pd.DataFrame, runs: Sequence[RunRecord]) -> tuple[Answer, list[str]]:
    """Answer a question in SQL.

    Parameters
    ----------
    text : str
        One SELECT of DuckDB's over two tables: ``runs``, the frame with its index ``key``, and
        ``trials``, the rows of all ``trials.parquet`` with the key, method, preset and code of
        their run; a column that a run lacks is null there, and so is NaN. Names with dots may be
        written as they are.
    frame : DataFrame
        Runs as `gapath.pipelines.reading.frame.run_frame` gives them.
    runs : sequence of RunRecord
        The same runs.

    Returns
    -------
    answer : Answer
        What comes out.
    unreadable : list of str
        Names of the runs that were left out, since their trials cannot be read.

    Raises
    ------
    InputError
        If it is anything else, or cannot be answered.
    """
    import duckdb

    unreadable: list[str] = []
    runs, together = list(runs), False
    while True:
        files = [str((run.folder / TRIALS).resolve()) for run in runs]
        alike = [files] if together else _alike(runs, files)
        try:
            return _answered(text, frame, alike, together), unreadable
        except duckdb.Error as error:
            message = str(error)
            (bad, *_) = (i for i, file in enumerate(files) if file in message)
            if "schema mismatch" in message and not together:
                together = True  # some files have other columns than their manifests tell
                continue
            unreadable.append(runs.pop(bad).name)
            frame = frame.drop(index=frame.index[bad])


def _answered(
    text: str, frame: pd.DataFrame, alike: Sequence[Sequence[str]], together: bool
) -> Answer:
    """Answer a question; raises DuckDB's error where a file cannot be read."""
    import duckdb
    import pyarrow as pa

    table = frame.reset_index()
    columns, files = list(table), [path for each in alike for path in each]
    with connect(files) as connection:
        connection.register("runs", pa.Table.from_pandas(table, preserve_index=False))
        try:
            parts = [_part(connection, each, together) for each in alike if each] or [_NOTHING]
            connection.execute(f"create view rows as {' union all by name '.join(parts)}")
            own = [row[0] for row in connection.execute("describe rows").fetchall()]
            both = ["rows.*", *(f"runs.{name}" for name in _OF_RUN if name not in own)]
            joined = f"select {', '.join(both)} from rows join runs using (key)"
            connection.execute(f"create view trials as {joined}")
            described = connection.execute("describe trials").fetchall()
            columns = list(dict.fromkeys([*columns, *(row[0] for row in described)]))
            statements = connection.extract_statements(quoted(text, columns, WHERE))
            if [each.type for each in statements] != [duckdb.StatementType.SELECT]:
                raise InputError(WHERE, text, _RIGHT)
            found = connection.execute(statements[0])
            names = [column[0] for column in found.description]
            rows = found.fetchall()
        except duckdb.Error as error:
            if any(file in str(error) for file in files):
                raise
            raise refusal(error, text, columns, WHERE) from error
    return Answer(names, [[_plain(row[i]) for row in rows] for i in range(len(names))])


def _plain(value: Any) -> Any:
    """Give decimals, which are sums and numbers with a point in DuckDB, as other numbers are."""
    if isinstance(value, list):
        return [_plain(each) for each in value]
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    return float(value) if isinstance(value, Decimal) else value


def _alike(runs: Iterable[RunRecord], files: Iterable[str]) -> list[list[str]]:
    """Give the files with trials, those together whose columns are the same.

    Runs of one task, one code and settings of the same names and types write the same columns,
    so that not every file has to be looked at.
    """
    found: dict[Any, list[str]] = {}
    for run, file in zip(runs, files, strict=True):
        kinds = tuple((name, type(value)) for name, value in tabular(run.settings).items())
        columns = (run.known.task, tuple(run.known.versions.items()), kinds)
        found.setdefault(columns, []).append(file)
    return list(found.values())


def _part(connection: Any, files: Sequence[str], together: bool) -> str:
    """Write the SELECT of the trials in files, with the same columns or not: NaN is null there."""
    listed = ", ".join(map(literal, files))
    source = f"read_parquet([{listed}], filename = true, union_by_name = {together})"
    kinds = connection.execute(f"describe select * exclude (filename) from {source}").fetchall()
    names = [_identifier(row[0]) for row in kinds if row[1] == "DOUBLE"]
    known = ", ".join(f"nullif({name}, 'nan'::double) as {name}" for name in names)
    rest = f"* exclude (filename) replace ({known})" if known else "* exclude (filename)"
    return f"select split_part(filename, '/', -2) as key, {rest} from {source}"


def _identifier(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
