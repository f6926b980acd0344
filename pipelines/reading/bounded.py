"""What a run of anybody may hold before it is read into tables: so much, such text, such numbers.

What does not keep to it is left out by name. Text that would do something where it is shown is
written so that it is seen instead.
"""

import dataclasses
import math
import shlex
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from gapath.errors import InputError, printable, require
from gapath.store.records import MANIFEST, TRIALS, RunRecord
from gapath.store.results import Results

MOST_TEXT = 4096
"""Characters of a name, a setting or a cell: those of a path."""

MOST_COMMAND = 1 << 16
"""Characters of a run's command."""

MOST_BYTES, MOST_OF_A_ROW = 1 << 24, 1000
"""Bytes that rows may take when they are unpacked: so many, and so many more for each."""

_AMOUNTS = ("cost", "optimal_cost", "evaluations", "epochs", "expansions", "steps")
_TIME = "_s"
"""How the names of columns end that hold seconds."""


def plain(run: RunRecord) -> RunRecord:
    """Give a run whose texts can be shown anywhere, and whose command can be typed.

    Parameters
    ----------
    run : RunRecord
        A run that can be used.

    Returns
    -------
    RunRecord
        The same, its texts `printable`, each word of its command quoted where it has to be.

    Raises
    ------
    InputError
        If a text is too long.
    """
    known = run.known
    given = {each.name: getattr(known, each.name) for each in dataclasses.fields(known)}
    command = given.pop("command")
    changed = {name: _shown(value, name) for name, value in given.items()}
    changed = {name: value for name, value in changed.items() if value is not given[name]}
    long = len(command) > MOST_COMMAND
    require(not long, f"{MANIFEST}, command", f"{len(command)} characters", f"{MOST_COMMAND}")
    if not command.isprintable() or not _WORDS.issuperset(command):
        try:
            typed = printable(shlex.join(shlex.split(command)))
        except ValueError:  # quotes without an end
            typed = printable(shlex.quote(command))
        changed |= {"command": typed} if typed != command else {}
    if not changed:
        return run
    return dataclasses.replace(run, manifest=dataclasses.replace(known, **changed))


_WORDS = frozenset(" abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_=.,:/@%+-")
"""Characters that a shell does nothing with."""


def _shown(value: Any, where: str) -> Any:
    """Give text, or a mapping to text, as it can be shown; the very same where it can be."""
    if isinstance(value, str):
        right = f"at most {MOST_TEXT}"
        require(len(value) <= MOST_TEXT, f"{MANIFEST}, {where}", f"{len(value)} characters", right)
        return value if value.isprintable() else printable(value)
    if isinstance(value, Mapping):
        if _all_shown(value):
            return value
        made = {_shown(name, where): _shown(item, where) for name, item in value.items()}
        same = all(a is b for pair in zip(made.items(), value.items(), strict=False)
                   for a, b in zip(*pair, strict=True))  # fmt: skip
        return value if same and len(made) == len(value) else made
    return value


def _all_shown(texts: Mapping[str, Any]) -> bool:
    """Tell at once of a mapping, as of all packages, that every text in it can be shown."""
    values = texts.values()
    told = [*texts, *(value for value in values if isinstance(value, str))]
    plainly = "".join(told).isprintable() and max(map(len, told), default=0) <= MOST_TEXT
    return plainly and not any(isinstance(value, Mapping) for value in values)


def check_size(metadata: Any, columns: Iterable[str], trials: int) -> None:
    """Raise InputError if rows are not as many as said, or take more room than they should.

    Parameters
    ----------
    metadata : pyarrow.parquet.FileMetaData
        Of a file that was opened, but not read.
    columns : iterable of str
        Those that are to be read.
    trials : int
        Rows that the manifest tells of.
    """
    require(metadata.num_rows == trials, TRIALS, f"{metadata.num_rows} rows", f"{trials}, as the "
            "manifest says")  # fmt: skip
    wanted, most = set(columns), MOST_BYTES + MOST_OF_A_ROW * trials
    groups = (metadata.row_group(i) for i in range(metadata.num_row_groups))
    parts = (group.column(i) for group in groups for i in range(group.num_columns))
    size = sum(part.total_uncompressed_size for part in parts if part.path_in_schema in wanted)
    require(size <= most, TRIALS, f"{size} bytes when unpacked", f"at most {most} for its rows")


def plain_texts(texts: list[str | None], where: str) -> list[str | None]:
    """Give the texts of a column as they can be shown; raises InputError if one is too long."""
    for text in texts:
        size = len(text or "")
        require(size <= MOST_TEXT, where, f"text of {size} characters", f"at most {MOST_TEXT}")
    return [None if text is None else printable(text) for text in texts]


def check_amounts(table: Any, success: str) -> None:
    """Raise InputError if an amount is negative, a time infinite, or a success has none.

    Parameters
    ----------
    table : pyarrow.Table
        Rows of trials.
    success : str
        The column that tells whether a trial succeeded.
    """
    succeeded = table[success].to_numpy()
    for name in table.column_names:
        timed = name.endswith(_TIME) and name != "stage_times_s"
        if not (timed or name in _AMOUNTS):
            continue
        values = table[name].to_numpy()
        wrong = values < 0
        if timed:
            wrong |= np.isinf(values)
        if name in ("cost", "plan_time_s", "compute_time_s"):
            wrong |= succeeded & ~np.isfinite(values)
        if wrong.any():
            raise InputError(f"{TRIALS}, {name}", values[wrong][0], "a finite number, not negative")


def check_sums(results: Results) -> None:
    """Raise InputError if trials cannot come to what a manifest says they came to.

    A cost is infinite where no path exists.
    """
    for name, total in results.sums.items():
        wrong = math.isnan(total) or (math.isinf(total) and "cost" not in name)
        wrong |= total < 0 and (name in _AMOUNTS or name.endswith(_TIME))
        require(not wrong, f"{MANIFEST}, results, {name}", total, "a sum that trials can come to")
