"""Trials cut into shards: the rows of all, one in every table, and logs that can be checked."""

import json

import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.commands import log as log_command
from gapath.commands import run as cli
from gapath.errors import InputError
from gapath.pipelines.reading.collect import read_trials
from gapath.pipelines.reading.counted import incomplete
from gapath.pipelines.report import cli as report_command
from gapath.running.shards import span
from gapath.store.records import find_runs
from gapath.task import columns, find_task

GENETIC = ("map=kg18_test1", "planner=ga1", "planner.population=8")
DRIVE = ("task=drive", "map=kg18_test1", "navigator=kg18")


@given(st.integers(1, 10**6), st.integers(1, 10**6))
def test_shards_have_each_trial_once(trials, shards):
    if shards > trials:
        with pytest.raises(InputError):
            span(trials, 0, shards, posing=False)
        return
    chosen = {0, shards // 2, max(shards // 2 - 1, 0), shards - 1}
    parts = {i: span(trials, i, shards, posing=False) for i in chosen}
    assert (parts[0].start, parts[shards - 1].stop) == (0, trials)
    assert all(len(part) >= 1 for part in parts.values())
    before = max(shards // 2 - 1, 0)
    assert parts[before].stop == parts[shards // 2].start or shards == 1


def rows(runs, task):
    """Rows of runs, in the order of their trials, but for times."""
    kept = [name for name in columns(find_task(task).row) if not name.endswith("_s")]
    tables = [pq.read_table(run.folder / "trials.parquet") for run in runs]
    given = [row for table in tables for row in table.select(kept).to_pylist()]
    return [str(row) for row in sorted(given, key=lambda row: row["trial"])]


@pytest.mark.parametrize(("setting", "task"), [(GENETIC, "plan"), (DRIVE, "drive")])
def test_shards_come_to_the_rows_of_the_whole_and_count_once(gapath, tmp_path, setting, task):
    out = tmp_path / "out"
    assert gapath(*setting, "trials=7", "recorder=none", output=tmp_path / "whole")[0] == 0
    code, _, _ = gapath("-m", *setting, "trials=7", "recorder=mcap", "shards=3", "shard=0,2")
    assert code == 0
    runs = find_runs(out)
    assert sorted(run.known.trials for run in runs) == [2, 3]
    assert len({run.known.setting for run in runs}) == 1
    (whole,) = find_runs(tmp_path / "whole")
    assert whole.known.setting == runs[0].known.setting
    assert "shard" not in whole.known.settings
    collected = read_trials(runs)
    (told,) = incomplete(collected.runs)
    assert told[1] == "counts, but only 2 of 3 shards of its trials are there; missing: 1"
    assert gapath("-m", *setting, "trials=7", "recorder=mcap", "shards=3", "shard=range(3)")[0] == 0
    runs = find_runs(out)
    assert len(runs) == 3
    assert rows(runs, task) == rows([whole], task)
    collected = read_trials(runs)
    assert (len(collected.trials[task]), collected.skipped, incomplete(runs)) == (7, [], [])
    log = next(run for run in runs if run.settings["shard"] == 2).folder / "run.mcap"
    assert log_command.main(["verify", str(log)]) == 0


def test_groups_pool_the_trials_of_shards(gapath, tmp_path, capfd):
    sweep = ("-m", "map=kg18_test3", "planner=ga1,ga2", "trials=40", "recorder=none")
    assert gapath(*sweep, output=tmp_path / "whole")[0] == 0
    assert gapath(*sweep, "shards=4", "shard=range(4)", output=tmp_path / "cut")[0] == 0
    capfd.readouterr()
    names, told = ("success", "success_low", "success_high", "expected_evaluations"), []
    for name, runs in (("whole", 1), ("cut", 4)):
        asked = ["runs", str(tmp_path / name), "--group", "preset", "--json"]
        assert report_command.main(asked) == 0
        rows = json.loads(capfd.readouterr().out)
        assert [(row.pop("runs"), row["trials"]) for row in rows] == [(runs, 40)] * 2
        told.append([[row[name] for name in names] for row in rows])
    assert told[0] == told[1] and 0 < told[0][0][0] < 1


def test_of_shards_and_a_whole_run_one_counts(gapath, tmp_path):
    for words in (["shards=2", "shard=0"], ["shards=2", "shard=1"], [], ["shards=3", "shard=0"]):
        assert gapath(*GENETIC, "trials=6", "recorder=none", *words)[0] == 0
    assert len(read_trials(find_runs(tmp_path / "out")).trials["plan"]) == 6


def test_a_shard_that_was_cut_short_goes_on(gapath, tmp_path, failing_after):
    words = [*GENETIC, "trials=9", "shards=3", "shard=1", "recorder=mcap"]
    with failing_after(2):
        assert gapath(*words)[0] == 1
    code, _, errors = gapath(*words)
    assert (code, "goes on after trial 4, 2 of 3 are done" in errors) == (0, True)
    (run,) = find_runs(tmp_path / "out")
    assert gapath(*GENETIC, "trials=9", "recorder=none", output=tmp_path / "whole")[0] == 0
    assert rows([run], "plan") == rows(find_runs(tmp_path / "whole"), "plan")[3:6]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["trials=4", "shards=3", "shard=3"], "shard: got 3, expected an integer from 0 to 2, of"),
        (["trials=4", "shards=3", "shard=-1"], "shard: got -1, expected an integer from 0 to 2"),
        (["trials=4", "shards=5"], "shards: got 5, expected an integer from 1 to the trials, 4"),
        (["trials=4", "shards=0"], "shards: got 0, expected an integer from 1 to the trials, 4"),
        (["trials=4", "shard=1"], "shard: got 1, expected an integer from 0 to 0, of 1"),
        (["task=scenario", "trials=4", "shards=2"], "shards: got 2, expected 1: this task's prob"),
    ],
)
def test_a_shard_out_of_range_is_one_line(gapath, tmp_path, words, said):
    code, text, errors = gapath("map=kg18_test1", "recorder=none", *words)
    assert (code, text, errors.count("\n")) == (cli.BAD_INPUT, "", 1)
    assert said in errors
    assert not (tmp_path / "out").exists()
