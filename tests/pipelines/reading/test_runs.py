import fcntl
import json
import shutil

import pytest

from gapath.errors import InputError
from gapath.pipelines.reading.logs import events_of, read_logs, run_start
from gapath.store.records import find_runs
from gapath.store.status import RunState

from ..conftest import collect, sign, write_status


def plans(folder):
    trials, skipped, _ = collect(folder)
    return trials["plan"], skipped


@pytest.fixture
def run(tmp_path, make_run):
    return make_run(tmp_path, "table1", "kg18_test1", "ga1", n=5, log=False)


def only(folder):
    (found,) = find_runs(folder.parent.parent)
    return found


def test_a_whole_run(run):
    found = only(run)
    assert (found.state, found.fault, found.known.method) == ("done", "", "ga1")


@pytest.mark.parametrize("state", ["failed", "interrupted"])
def test_unfinished_runs_are_not_used_and_say_why(run, state):
    write_status(run, state, text="Traceback:\n  ...\nOSError: disk full")
    found = only(run)
    assert (found.state, found.fault) == (state, f"{state}: OSError: disk full")
    frame, skipped = plans(run.parent.parent)
    assert frame.empty
    assert skipped == [(f"table1/{run.name}", found.fault)]


@pytest.mark.parametrize("lock_file", [True, False])
def test_running_without_a_held_lock_is_interrupted(run, lock_file):
    write_status(run, "running")
    if lock_file:
        (run / "run.lock").touch()
    assert only(run).state == "interrupted"


def test_running_with_a_held_lock_is_running(run):
    write_status(run, "running")
    with (run / "run.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert only(run).state == "running"
    assert only(run).state == "interrupted"


@pytest.mark.parametrize("said", ["finished", "", None, 1, ["done"]])
def test_a_state_that_is_none_is_unknown_and_so_not_used(run, said):
    (run / "status.json").write_text(json.dumps({"state": said, "started": "", "message": ""}))
    assert (only(run).state, only(run).fault) == (RunState.UNKNOWN, "unknown")


def test_no_status_is_unknown(run):
    (run / "status.json").unlink()
    assert only(run).state == "unknown"
    assert "status.json" in only(run).fault


def change(run, **changes):
    manifest = json.loads((run / "manifest.json").read_text())
    (run / "manifest.json").write_text(json.dumps(manifest | changes))


@pytest.mark.parametrize(
    ("spoil", "named"),
    [
        (lambda run: (run / "manifest.json").unlink(), "manifest.json: got no file"),
        (lambda run: (run / "manifest.json").write_text("{"), "manifest.json"),
        (lambda run: (run / "manifest.json").write_text("[1]"), "a JSON object"),
        (lambda run: (run / "manifest.json").write_bytes(b"\xff\x00"), "manifest.json"),
        (lambda run: (run / "manifest.json").write_text("[" * 100_000), "manifest.json"),
        (lambda run: change(run, trials="5"), "manifest.json, trials"),
        (lambda run: change(run, files={}), "trials.parquet"),
        (lambda run: change(run, files={"trials.parquet": 5}), "trials.parquet"),
        (lambda run: change(run, files={"../x": {}}), "../x"),
        (lambda run: change(run, files={"trials.parquet": {}}), "trials.parquet, sha256: got None"),
        (lambda run: change(run, files={"a": {"sha256": "", "bytes": True}}), "a, bytes: got True"),
        (lambda run: change(run, preset=None), "preset: got None, expected str"),
        (lambda run: change(run, changes=[]), "changes: got [], expected a mapping"),
        (lambda run: change(run, changes={"x": [1]}), "changes, x: got [1], expected str, int, "),
        (lambda run: change(run, versions={"gapath": 2}), "versions, gapath: got 2, expected str"),
        (lambda run: change(run, map_inputs={"m.png": {}}), "map_inputs, m.png: got {}, expected"),
        (lambda run: change(run, method_inputs={"a": 1}), "method_inputs, a: got 1, expected str"),
        (lambda run: change(run, settings=[1]), "settings: got [1], expected a mapping"),
        (lambda run: change(run, settings={"x": [1]}), "settings, x: got [1], expected str, int,"),
        (lambda run: change(run, results={}), "results, trials: got None, expected int"),
        (lambda run: change(run, results=1), "results: got 1, expected a mapping"),
        (lambda run: change(run, seed=True), "seed: got True, expected int"),
        (lambda run: change(run, seed=-1), "seed: got -1, expected an integer in [0, 2^64)"),
        (lambda run: change(run, trials=-1), "trials: got -1, expected an integer from 1 to 10^6"),
        (lambda run: (run / "trials.parquet").unlink(), "trials.parquet: got no file"),
        (lambda run: (run / "config.yaml").unlink(), "config.yaml: got no file"),
        (lambda run: (run / "config.yaml").write_text("longer than before"), "config.yaml"),
    ],
)
def test_what_is_broken_is_named(run, spoil, named):
    spoil(run)
    assert named in only(run).fault


def test_no_folder_and_no_runs(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        find_runs(tmp_path / "missing")
    (tmp_path / "report" / "pictures").mkdir(parents=True)
    with pytest.raises(InputError, match="no runs"):
        find_runs(tmp_path)


def test_all_trials_are_collected_failures_too(outputs):
    frame, skipped = plans(outputs)
    assert skipped == []
    assert len(frame) == 4 * 5 * (20 + 3 * 4)
    assert frame["key"].nunique() == 4 * 5 * 4
    failed = frame[(frame["map"] == "kg18_test4") & frame["planner"].str.startswith("ga")]
    assert len(failed) == 3 * (20 + 3 * 4)
    assert not failed["feasible"].any()
    assert failed["optimality_ratio"].isna().all()


@pytest.mark.parametrize(("code", "kept", "other"), [("of today", 7, "a"), ("before", 3, "b")])
def test_of_a_setting_the_most_trials_of_the_newest_code_count_alone(
    code, kept, other, tmp_path, make_run
):
    for key, date, n in [("b", "2026-01-02T00:00", 7), ("a", "2026-01-03T00:00", 3)]:
        run = make_run(tmp_path, "table1", "kg18_test1", "ga1", n=n, log=False, date=date, key=key)
        change(run, versions={"code": code if key == "b" else "of today"})
    make_run(tmp_path, "table1", "kg18_test1", "ga1", n=4, seed=1, log=False)
    frame, skipped = plans(tmp_path)
    assert sorted(frame.groupby("seed").size()) == sorted([kept, 4])
    assert [run for run, _ in skipped] == [f"table1/{other}"]
    assert f"table1/{'b' if other == 'a' else 'a'} counts" in skipped[0].reason


def test_a_broken_newer_run_does_not_hide_a_whole_older_one(tmp_path, make_run):
    make_run(tmp_path, "table1", "kg18_test1", "ga1", log=False, key="old")
    new = make_run(
        tmp_path, "table1", "kg18_test1", "ga1", log=False, key="new", date="2026-02-01T00:00"
    )
    (new / "config.yaml").unlink()
    frame, skipped = plans(tmp_path)
    assert set(frame["key"]) == {"old"}
    assert [run for run, _ in skipped] == ["table1/new"]


def flip(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def test_flipped_rows_are_noticed(run):
    flip(run / "trials.parquet")
    skipped = collect(run.parent.parent).skipped
    assert "SHA-256" in skipped[0].reason


@pytest.mark.parametrize(
    ("spoil", "named"),
    [
        (lambda trials: trials.drop(columns="epochs"), "no column epochs"),
        (lambda trials: trials.assign(cost="much"), "cost"),
        (lambda trials: trials.assign(cost=None), "cost"),
        (lambda trials: trials.assign(feasible=1.5), "feasible"),
        (lambda trials: trials.assign(feasible=None), "feasible"),
        (lambda trials: trials.assign(epochs=1.5), "epochs"),
        (lambda trials: trials.assign(seed=-1), "seed"),
        (lambda trials: trials.assign(status=1), "status"),
        (lambda trials: trials.assign(stage_times_s="{"), "stage_times_s"),
        (lambda trials: trials.assign(stage_times_s="[1]"), "stage_times_s"),
    ],
)
def test_rows_of_another_shape_are_named(run, spoil, named):
    import pandas as pd

    spoil(pd.read_parquet(run / "trials.parquet")).to_parquet(run / "trials.parquet")
    sign(run)
    frame, skipped = plans(run.parent.parent)
    assert frame.empty
    assert named in skipped[0].reason


def test_types_that_hold_the_same_are_read_alike(run):
    """Whole numbers as decimals, text as categories: who writes rows may choose."""
    import pandas as pd

    path = run / "trials.parquet"
    rows = pd.read_parquet(path)
    before, _ = plans(run.parent.parent)
    rows.astype({"epochs": float, "map": "category", "cost": "float32"}).to_parquet(path)
    sign(run)
    after, skipped = plans(run.parent.parent)
    assert skipped == []
    pd.testing.assert_frame_equal(before, after)


def test_text_is_held_as_categories_in_the_order_of_the_alphabet(tmp_path, make_run):
    """Not as they are met: groups and rows are sorted by it."""
    make_run(tmp_path, "first", "kg18_test4", "ga1", log=False)  # which nobody solves
    make_run(tmp_path, "second", "kg18_test1", "ga1", log=False)
    frame, _ = plans(tmp_path)
    assert frame["status"].iloc[0] == "not_found"
    assert frame["key"].dtype == "str"
    for name in ("map", "planner", "experiment", "status"):
        categories = list(frame[name].cat.categories)
        assert categories == sorted(set(frame[name]))


def test_of_many_runs_the_damaged_ones_are_named_and_each_task_has_its_trials(
    tmp_path, make_run, make_drive_run
):
    """More than are put together at a time."""
    keys = [f"{i:03}" for i in range(300)]
    for key in keys:
        make_run(tmp_path, "plan", "kg18_test1", "ga1", n=1 + int(key) % 3, log=False, key=key,
                 seed=int(key))  # fmt: skip
    make_drive_run(tmp_path, "drives", "kg18_map1", "kg18", n=4)
    damaged = keys[7::50]
    for key in damaged:
        flip(tmp_path / "plan" / key / "trials.parquet")
    trials, skipped, runs = collect(tmp_path)
    assert [each.run for each in skipped] == [f"plan/{key}" for key in damaged]
    assert all("SHA-256" in each.reason for each in skipped)
    sizes = trials["plan"].groupby("key", observed=True)["seed"].agg(["size", "min", "max"])
    assert list(sizes.index) == [key for key in keys if key not in damaged]
    assert list(sizes["size"]) == [1 + int(key) % 3 for key in sizes.index]
    assert list(sizes["min"]) == list(sizes["max"]) == [int(key) for key in sizes.index]
    assert len(trials["drive"]) == 4
    assert len(runs) == len(sizes) + 1


def test_a_file_that_is_no_parquet_is_named_and_the_others_are_read(run, make_run):
    outputs = run.parent.parent
    make_run(outputs, "table1", "kg18_test2", "ga1", n=3, log=False)
    (run / "trials.parquet").write_bytes(b"no parquet")
    sign(run)
    frame, skipped = plans(outputs)
    assert len(frame) == 3
    assert "readable Parquet" in skipped[0].reason
    shutil.rmtree(run)
    assert collect(outputs).skipped == []


def test_settings_that_cannot_be_read_are_named(run):
    (run / "config.yaml").write_text("[")
    sign(run)
    frame, skipped = plans(run.parent.parent)
    assert frame.empty
    assert "config.yaml" in skipped[0].reason


def test_a_metric_that_was_added_since_is_missing(run):
    import pandas as pd

    rows = pd.read_parquet(run / "trials.parquet").drop(columns="clearance")
    rows.to_parquet(run / "trials.parquet")
    sign(run)
    frame, skipped = plans(run.parent.parent)
    assert skipped == []
    assert len(frame) == 5 and frame["clearance"].isna().all()


def test_logs_are_read_where_there_are_any_and_can_be(run, make_run):
    outputs = run.parent.parent  # its own run has no log
    good = make_run(outputs, "table1", "kg18_test2", "ga1", n=3)
    torn = make_run(outputs, "table1", "kg18_test3", "ga1", n=3)
    (torn / "run.mcap").write_bytes(b"nothing")
    found, skipped = read_logs(find_runs(outputs), lambda run: run_start(events_of(run)).trials)
    assert [(run.folder, trials) for run, trials in found] == [(good, 3)]
    assert [name for name, _ in skipped] == [f"table1/{torn.name}"]
