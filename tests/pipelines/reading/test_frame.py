"""Runs as a table: types, what is missing, runs of earlier versions, conditions."""

import json
import math
import shutil
from dataclasses import replace

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.errors import InputError
from gapath.pipelines.reading.frame import checked, chosen, run_frame, setting_columns
from gapath.pipelines.reading.query import quoted
from gapath.store.records import find_runs
from gapath.store.results import Results

from ..conftest import record_of, sign, summed, write_status


def with_settings(key, **settings):
    """A run that says what it was set to and that one of two trials succeeded."""
    run = record_of("ga1", key)
    came = Results(
        2, 1, {"length": 3.0, "epochs": 5.0, "clearance": 0.0}, {"length": 1, "clearance": 0}
    )
    known = replace(run.known, settings=settings, results=came, trials=2)
    return replace(run, manifest=known)


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ([1, 2], "Int64"),
        ([1, None], "Int64"),
        ([1, 0.5], "float64"),
        ([0.5, None], "float64"),
        ([True, None], "boolean"),
        (["a", None], "str"),
        (["a", 1, True], "str"),
        ([True, 1], "str"),
        ([2**63, 1], "float64"),
        ([None, None], "object"),
    ],
)
def test_a_setting_keeps_its_type_also_where_a_run_lacks_it(values, kind):
    runs = [with_settings(f"{i}", **{"planner.x": value}) for i, value in enumerate(values)]
    column = run_frame([*runs, with_settings("last")])["planner.x"]
    assert column.dtype == kind
    assert column.isna().tolist() == [value is None for value in [*values, None]]
    if kind == "str":
        text = [value if isinstance(value, str | None) else json.dumps(value) for value in values]
        assert [None if pd.isna(each) else each for each in column] == [*text, None]
    else:
        assert [each for each in column if pd.notna(each)] == [v for v in values if v is not None]


def test_results_are_means_over_the_trials_where_they_are_defined():
    row = run_frame([with_settings("a")]).loc["a"]
    assert (row["success"], row["length"], row["epochs"]) == (0.5, 3.0, 2.5)


def test_what_is_defined_in_no_trial_is_null_and_still_a_number():
    other = with_settings("b")
    came = replace(other.known.results, sums={"clearance": 4.0}, counts={})
    other = replace(other, manifest=replace(other.known, results=came))
    frame = run_frame([with_settings("a"), other])
    assert frame["clearance"].dtype == "float64"
    assert frame["clearance"].isna().tolist() == [True, False]


@pytest.mark.parametrize(("name", "total", "good"), [
    ("length", math.nan, False), ("length", math.inf, False), ("length", -math.inf, False),
    ("cost", math.nan, False), ("cost", math.inf, True), ("cost", -1.0, False),
    ("plan_time_s", -1.0, False), ("plan_time_s", math.inf, False), ("epochs", -1.0, False),
    ("mine", -1.0, True), ("mine", math.nan, False),
])  # fmt: skip
def test_sums_that_no_trials_come_to_are_a_runs_fault(name, total, good):
    run = with_settings("a")
    came = replace(run.known.results, sums={name: total}, counts={})
    run = replace(run, manifest=replace(run.known, results=came))
    fault = checked(run).fault
    assert (fault == "") if good else f"manifest.json, results, {name}: got {total}" in fault


def test_seeds_up_to_the_last_come_back():
    frame = run_frame([record_of_seed(2**64 - 1), record_of_seed(0)])
    assert frame["seed"].tolist() == [2**64 - 1, 0]
    assert len(chosen(frame, "seed = 18446744073709551615")) == 1


def record_of_seed(seed):
    run = with_settings(f"{seed}")
    return replace(run, manifest=replace(run.known, seed=seed, setting=f"{seed}"))


def test_lists_are_json_and_settings_are_told_from_the_rest():
    run = with_settings("a", **{"map.start[0]": 0, "map.start[1]": 24, "planner.x": 1, "seed": 3})
    frame = run_frame([run])
    assert frame.loc["a", "map.start"] == "[0, 24]"
    assert setting_columns(frame) == ["map.start", "planner.x"]
    assert (
        len(chosen(frame, "map.start = [0, 24]"))
        == len(chosen(frame, "map.start is not null"))
        == 1
    )


def test_runs_of_earlier_versions_make_the_same_table(tmp_path, make_run):
    for planner in ("ga1", "astar"):
        for name in ("kg18_test3", "kg18_test4"):
            make_run(tmp_path, "table1", name, planner, n=7, log=False)
    slow = run_frame(find_runs(tmp_path))
    folders = [run.folder for run in find_runs(tmp_path)]
    for folder in folders[1:]:  # mixed
        summed(folder)
    pd.testing.assert_frame_equal(run_frame(find_runs(tmp_path)), slow)
    for folder in folders:
        summed(folder)
        (folder / "trials.parquet").write_bytes(b"x" * (folder / "trials.parquet").stat().st_size)
    pd.testing.assert_frame_equal(run_frame(find_runs(tmp_path)), slow)  # nothing else was read


def test_what_cannot_be_read_is_the_fault_of_its_run_alone(tmp_path, make_run):
    keys = ("config", "failed", "fine", "made", "rows")
    runs = {key: make_run(tmp_path, "e", "kg18_test1", "ga1", n=3, log=False, key=key, seed=i)
            for i, key in enumerate(keys)}  # fmt: skip
    write_status(runs["failed"], "failed", text="OSError: disk full")
    (runs["failed"] / "manifest.json").unlink()
    (runs["rows"] / "trials.parquet").write_bytes(b"none")
    (runs["config"] / "config.yaml").write_text("[")
    for key in ("rows", "config"):
        sign(runs[key])
    (tmp_path / "e" / "notes").mkdir()
    (tmp_path / "e" / "notes" / "plan.txt").write_text("no run")
    (tmp_path / "loose.txt").write_text("no folder")
    frame = run_frame(find_runs(tmp_path))
    assert list(frame.index) == list(keys)
    faults = frame["fault"].dropna()
    assert list(faults.index) == ["config", "failed", "rows"]
    assert "config.yaml" in faults["config"] and "readable Parquet" in faults["rows"]
    assert faults["failed"] == "failed: OSError: disk full"
    assert frame["success"].notna().tolist() == [False, False, True, True, False]
    assert frame.loc["failed", "planner.population"] == frame.loc["fine", "planner.population"]
    assert pd.isna(frame.loc["failed", "map"]) and frame.loc["failed", "experiment"] == "e"


def test_the_run_that_counts_in_place_of_another_is_named(tmp_path, make_run):
    for key, date in [("old", "2026-01-01"), ("new", "2026-01-02")]:
        make_run(tmp_path, "e", "kg18_test1", "ga1", n=3, log=False, key=key, date=date)
    frame = run_frame(find_runs(tmp_path))
    assert frame["superseded"].dropna().to_dict() == {"old": "new"}


def test_a_copy_of_a_run_does_not_count_in_its_place(tmp_path, make_run):
    folder = make_run(tmp_path, "e", "kg18_test1", "ga1", n=3, log=False, key="abcdef")
    shutil.copytree(folder, folder.parent / "copy_of_it")
    frame = run_frame(find_runs(tmp_path))
    assert frame["superseded"].dropna().to_dict() == {"copy_of_it": "abcdef"}


@pytest.fixture(scope="module")
def frame():
    runs = [
        with_settings(
            f"{i:06}",
            **{
                "planner.population": 20 * i,
                "planner.stop": i % 2 == 0,
                "planner.name": f"it's {i}",
                "planner.rate": i / 4 if i > 2 else None,
            },
        )
        for i in range(6)
    ]
    return run_frame([replace(r, manifest=replace(r.known, setting=r.folder.name)) for r in runs])


@pytest.mark.parametrize(
    ("where", "right"),
    [
        ("planner.population >= 80", [4, 5]),
        ("Planner.Population >= 80", [4, 5]),
        ('"planner.population" >= 80', [4, 5]),
        ("planner.population>=80 and not planner.stop", [5]),
        ("planner.population in (20, 60) or key = '000000'", [0, 1, 3]),
        ("planner.rate is null", [0, 1, 2]),
        ("planner.rate < 1 -- planner.nothing", [3]),
        ("planner.name = 'it''s 2' /* planner.nothing */", [2]),
        ("planner.name like '%planner.population%'", []),
        ("planner.name = 'é' or planner.population = 40", [2]),
        ("success = 0.5 and map = 'kg18_test1' and state = 'done' and date < '2027'", [*range(6)]),
        ("clearance is null and fault is null and superseded is null", [*range(6)]),
        ("planner.population = (select max(20))", [1]),
    ],
)
def test_conditions(frame, where, right):
    assert chosen(frame, where).index.tolist() == [f"{i:06}" for i in right]


@pytest.mark.parametrize(
    ("where", "said"),
    [
        (
            "planner.populaton > 1",
            "of planner.populaton; did you mean planner.population?",
        ),
        ("population > 1", "in place of population; did you mean planner.population?"),
        ("succes > 0.5", "in place of succes; did you mean success?"),
        ("nothing > 1", "a column in place of nothing"),
        ("other.thing > 1", "a column in place of other.thing"),
        ("map = kg18_test1", "of kg18_test1; text stands in single quotes: 'kg18_test1'"),
        ("planer.population > 1", "of planer.population; did you mean planner.population?"),
        ('map = "kg18_test1"', "text stands in single quotes: 'kg18_test1'"),
        ("map = ", "SQL that can be answered (Parser Error"),
        ("", "got ''"),
        ("'open", "SQL that can be answered"),
        ("1 = 1; drop table x", "more than one statement"),
        ("success > 0 union select 1", "SQL that can be answered"),
        ("success > 0) or (1 = 1", "Parser Error"),
        ("success > 0, map = 'a'", "single expression"),
        ("map > 1", "SQL that can be answered"),
        ("map", "Could not convert string"),
        ("sum(success) > 1", "SQL that can be answered"),
        ("(select count(*) from read_csv('/etc/passwd')) > 0", "Permission Error"),
        ("(select count(*) from '/etc/passwd') > 0", "SQL that can be answered"),
        ("(select count(*) from frame) > 0", "SQL that can be answered (Catalog Error: Table"),
        ("exists (select 1 from duckdb_settings() where name = 'x' and value = map.x)", "map.x"),
    ],
)
def test_conditions_that_are_none(frame, where, said):
    with pytest.raises(InputError) as error:
        chosen(frame, where)
    assert str(error.value).startswith("where: got ") and said in str(error.value)
    assert "\n" not in str(error.value)


texts = st.text(alphabet="ab.'\"-é \n", max_size=12)


@given(texts, texts)
def test_what_stands_in_quotes_is_left_alone(text, name):
    text = "'" + text.replace("'", "''") + "'"
    name = '"' + name.replace('"', '""') + '"'
    columns = ("a.b", "b.a")
    assert quoted(f"{text} = {name}", columns, "") == f"{text} = {name}"
    assert quoted(f"{text}=a.b or x.b.a>{name}", columns, "") == f'{text}="a.b" or x."b.a">{name}'
