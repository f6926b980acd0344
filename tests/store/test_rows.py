"""Rows as Parquet: every type comes back as it was, column by column."""

import io
import math
import subprocess
import sys
import tracemalloc
from dataclasses import dataclass, fields

import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.errors import InputError
from gapath.store import rows as stored
from gapath.store.rows import StoredRows, written, written_rows


@dataclass(frozen=True)
class Row:
    name: str
    seed: int
    count: int
    good: bool
    value: float


COLUMNS = {field.name: field.type for field in fields(Row)}

rows = st.builds(
    Row,
    st.text(st.characters(exclude_categories=["Cs"])),
    st.integers(0, 2**64 - 1),
    st.integers(-(2**63), 2**63 - 1),
    st.booleans(),
    st.floats(allow_nan=False),
)


@pytest.fixture(scope="module")
def parquet(tmp_path_factory):
    """Write rows; give the file."""

    def write(rows, constants=None):
        path = tmp_path_factory.mktemp("rows") / "trials.parquet"
        with written_rows(path, COLUMNS, constants or {}) as file:
            for row in rows:
                file.add([*row.__dict__.values()])
        return path

    return write


@given(st.lists(rows, min_size=1, max_size=30), st.integers(1, 12))
def test_rows_come_back(parquet, drawn, batch):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stored, "BATCH", batch)
        path = parquet(drawn)
    table = pq.read_table(path)
    assert table.to_pylist() == [row.__dict__ for row in drawn]
    names = [str(field.type) for field in table.schema]
    assert names == ["string", "uint64", "int64", "bool", "double"]
    assert pq.ParquetFile(path).num_row_groups == math.ceil(len(drawn) / batch)
    found = StoredRows(path)
    assert [*found] == [*COLUMNS] and len(found) == len(COLUMNS)
    for name, column in found.items():
        assert column.tolist() == [getattr(row, name) for row in drawn], name
    kinds = [str(column.dtype) for column in found.values()]
    assert kinds == ["object", "uint64", "int64", "bool", "float64"]


def test_rows_of_one_batch_are_written_as_one_table(parquet):
    path = parquet([Row(f"r{i % 7}", i, -i, i % 3 == 0, i / 7) for i in range(3000)], {"n": None})
    assert path.read_bytes() == written(pq.read_table(path))


def test_what_all_rows_share_stands_in_columns_of_its_type(parquet):
    shared = {"map.start": "[0, 1]", "population": 40, "rate": 0.5, "stop": True, "limit": None}
    path = parquet([Row("", 0, 0, True, 1.0)] * 3, shared)
    table = pq.read_table(path)
    assert table.select(list(shared)).to_pylist() == [shared] * 3
    names = [str(table.schema.field(name).type) for name in shared]
    assert names == ["string", "int64", "double", "bool", "null"]
    assert {name: StoredRows(path)[name].tolist() for name in shared} == {
        name: [value] * 3 for name, value in shared.items()
    }


def test_nan_comes_back(parquet):
    path = parquet([Row("", 0, 0, True, math.nan)])
    assert math.isnan(pq.read_table(path).column("value")[0].as_py())
    assert math.isnan(StoredRows(path)["value"][0])


def test_a_file_that_is_replaced_is_read_on(parquet):
    path, other = parquet([Row("old", 0, 0, True, 1.0)]), parquet([Row("new", 0, 0, True, 1.0)])
    found = StoredRows(path)
    other.replace(path)
    assert (found["name"], StoredRows(path)["name"]) == ("old", "new")


def test_no_file_is_one_line(tmp_path):
    with pytest.raises(InputError, match=r"trials\.parquet"):
        StoredRows(tmp_path / "trials.parquet")


def test_rows_that_fail_leave_no_file(tmp_path):
    path = tmp_path / "trials.parquet"
    with pytest.raises(KeyError), written_rows(path, COLUMNS, {}) as file:
        file.add([*Row("", 0, 0, True, 1.0).__dict__.values()])
        raise KeyError
    assert not path.exists()


def test_memory_holds_a_batch_not_all_rows(tmp_path, monkeypatch):
    monkeypatch.setattr(stored, "BATCH", 500)

    def most(count):
        tracemalloc.start()
        with written_rows(tmp_path / "trials.parquet", COLUMNS, {}) as file:
            for i in range(count):
                file.add([f"row {i}", i, i, True, i / 3])
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return peak

    most(500)  # what is imported late
    assert most(20_000) < 1.5 * most(1000)


def test_a_run_does_without_pandas(tmp_path):
    """Its import would take longer than all else in a short run."""
    run = f"['gapath', 'planner=astar', 'recorder=none', 'output={tmp_path}', 'trials=3']"
    main = "from gapath.commands.run import main; main(); print(*sys.modules)"
    code = f"import sys; sys.argv = {run}; {main}"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"pandas", "pyarrow.compute"} & {*done.stdout.split()}
    assert list(tmp_path.glob("plan/*/trials.parquet"))


def test_a_file_speaks_of_its_columns_once(parquet):
    rows = [Row("a", 2**64 - 1, 0, True, 1.0)] * 100
    data = parquet(rows, {"planner.population": 40, "map.start": "[0, 1]"}).read_bytes()
    about = pq.ParquetFile(io.BytesIO(data)).metadata
    columns = [about.row_group(0).column(i) for i in range(about.num_columns)]
    assert not any(column.is_stats_set for column in columns)
    assert about.metadata is None  # no second schema
    kinds = [str(kind) for kind in pq.read_table(io.BytesIO(data)).to_pandas().dtypes]
    assert kinds == ["str", "uint64", "int64", "bool", "float64", "int64", "str"]
