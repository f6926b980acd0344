"""Rows of trials as Parquet."""

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


def parquet(columns: Mapping[str, type], rows: Sequence[Mapping[str, Any]]) -> bytes:
    """Write rows as a Parquet file.

    Columns are made from buffers: from Python's objects pyarrow would make them with pandas,
    whose import takes as long as everything else that a short run does.

    Parameters
    ----------
    columns : mapping of str to type
        Their names in order, and str, int, float or bool for each.
    rows : sequence of mapping
        One row a trial: column -> value.

    Returns
    -------
    bytes
        The file. Seeds are unsigned, since they reach 2**64 - 1.
    """
    import pyarrow as pa
    from pyarrow import parquet

    arrays = []
    for name, kind in columns.items():
        values = [row[name] for row in rows]
        if kind is str:
            texts = [value.encode() for value in values]
            ends = np.cumsum([0, *map(len, texts)]).astype(np.int32)
            joined = pa.py_buffer(b"".join(texts))
            arrays.append(pa.StringArray.from_buffers(len(rows), pa.py_buffer(ends), joined))
        elif kind is bool:
            bits = np.packbits(np.array(values, dtype=np.bool_), bitorder="little")
            arrays.append(pa.Array.from_buffers(pa.bool_(), len(rows), [None, pa.py_buffer(bits)]))
        else:
            arrow, numpy = (
                (pa.float64(), np.float64) if kind is float
                else (pa.uint64(), np.uint64) if name == "seed"
                else (pa.int64(), np.int64)
            )  # fmt: skip
            numbers = pa.py_buffer(np.array(values, dtype=numpy))
            arrays.append(pa.Array.from_buffers(arrow, len(rows), [None, numbers]))
    file = io.BytesIO()
    parquet.write_table(pa.Table.from_arrays(arrays, list(columns)), file)
    return file.getvalue()
