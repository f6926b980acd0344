"""Rows of trials as Parquet."""

import io
from dataclasses import fields
from typing import Any

import numpy as np


def parquet(kind: type[Any], rows: list[Any]) -> bytes:
    """Write rows as a Parquet file.

    Columns are made from buffers: from Python's objects pyarrow would make them with pandas,
    whose import takes as long as everything else that a short run does.

    Parameters
    ----------
    kind : type
        The dataclass of the rows; its fields are str, int, float or bool.
    rows : list of dataclass
        One row a trial.

    Returns
    -------
    bytes
        The file. Seeds are unsigned, since they reach 2**64 - 1.
    """
    import pyarrow as pa
    from pyarrow import parquet

    arrays = []
    for field in fields(kind):
        values = [getattr(row, field.name) for row in rows]
        if field.type is str:
            texts = [value.encode() for value in values]
            ends = np.cumsum([0, *map(len, texts)]).astype(np.int32)
            joined = pa.py_buffer(b"".join(texts))
            arrays.append(pa.StringArray.from_buffers(len(rows), pa.py_buffer(ends), joined))
        elif field.type is bool:
            bits = np.packbits(np.array(values, dtype=np.bool_), bitorder="little")
            arrays.append(pa.Array.from_buffers(pa.bool_(), len(rows), [None, pa.py_buffer(bits)]))
        else:
            arrow, numpy = (
                (pa.float64(), np.float64) if field.type is float
                else (pa.uint64(), np.uint64) if field.name == "seed"
                else (pa.int64(), np.int64)
            )  # fmt: skip
            numbers = pa.py_buffer(np.array(values, dtype=numpy))
            arrays.append(pa.Array.from_buffers(arrow, len(rows), [None, numbers]))
    file = io.BytesIO()
    parquet.write_table(pa.Table.from_arrays(arrays, [f.name for f in fields(kind)]), file)
    return file.getvalue()
