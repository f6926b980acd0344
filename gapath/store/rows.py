"""Rows of trials as Parquet."""

import io
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from gapath.store.settings import Value


def parquet(
    columns: Mapping[str, type],
    rows: Sequence[Mapping[str, Any]],
    constants: Mapping[str, Value] = MappingProxyType({}),
) -> bytes:
    """Write rows as a Parquet file.

    Columns are made from buffers: from Python's objects pyarrow would make them with pandas,
    whose import takes as long as everything else that a short run does.

    Parameters
    ----------
    columns : mapping of str to type
        Their names in order, and str, int, float or bool for each.
    rows : sequence of mapping
        One row a trial: column -> value.
    constants : mapping of str to str, int, float, bool or None
        Columns that have the same value in all rows, behind the others.

    Returns
    -------
    bytes
        The file. Seeds are unsigned, since they reach 2**64 - 1.
    """
    import pyarrow as pa

    arrays = [
        _array([row[name] for row in rows], np.uint64 if name == "seed" else kind)
        for name, kind in columns.items()
    ]
    for value in constants.values():
        nothing = value is None
        arrays.append(pa.nulls(len(rows)) if nothing else _array([value] * len(rows), type(value)))
    return written(pa.Table.from_arrays(arrays, [*columns, *constants]))


def written(table: Any) -> bytes:
    """Write a table of Arrow as a Parquet file.

    Without a column's least and greatest value and a copy of the schema, of which nothing is
    read, a file of a hundred trials is half as long: most of it speaks of its columns.

    Parameters
    ----------
    table : pyarrow.Table
        The table.

    Returns
    -------
    bytes
        The file.
    """
    from pyarrow import parquet

    file = io.BytesIO()
    parquet.write_table(table, file, write_statistics=False, store_schema=False)
    return file.getvalue()


def _array(values: list[Any], kind: type) -> Any:
    import pyarrow as pa

    if kind is str:
        texts = [value.encode() for value in values]
        ends = np.cumsum([0, *map(len, texts)]).astype(np.int32)
        joined = pa.py_buffer(b"".join(texts))
        return pa.StringArray.from_buffers(len(values), pa.py_buffer(ends), joined)
    if kind is bool:
        bits = np.packbits(np.array(values, dtype=np.bool_), bitorder="little")
        return pa.Array.from_buffers(pa.bool_(), len(values), [None, pa.py_buffer(bits)])
    known: dict[Any, Any] = {
        float: (pa.float64(), np.float64),
        np.uint64: (pa.uint64(), np.uint64),
    }
    arrow, number = known.get(kind, (pa.int64(), np.int64))
    numbers = np.array(values, dtype=number)
    return pa.Array.from_buffers(arrow, len(values), [None, pa.py_buffer(numbers)])
