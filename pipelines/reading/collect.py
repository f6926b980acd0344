"""From run folders to tidy frames, one for each task: a row a trial."""

import hashlib
import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import parquet, types
from tqdm import tqdm

from gapath.discovery import kinds
from gapath.errors import InputError, require
from gapath.pipelines.reading.bounded import check_amounts, check_size, plain, plain_texts
from gapath.pipelines.reading.counted import superseded
from gapath.pipelines.reading.names import told_apart
from gapath.store.records import CONFIG, TRIALS, RunRecord
from gapath.task import columns, find_task, metrics

_TEXT = pa.dictionary(pa.int32(), pa.string())


class _Form(NamedTuple):
    """How a column is held."""

    fits: Callable[[pa.DataType], bool]
    what: str
    held: pa.DataType


def _is_number(kind: pa.DataType) -> bool:
    return bool(types.is_integer(kind) or types.is_floating(kind) or types.is_boolean(kind))


def _is_text(kind: pa.DataType) -> bool:
    kind = kind.value_type if types.is_dictionary(kind) else kind
    return bool(types.is_string(kind) or types.is_large_string(kind))


_FORMS: dict[type, _Form] = {
    str: _Form(_is_text, "text", _TEXT),
    int: _Form(_is_number, "whole numbers", pa.int64()),
    float: _Form(_is_number, "numbers", pa.float64()),
    bool: _Form(types.is_boolean, "booleans", pa.bool_()),
}
_SEED = _Form(_is_number, "whole numbers from 0", pa.uint64())

_TOGETHER = 64
"""Runs that a thread reads at a time, and whose rows are put together: thousands of small pieces
take more room."""


class Skipped(NamedTuple):
    """A run that no number is made from, and why."""

    run: str
    reason: str


class Collected(NamedTuple):
    """What `read_trials` gives."""

    trials: dict[str, pd.DataFrame]
    """For each task one row a trial: the columns of its rows, and `key`, the name of the run's
    folder. Text but the key is categorical, its categories in the alphabet's order. What a run
    was set to is not repeated in each of its rows: `RunRecord.settings` has it."""
    skipped: list[Skipped]
    runs: list[RunRecord]
    """The runs that they come from, under names that tell them apart."""


def read_trials(runs: Iterable[RunRecord]) -> Collected:
    """Read the trials of runs.

    Of several runs of one setting only one counts (`superseded`).

    Parameters
    ----------
    runs : iterable of RunRecord
        The runs.

    Returns
    -------
    trials : dict of str to DataFrame
        Task -> one row a trial, failures included; empty if no run of the task can be used.
    skipped : list of Skipped
        The runs that were left out, and why.
    runs : list of RunRecord
        The runs that the trials come from, under names that tell them apart.
    """
    runs = sorted(runs, key=lambda run: run.name)
    older = superseded(runs)
    skipped = [Skipped(run.name, run.fault) for run in runs if run.fault]
    skipped += [Skipped(run.name, f"{new.name} counts, of the same setting") for run, new in older]
    left_out = {each.run for each in skipped}
    good = []
    for run in (run for run in runs if run.name not in left_out):
        try:
            good.append(plain(run))
        except InputError as error:
            skipped.append(Skipped(run.name, str(error)))
    used: list[RunRecord] = []
    rows: dict[str, list[pa.Table]] = {task: [] for task in kinds("task")}
    lengths: dict[str, list[int]] = {task: [] for task in rows}
    pieces = [good[at : at + _TOGETHER] for at in range(0, len(good), _TOGETHER)]
    progress = tqdm(total=len(good), desc="runs", disable=None)
    with ThreadPoolExecutor(os.cpu_count()) as pool, progress:
        for some, tables in zip(pieces, pool.map(_read_all, pieces), strict=True):
            fresh: dict[str, list[pa.Table]] = {task: [] for task in rows}
            for run, table in zip(some, tables, strict=True):
                if isinstance(table, InputError):
                    skipped.append(Skipped(run.name, str(table)))
                    continue
                used.append(run)
                fresh[run.known.task].append(table)
                lengths[run.known.task].append(len(table))
            for task, mine in fresh.items():
                if mine:
                    rows[task].append(_together(mine))
            progress.update(len(some))
    used = told_apart(used)
    trials = {}
    for task, counts in lengths.items():
        mine = [run for run in used if run.known.task == task]
        trials[task] = _frame(task, rows.pop(task), mine, counts)
    pa.default_memory_pool().release_unused()
    return Collected(trials, sorted(skipped), used)


def _together(tables: Iterable[pa.Table]) -> pa.Table:
    return pa.concat_tables(tables).unify_dictionaries().combine_chunks()


def _frame(
    task: str, rows: Sequence[pa.Table], runs: Sequence[RunRecord], lengths: Sequence[int]
) -> pd.DataFrame:
    """Make one frame of the rows of a task's runs; of each run so many, in their order."""
    kind = find_task(task)
    if not rows:
        return pd.DataFrame(columns=[*columns(kind.row), "key"])
    of_run = np.repeat(np.arange(len(runs)), lengths)
    table = pa.concat_tables(rows).unify_dictionaries()
    del rows
    frame = {}
    for name in table.column_names:
        column = table[name].to_pandas()
        table = table.drop_columns(name)  # so that no more than a column is there twice
        if isinstance(column.dtype, pd.CategoricalDtype):
            column = column.cat.reorder_categories(column.cat.categories.sort_values())
        frame[name] = column
    frame["key"] = pd.array([run.folder.name for run in runs], dtype="str")[of_run]
    frame["map"] = _spread_out([run.known.map for run in runs], of_run)
    frame[kind.groups[0]] = _spread_out([run.known.method for run in runs], of_run)
    return pd.DataFrame(frame, copy=False)


def _spread_out(texts: Sequence[str], of_run: NDArray[np.intp]) -> pd.Categorical:
    """Give each trial the text of its run."""
    names = sorted(set(texts))
    place = {name: i for i, name in enumerate(names)}
    codes = np.array([place[text] for text in texts], dtype=np.int32)
    return pd.Categorical.from_codes(codes[of_run], names)


def _read_all(runs: Sequence[RunRecord]) -> list[pa.Table | InputError]:
    return [_read(run) for run in runs]


def _read(run: RunRecord) -> pa.Table | InputError:
    """Read ``trials.parquet``, or tell why it cannot be used."""
    try:
        require(bool(run.settings), CONFIG, "nothing", "settings")  # sections rely on them
        return _rows(run, _forms(run.known.task))
    except InputError as error:
        return error


@lru_cache
def _forms(task: str) -> dict[str, _Form]:
    """Give for each column of a task's rows how it is held."""
    kinds = columns(find_task(task).row).items()
    return {name: _SEED if name == "seed" else _FORMS[kind] for name, kind in kinds}


def _rows(run: RunRecord, forms: Mapping[str, _Form]) -> pa.Table:
    """Read a run's rows; the hash of their file is checked, as every number comes from it."""
    expected = run.known.files[TRIALS].sha256
    try:
        content = (run.folder / TRIALS).read_bytes()
        found = hashlib.sha256(content).hexdigest()
        require(found == expected, TRIALS, f"SHA-256 {found[:12]}", f"{expected[:12]}, as the "
                "manifest says")  # fmt: skip
        file = _opened(content, [name for name, form in forms.items() if form.held == _TEXT])
        there = set(file.schema_arrow.names)
        # A metric that was added since, by a package perhaps, is missing; the run is still good.
        missing = sorted(set(forms) - there - set(metrics()))
        require(not missing, TRIALS, f"no column {', '.join(missing)}", "all columns of a trial")
        check_size(file.metadata, [name for name in forms if name in there], run.known.trials)
        table = file.read([name for name in forms if name in there], use_threads=False)
    except InputError:
        raise
    except Exception as error:  # pyarrow raises more kinds than it documents
        raise InputError(TRIALS, type(error).__name__, "readable Parquet") from error
    if "stage_times_s" in forms:
        _check_stages(table["stage_times_s"])
    arrays = [
        _column(name, table[name], form)
        if name in there
        else pa.array(np.full(len(table), math.nan))
        for name, form in forms.items()
    ]
    rows = pa.table(arrays, list(forms))
    check_amounts(rows, find_task(run.known.task).success)
    return rows


def _opened(content: bytes, texts: Sequence[str]) -> parquet.ParquetFile:
    """Open a file such that text is read as categories, if it has all these columns."""
    try:
        return parquet.ParquetFile(pa.BufferReader(content), read_dictionary=texts)
    except KeyError:
        return parquet.ParquetFile(pa.BufferReader(content))


def _column(name: str, column: pa.ChunkedArray, form: _Form) -> Any:
    """Give a column the type in which it is held; raise InputError where it has another kind."""
    where, kind = f"{TRIALS}, {name}", column.type
    good = not (types.is_boolean(kind) and column.null_count)
    if kind == form.held and good and form.held != _TEXT:
        return column
    require(good and form.fits(kind), where, "another type", form.what)
    if form.held == _TEXT:
        return _text(column, where)
    try:
        return column.cast(form.held)
    except pa.ArrowInvalid as error:
        raise InputError(where, "another type", form.what) from error


def _text(column: pa.ChunkedArray, where: str) -> Any:
    """Give text as categories, each of which can be shown."""
    column = column.cast(_TEXT) if types.is_dictionary(column.type) else column.dictionary_encode()
    column = column.unify_dictionaries().combine_chunks()
    if not len(column):
        return column.cast(_TEXT)
    given = column.dictionary.cast(pa.string()).to_pylist()
    plainly = plain_texts(given, where)
    if plainly == given:
        return column.cast(_TEXT)
    column = pa.DictionaryArray.from_arrays(column.indices, pa.array(plainly))
    return column.cast(pa.string()).dictionary_encode()  # two of them may be one now


def _check_stages(column: pa.ChunkedArray) -> None:
    try:
        stages = [json.loads(text) for text in column.unique().to_pylist()]
    except (TypeError, ValueError) as error:
        raise InputError(f"{TRIALS}, stage_times_s", "no JSON", "stages and seconds") from error
    good = all(isinstance(each, dict) for each in stages)
    require(good, f"{TRIALS}, stage_times_s", "no mapping", "stages and seconds")
