"""Questions in SQL to runs and their trials, straight from the files."""

from collections.abc import Iterable, Sequence
from typing import Any

import pandas as pd

from gapath.errors import InputError
from gapath.pipelines.asking.answer import Answer
from gapath.pipelines.reading.query import connect, literal, quoted, refusal
from gapath.store.records import TRIALS, RunRecord
from gapath.store.settings import tabular

WHERE = "--sql"
_RIGHT = "one SELECT over the tables runs and trials"


def asked(text: str, frame: pd.DataFrame, runs: Sequence[RunRecord]) -> Answer:
    """Answer a question in SQL.

    Parameters
    ----------
    text : str
        One SELECT of DuckDB's over two tables: ``runs``, the frame with its index ``key``, and
        ``trials``, the rows of all ``trials.parquet`` with the ``key`` of their run; a column
        that a run lacks is null there, and so is NaN. Names with dots may be written as they are.
    frame : DataFrame
        Runs as `gapath.pipelines.reading.frame.run_frame` gives them.
    runs : sequence of RunRecord
        The same runs.

    Returns
    -------
    Answer
        What comes out.

    Raises
    ------
    InputError
        If it is anything else, or cannot be answered.
    """
    import duckdb
    import pyarrow as pa

    alike = _alike(runs)
    columns = list(frame.reset_index())
    with connect([path for files in alike for path in files]) as connection:
        connection.register("runs", pa.Table.from_pandas(frame.reset_index(), preserve_index=False))
        try:
            parts = [_part(connection, files) for files in alike]
            connection.execute(f"create view trials as {' union all by name '.join(parts)}")
            described = connection.execute("describe trials").fetchall()
            columns = list(dict.fromkeys([*columns, *(row[0] for row in described)]))
            statements = connection.extract_statements(quoted(text, columns, WHERE))
            if [each.type for each in statements] != [duckdb.StatementType.SELECT]:
                raise InputError(WHERE, text, _RIGHT)
            found = connection.execute(statements[0])
            names = [column[0] for column in found.description]
            rows = found.fetchall()
        except duckdb.Error as error:
            raise refusal(error, text, columns, WHERE) from error
    return Answer(
        names, [list(column) for column in zip(*rows, strict=True)] or [[] for _ in names]
    )


def _alike(runs: Iterable[RunRecord]) -> list[list[str]]:
    """Give the files with trials, those together whose columns are the same.

    Runs of one task, one code and settings of the same names and types write the same columns,
    so that not every file has to be looked at.
    """
    found: dict[Any, list[str]] = {}
    for run in runs:
        kinds = tuple((name, type(value)) for name, value in tabular(run.settings).items())
        columns = (run.known.task, tuple(run.known.versions.items()), kinds)
        found.setdefault(columns, []).append(str((run.folder / TRIALS).resolve()))
    return list(found.values())


def _part(connection: Any, files: Sequence[str]) -> str:
    """Write the SELECT of the trials in files with the same columns: NaN is null there."""
    source = f"read_parquet([{', '.join(map(literal, files))}], filename = true)"
    kinds = connection.execute(f"describe select * exclude (filename) from {source}").fetchall()
    names = [_identifier(row[0]) for row in kinds if row[1] == "DOUBLE"]
    known = ", ".join(f"nullif({name}, 'nan'::double) as {name}" for name in names)
    rest = f"* exclude (filename) replace ({known})" if known else "* exclude (filename)"
    return f"select split_part(filename, '/', -2) as key, {rest} from {source}"


def _identifier(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
