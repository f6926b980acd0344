"""Runs as a table: a row a run, its settings and what came of it as columns."""

import dataclasses
import json
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from tqdm import tqdm

from gapath.errors import InputError, printable
from gapath.pipelines.reading.counted import superseded
from gapath.pipelines.reading.names import told_apart
from gapath.pipelines.reading.query import connect, quoted, refusal
from gapath.pipelines.reading.results import results_of
from gapath.pipelines.reading.tags import UNSAID, Said, said_of
from gapath.store.provenance.git import commit_of
from gapath.store.records import RunRecord
from gapath.store.results import Results
from gapath.store.settings import tabular

_OWN = {
    "experiment": "str", "task": "str", "map": "str", "map_instance": "Int64", "start": "str",
    "target": "str", "method": "str", "preset": "str", "seed": "UInt64", "trials": "Int64",
    "code": "str", "commit": "str", "gapath_commit": "str", "tags": "str", "note": "str",
    "state": "str", "date": "str", "fault": "str", "superseded": "str",
}  # fmt: skip
"""Columns that every frame has, and their types."""

_SAID = ("name", *_OWN)
"""Settings that the columns say already."""


def run_frame(runs: Sequence[RunRecord]) -> pd.DataFrame:
    """Make a table of runs.

    Parameters
    ----------
    runs : sequence of RunRecord
        The runs.

    Returns
    -------
    DataFrame
        One row a run in the order given, the index `key` the name of its folder. Columns:

        - experiment, task, map, map_instance, start, target, method, preset, seed, trials, code
          (a hash of the sources), state and date, as the manifest and the status say, names of
          maps and methods told apart; of a run without a manifest what is known;
        - commit, of the working directory, and gapath_commit, of gapath's own source, with
          "-dirty" behind where files were changed; tags and note, what people say of it;
        - fault, why a run cannot be used, and superseded, the key of the run that counts in its
          place; null of all others;
        - every setting under its full name, lists as JSON, null where a run has none;
        - success, the share of trials that succeeded, and for every numeric column of the trials
          the mean over those where it is defined; null of runs that cannot be used.
    """
    return described(runs)[0]


def described(runs: Sequence[RunRecord]) -> tuple[pd.DataFrame, list[Results | None]]:
    """Make a table of runs as `run_frame` does, and give what each of them came to."""
    older = any(not run.fault and not run.known.results for run in runs)  # which takes longer
    pairs = [_with_results(run) for run in tqdm(runs, "runs", disable=None if older else True)]
    came = [results for _, results in pairs]
    settings = [_settings(run) for run, _ in pairs]
    runs = _named([run for run, _ in pairs])
    keys = pd.Index([run.folder.name for run in runs], dtype="str", name="key")
    said, _ = said_of(runs)
    newer = {id(run): other.folder.name for run, other in superseded(runs)}
    own = [_own(run, said) | {"superseded": newer.get(id(run))} for run in runs]
    means = [_means(results) if results else {} for results in came]
    columns: dict[str, Any] = {name: _column(own, name, kind) for name, kind in _OWN.items()}
    columns |= {name: _column(settings, name) for name in _names(settings) if name not in _SAID}
    columns |= {
        name: _column(means, name, "float64")
        for name in ("success", *_names(means))
        if name not in columns
    }
    return pd.DataFrame(columns, index=keys), came


def chosen(frame: pd.DataFrame, where: str) -> pd.DataFrame:
    """Choose rows of a table by a condition.

    Parameters
    ----------
    frame : DataFrame
        A table as `run_frame` gives it, or part of one.
    where : str
        An expression of DuckDB's SQL over the columns and `key`, names with dots as they are:
        ``map = 'kg18_test3' and planner.population >= 80``.

    Returns
    -------
    DataFrame
        The rows that fulfil it, in their order.

    Raises
    ------
    InputError
        If it is no such expression, or names an unknown column: gives the nearest.
    """
    return frame.iloc[matching(frame, where)]


def matching(frame: pd.DataFrame, where: str) -> list[int]:
    """Tell the places of the rows that `chosen` gives, ascending."""
    import duckdb
    import pyarrow as pa

    table = frame.reset_index()
    text = quoted(where, table.columns, "where")
    table = table.assign(**{_PLACE: range(len(table))})
    with connect() as connection:
        rows = connection.from_arrow(pa.Table.from_pandas(table, preserve_index=False))
        try:
            found = rows.filter(duckdb.SQLExpression(text)).select(_PLACE).fetchall()
        except duckdb.Error as error:
            raise refusal(error, where, list(table.columns), "where") from error
    return sorted(place for (place,) in found)


_PLACE = "place_of_the_row"


def checked(run: RunRecord) -> RunRecord:
    """Read a run's settings and results; one of which they cannot be read has that as its fault."""
    return _with_results(run)[0]


def _with_results(run: RunRecord) -> tuple[RunRecord, Results | None]:
    if run.fault:
        return run, None
    try:
        return run, results_of(run) if run.settings is not None else None
    except InputError as error:
        return dataclasses.replace(run, fault=str(error)), None


def _named(runs: Sequence[RunRecord]) -> list[RunRecord]:
    """Give the runs that can be used names that tell them apart."""
    names = iter(told_apart([run for run in runs if not run.fault]))
    return [run if run.fault else next(names) for run in runs]


def _own(run: RunRecord, said: Mapping[str, Said]) -> dict[str, Any]:
    known: dict[str, Any] = {"experiment": run.folder.parent.name}
    if run.manifest:
        origin = run.manifest.provenance or {}
        known = {
            **vars(run.manifest),
            "code": run.manifest.versions.get("code"),
            "commit": commit_of(origin.get("directory")),
            "gapath_commit": commit_of(origin.get("gapath")),
        }
    mine = said.get(run.name, UNSAID)
    known |= {"tags": printable(", ".join(mine.tags)) or None, "note": printable(mine.note) or None}
    return {**known, "state": str(run.state), "date": run.date, "fault": run.fault or None}


def _settings(run: RunRecord) -> Mapping[str, Any]:
    try:
        return tabular(run.settings)
    except InputError:  # of a run that cannot be used: its fault says why
        return {}


def _means(came: Results) -> dict[str, float | None]:
    counts, sums = came.counts, came.sums
    means = {name: total / came.trials for name, total in sums.items()}
    partly = {name: sums[name] / count if count else None for name, count in counts.items()}
    return {"success": came.succeeded / came.trials, **means, **partly}


def _names(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    return list(dict.fromkeys(name for row in rows for name in row))


def _column(rows: Sequence[Mapping[str, Any]], name: str, kind: str = "") -> Any:
    """Make a column of one type, null where a row lacks it."""
    values = [row.get(name) for row in rows]
    if kind:
        return pd.array(values, dtype=kind)
    kinds = {type(value) for value in values} - {type(None)}
    if kinds == {bool}:
        return pd.array(values, dtype="boolean")
    if kinds == {int}:
        try:
            return pd.array(values, dtype="Int64")
        except OverflowError:
            kinds = {float}
    if kinds and kinds <= {int, float}:
        return pd.array(values, dtype="float64")
    if kinds:
        text = [value if isinstance(value, str | None) else json.dumps(value) for value in values]
        return pd.array(text, dtype="str")
    return pd.array(values, dtype="object")


def setting_columns(frame: pd.DataFrame) -> list[str]:
    """Name the columns of a table of runs that are settings."""
    names = list(frame)
    return names[names.index("superseded") + 1 : names.index("success")]
