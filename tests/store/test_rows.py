"""Rows as Parquet: every type comes back as it was."""

import io
import math
import subprocess
import sys
from dataclasses import dataclass, fields

import pyarrow.parquet as pq
from hypothesis import given
from hypothesis import strategies as st

from gapath.store.rows import parquet


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


@given(st.lists(rows, min_size=1, max_size=30))
def test_rows_come_back(drawn):
    table = pq.read_table(io.BytesIO(parquet(COLUMNS, [row.__dict__ for row in drawn])))
    assert table.to_pylist() == [row.__dict__ for row in drawn]
    names = [str(field.type) for field in table.schema]
    assert names == ["string", "uint64", "int64", "bool", "double"]


def test_what_all_rows_share_stands_in_columns_of_its_type():
    shared = {"map.start": "[0, 1]", "population": 40, "rate": 0.5, "stop": True, "limit": None}
    rows = [Row("", 0, 0, True, 1.0).__dict__] * 3
    table = pq.read_table(io.BytesIO(parquet(COLUMNS, rows, shared)))
    assert table.select(list(shared)).to_pylist() == [shared] * 3
    names = [str(table.schema.field(name).type) for name in shared]
    assert names == ["string", "int64", "double", "bool", "null"]


def test_nan_comes_back():
    table = pq.read_table(io.BytesIO(parquet(COLUMNS, [Row("", 0, 0, True, math.nan).__dict__])))
    assert math.isnan(table.column("value")[0].as_py())


def test_a_run_does_without_pandas(tmp_path):
    """Its import would take longer than all else in a short run."""
    run = f"['gapath', 'planner=astar', 'recorder=none', 'output={tmp_path}']"
    main = "from gapath.commands.run import main; main(); print(*sys.modules)"
    code = f"import sys; sys.argv = {run}; {main}"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "pandas" not in done.stdout.split()
    assert list(tmp_path.glob("plan/*/trials.parquet"))


def test_a_file_speaks_of_its_columns_once():
    rows = [Row("a", 2**64 - 1, 0, True, 1.0).__dict__] * 100
    data = parquet(COLUMNS, rows, {"planner.population": 40, "map.start": "[0, 1]"})
    about = pq.ParquetFile(io.BytesIO(data)).metadata
    columns = [about.row_group(0).column(i) for i in range(about.num_columns)]
    assert not any(column.is_stats_set for column in columns)
    assert about.metadata is None  # no second schema
    kinds = [str(kind) for kind in pq.read_table(io.BytesIO(data)).to_pandas().dtypes]
    assert kinds == ["str", "uint64", "int64", "bool", "float64", "int64", "str"]
