"""Runs of strangers: too much, too long and impossible numbers are left out by name."""

import shutil
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from gapath.errors import InputError
from gapath.pipelines.reading.bounded import plain
from gapath.store.records import TRIALS, Manifest, find_runs

from ..conftest import collect, sign


@pytest.fixture(scope="module")
def whole(tmp_path_factory, make_run):
    return make_run(tmp_path_factory.mktemp("runs"), "table1", "kg18_test1", "ga1", n=5, log=False)


@pytest.fixture
def run(whole, tmp_path):
    return shutil.copytree(whole, tmp_path / "table1" / whole.name)


def altered(run, name, value, row=0):
    rows = pd.read_parquet(run / TRIALS)
    if isinstance(value, str):
        rows[name] = rows[name].astype(object)
    elif isinstance(value, float):
        rows[name] = rows[name].astype(float)
    rows.loc[row, name] = value
    rows.to_parquet(run / TRIALS)
    sign(run)
    return collect(run.parent.parent)


def test_what_is_altered_here_is_a_success(whole):
    assert pd.read_parquet(whole / TRIALS)["feasible"].all()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("cost", np.nan), ("cost", np.inf), ("cost", -np.inf), ("cost", -1.0),
        ("optimal_cost", -1.0), ("plan_time_s", np.nan), ("plan_time_s", np.inf),
        ("plan_time_s", -1e-9), ("evaluations", -1), ("epochs", -5),
    ],
)  # fmt: skip
def test_numbers_that_no_trial_has_go_into_no_mean(run, name, value):
    found = altered(run, name, value)
    assert found.trials["plan"].empty
    ((_, reason),) = found.skipped
    assert reason.startswith(f"trials.parquet, {name}: got {value}, expected a finite number,")


def test_a_failure_may_have_an_endless_cost(run):
    rows = pd.read_parquet(run / TRIALS)
    rows.loc[0, ["feasible", "status", "cost"]] = False, "not_found", np.inf
    rows.to_parquet(run / TRIALS)
    sign(run)
    assert len(collect(run.parent.parent).trials["plan"]) == 5


def test_text_is_seen_and_too_long_a_one_left_out(run):
    found = altered(run, "start", "\x1b[2J<b>\u202e")
    assert r"\x1b[2J<b>\u202e" in set(found.trials["plan"]["start"])
    found = altered(run, "start", "x" * 5000)
    assert found.trials["plan"].empty
    assert found.skipped[0].reason.startswith("trials.parquet, start: got text of 5000 characters")


def test_rows_that_unpack_to_too_much_are_not_read(run):
    rows = pd.read_parquet(run / TRIALS)
    rows["start"] = [str(i) + "x" * (1 << 22) for i in range(5)]
    rows.to_parquet(run / TRIALS, compression="zstd")
    assert (run / TRIALS).stat().st_size < 1 << 17
    sign(run)
    ((_, reason),) = collect(run.parent.parent).skipped
    assert "bytes when unpacked, expected at most" in reason


@pytest.mark.parametrize("rows", [4, 6])
def test_other_rows_than_the_manifest_tells_of_are_not_read(run, rows):
    frame = pd.read_parquet(run / TRIALS)
    pd.concat([frame, frame]).head(rows).to_parquet(run / TRIALS)
    sign(run)
    ((_, reason),) = collect(run.parent.parent).skipped
    assert f"{rows} rows, expected 5, as the manifest says" in reason


def test_texts_of_a_manifest_are_seen_and_its_command_does_one_thing(run):
    sign(run, map="a\nb\x1b[31m", method="m\u202e", changes={"x\x07": "\x9b1m"},
         command="gapath planner=ga1; rm -rf ~ $(id)\n'a b'")  # fmt: skip
    (found,) = find_runs(run.parent.parent)
    known = plain(found).known
    assert (known.map, known.method, known.changes) == (
        r"a\x0ab\x1b[31m",
        r"m\u202e",
        {r"x\x07": r"\x9b1m"},
    )
    assert known.command == "gapath 'planner=ga1;' rm -rf '~' '$(id)' 'a b'"
    assert plain(replace(found, manifest=known)).known == known


def test_what_gapath_writes_stays_as_it_is(whole):
    sign(whole, command="gapath 'map.start=[0,1]' map=kg18_test1")
    (found,) = find_runs(whole.parent.parent)
    assert plain(found) is found


@pytest.mark.parametrize(
    "change",
    [{"map": "x" * 5000}, {"changes": {"a": "x" * 5000}}, {"command": "gapath " + "x" * 10**5}],
)
def test_too_long_a_text_of_a_manifest_leaves_its_run_out(run, change):
    Manifest.read(run)
    sign(run, **change)
    (found,) = find_runs(run.parent.parent)
    with pytest.raises(InputError, match=r"manifest\.json, \w+: got \d+ characters, expected"):
        plain(found)
    assert collect(run.parent.parent).trials["plan"].empty
