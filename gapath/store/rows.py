"""Rows of trials as Parquet: written as they come, read a column at a time."""

import io
import mmap
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from gapath.store.durable import named, open_regular, part_file, part_of, publish
from gapath.store.settings import Value

BATCH = 1 << 14
"""Rows that are in memory at once; fewer are one group of the file."""

_LEAN: dict[str, Any] = {"write_statistics": False, "store_schema": False}
"""Without a column's least and greatest value and a copy of the schema, of which nothing is read,
a file of a hundred trials is half as long: most of it speaks of its columns."""


class RowWriter:
    """Writes rows into a file that is open; see `written_rows`.

    Columns are made from buffers: from Python's objects pyarrow would make them with pandas,
    whose import takes as long as everything else that a short run does.
    """

    def __init__(
        self,
        path: Path,
        file: IO[bytes],
        columns: Mapping[str, type],
        constants: Mapping[str, Value],
    ) -> None:
        self._path, self._file = path, file
        self._columns, self._constants = columns, constants
        self._rows: list[Sequence[Any]] = []
        self._made = io.BytesIO()
        self._writer: Any = None

    def add(self, row: Sequence[Any]) -> None:
        """Add a row: a value for each column; raises InputError if it cannot be written."""
        self._rows.append(row)
        if len(self._rows) == BATCH:
            self._write()

    def finish(self) -> None:
        """Write what is left; raises InputError if it cannot be written."""
        if self._rows:
            self._write()
        self._writer.close()
        self._drain()

    def _write(self) -> None:
        import pyarrow as pa
        from pyarrow import parquet

        count, values = len(self._rows), zip(*self._rows, strict=True)
        arrays = [
            _array(column, np.uint64 if name == "seed" else kind)
            for (name, kind), column in zip(self._columns.items(), values, strict=True)
        ]
        for value in self._constants.values():
            nothing = value is None
            arrays.append(pa.nulls(count) if nothing else _array((value,) * count, type(value)))
        table = pa.Table.from_arrays(arrays, [*self._columns, *self._constants])
        if self._writer is None:
            self._writer = parquet.ParquetWriter(self._made, table.schema, **_LEAN)
        self._writer.write_table(table)
        self._rows = []
        self._drain()

    def _drain(self) -> None:
        with named(self._path):
            self._file.write(self._made.getvalue())
        self._made.seek(0)
        self._made.truncate()


@contextmanager
def written_rows(
    path: Path, columns: Mapping[str, type], constants: Mapping[str, Value]
) -> Iterator[RowWriter]:
    """Write rows as a Parquet file, which is there whole or not at all.

    Parameters
    ----------
    path : Path
        The file.
    columns : mapping of str to type
        Their names in order, and str, int, float or bool for each.
    constants : mapping of str to str, int, float, bool or None
        Columns that have the same value in all rows, behind the others.

    Yields
    ------
    RowWriter
        Takes the rows. Seeds are unsigned, since they reach 2**64 - 1.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    with part_file(path) as file:
        rows = RowWriter(path, file, columns, constants)
        yield rows
        rows.finish()
    publish(part_of(path), path)


class StoredRows(Mapping[str, NDArray[Any]]):
    """The columns of a Parquet file, each read when it is asked for, and not kept.

    Parameters
    ----------
    path : Path
        A file that `written_rows` has made. It may be replaced meanwhile; this one is read on.

    Raises
    ------
    InputError
        If it cannot be opened.
    """

    def __init__(self, path: Path) -> None:
        with named(path), open_regular(path) as file:
            self._content = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self._about = self._opened().metadata

    def _opened(self, **settings: Any) -> Any:
        import pyarrow as pa
        from pyarrow import parquet

        return parquet.ParquetFile(pa.BufferReader(pa.py_buffer(self._content)), **settings)

    @cached_property
    def _kinds(self) -> dict[str, str]:
        schema = self._about.schema.to_arrow_schema()
        return {name: str(kind) for name, kind in zip(schema.names, schema.types, strict=True)}

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Read a column: (n,) bool, int64, uint64, float64, or object, of str."""
        kind = self._kinds[name]
        texts = [name] if kind == "string" else []
        file = self._opened(metadata=self._about, read_dictionary=texts)
        chunks = file.read([name], use_threads=False).column(0).chunks
        return np.concatenate([_values(chunk, kind) for chunk in chunks])

    def __iter__(self) -> Iterator[str]:
        """Give the names of the columns."""
        return iter(self._kinds)

    def __len__(self) -> int:
        """Count the columns."""
        return len(self._kinds)


def _values(chunk: Any, kind: str) -> NDArray[Any]:
    """Give a chunk's values from its buffers: pyarrow would import pandas for it."""
    if kind == "string":
        names = np.array(chunk.dictionary.to_pylist(), dtype=object)
        return np.asarray(names[_values(chunk.indices, "int32")])
    if kind == "null":
        return np.full(len(chunk), None)
    begin, end, data = chunk.offset, chunk.offset + len(chunk), chunk.buffers()[1]
    if kind == "bool":
        bits = np.frombuffer(data, np.uint8)
        return np.unpackbits(bits, count=end, bitorder="little")[begin:].astype(np.bool_)
    return np.frombuffer(data, _NUMBERS.get(kind, kind), count=end)[begin:]


_NUMBERS = {"double": "float64"}


def written(table: Any) -> bytes:
    """Write a table of Arrow as a Parquet file.

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
    parquet.write_table(table, file, **_LEAN)
    return file.getvalue()


def _array(values: Sequence[Any], kind: type) -> Any:
    import pyarrow as pa

    count = len(values)
    if kind is str:
        alike = values.count(values[0]) == count
        texts = [values[0].encode()] * count if alike else [value.encode() for value in values]
        ends = np.cumsum([0, *map(len, texts)]).astype(np.int32)
        joined = pa.py_buffer(b"".join(texts))
        return pa.StringArray.from_buffers(count, pa.py_buffer(ends), joined)
    if kind is bool:
        bits = np.packbits(np.array(values, dtype=np.bool_), bitorder="little")
        return pa.Array.from_buffers(pa.bool_(), count, [None, pa.py_buffer(bits)])
    known: dict[Any, Any] = {
        float: (pa.float64(), np.float64),
        np.uint64: (pa.uint64(), np.uint64),
    }
    arrow, number = known.get(kind, (pa.int64(), np.int64))
    numbers = np.array(values, dtype=number)
    return pa.Array.from_buffers(arrow, count, [None, pa.py_buffer(numbers)])
