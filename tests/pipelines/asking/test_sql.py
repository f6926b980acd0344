"""Questions in SQL get the answers that pandas gives."""

import shutil

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest

from gapath.store.rows import written

from ..conftest import summed
from .conftest import rows_of


def test_a_question_in_sql_is_answered_as_pandas_does(ask, outputs):
    text = (
        "select r.map, r.planner.population as size, count(*) as n, avg(t.length) as length, "
        "sum(t.evaluations) / sum(t.feasible::int) as spent from runs r join trials t using (key) "
        "where r.planner.population is not null group by all order by all"
    )
    frames = [
        pd.read_parquet(path).assign(key=path.parent.name) for path in outputs.rglob("*.parquet")
    ]
    together = pd.concat(frames)
    together = together[together["planner"] == "ga1"]
    rows = rows_of(ask, "--sql", text)
    groups = list(together.groupby(["map", "planner.population"]))
    assert len(rows) == len(groups) == 9
    for row, ((name, size), group) in zip(rows, groups, strict=True):
        assert (row["map"], row["size"], row["n"]) == (name, size, len(group))
        mean, found = group["length"].mean(), group["feasible"].sum()
        assert row["length"] == pytest.approx(mean, rel=1e-12)
        assert (row["spent"] is None) == (found == 0)


def test_trials_know_the_method_and_the_code_of_their_run(ask):
    by = "select {0}.key, {0}.method, {0}.preset, {0}.code, count(*) as n from {1} group by all"
    text = f"{by} order by key"
    trials = rows_of(ask, "--sql", text.format("trials", "trials"))
    assert trials == rows_of(ask, "--sql", text.format("runs", "runs join trials using (key)"))
    assert {row["preset"] for row in trials} == {"ga1", "astar"}


def test_columns_that_some_runs_lack_are_null_and_types_are_kept(tmp_path, make_run, ask):
    lacks = make_run(tmp_path, "e", "kg18_test1", "ga1", n=4, log=False, key="lacks")
    pd.read_parquet(lacks / "trials.parquet").drop(columns="turns").to_parquet(
        lacks / "trials.parquet"
    )
    summed(lacks)
    fails = make_run(tmp_path, "e", "kg18_test4", "ga2", n=3, log=False, key="fails", seed=1)
    rows = pd.read_parquet(fails / "trials.parquet")
    rows = rows.assign(length=np.nan, **{"planner.x": 2})
    table = pa.table({name: column.to_numpy() for name, column in rows.items()})  # NaN, not null
    (fails / "trials.parquet").write_bytes(written(table))
    summed(fails)
    made = rows_of(
        ask,
        "--sql",
        "select key, count(*) as n, count(turns) as turns, count(length) as length, "
        "avg(length) as mean, any_value(planner.x) as x, any_value(typeof(planner.x)) as kind, "
        "any_value(typeof(length)) as real, any_value(typeof(seed)) as seed "
        "from trials group by key order by key",
        folder=tmp_path,
    )
    kinds = {"kind": "BIGINT", "real": "DOUBLE"}
    assert [{name: row[name] for name in kinds} for row in made] == [kinds] * 2
    del made[0]["seed"], made[1]["seed"]
    assert made == [
        {"key": "fails", "n": 3, "turns": 3, "length": 0, "mean": None, "x": 2, **kinds},
        {"key": "lacks", "n": 4, "turns": 0, "length": 4, "mean": 25.0, "x": None, **kinds},
    ]


def test_decimals_are_numbers_as_others_are(ask):
    text = "select 1.5 as a, sum(2::decimal(9, 3)) as b, [0.25] as c, {'d': 0.5} as e"
    assert rows_of(ask, "--sql", text) == [{"a": 1.5, "b": 2.0, "c": [0.25], "e": {"d": 0.5}}]
    assert ask("--sql", "select 1.50 as a, 2.000 as b", "--csv")[1] == "a,b\n1.5,2.0\n"
    assert ask("--sql", "select 2.000 as b")[1].split()[-1] == "2"


def test_trials_that_cannot_be_read_are_left_out_by_name(tmp_path, outputs, ask):
    shutil.copytree(outputs, tmp_path / "o")
    bad = [
        tmp_path / "o" / "sizes" / key / "trials.parquet" for key in ("0abcdef020", "5abcdef100")
    ]
    for path in bad:
        path.write_bytes(b"x" * path.stat().st_size)
    text = "select count(distinct r.key) as runs, count(*) as n from runs r join trials using (key)"
    code, out, said = ask("--sql", text, "--csv", folder=tmp_path / "o")
    assert (code, out) == (0, f"runs,n\n8,{sum(range(9, 18)) + 5 - 9 - 14}\n")
    assert sorted(said.splitlines()) == [
        f"left out sizes/{path.parent.name}: its trials cannot be read" for path in bad
    ]
