"""From a run to files on disk, and from the log back to the run."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import pyarrow.parquet as pq
import pytest

from gapath.commands import log as log_cli
from gapath.components import build, normalised
from gapath.discovery import yaml_values
from gapath.errors import InputError
from gapath.events import TrialFinished
from gapath.mapio.reconstructed import Reader, generate
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem
from gapath.recorders.mcap import read_events
from gapath.running import config
from gapath.running.again import events_again, made_again
from gapath.running.experiment import execute
from gapath.running.naming import Method
from gapath.store import keys, records, runfolder, whole
from gapath.store.records import Manifest
from gapath.store.settings import flatten, read_settings
from gapath.tasks.plan import Task as PlanTask


def make_run(folder, planner="ga3", map_class="kg18_test2", trials=3, recorders=("mcap",)):
    grid = Reader(map_class, 0).read()
    settings = normalised("planner", yaml_values("planner", planner), "planner")
    return config.Run(
        "test",
        Method(planner),
        Problem(grid, grid.start, grid.target),
        PlanTask(build("planner", settings, "planner")),
        [build("recorder", yaml_values("recorder", name), name) for name in recorders],
        11,
        trials,
        flatten(
            {
                "task": "plan",
                "name": "test",
                "map": yaml_values("map", map_class),
                "seed": 11,
                "trials": trials,
                "corner_cutting": "allow",
                "planner": settings,
            }
        ),
        str(folder),
        False,
    )


@pytest.mark.parametrize("planner", ["ga1", "ga3", "astar", "dijkstra"])
def test_a_log_says_enough_to_do_the_run_again(planner, tmp_path, capsys):
    execution = execute(make_run(tmp_path, planner), "test")
    log = execution.folder / "run.mcap"
    events = list(read_events(log))
    again = list(events_again(made_again(events[0])))
    assert [type(event) for event in events] == [type(event) for event in again]
    assert log_cli.main(["verify", str(log)]) == 0


def test_rows_and_log_agree(tmp_path):
    run = make_run(tmp_path, "ga1", "kg18_test3", trials=20)
    optimum = shortest_path(run.problem).cost
    execution = execute(run, "test")
    rows = pq.read_table(execution.folder / "trials.parquet").to_pylist()
    finished = [
        e for e in read_events(execution.folder / "run.mcap") if isinstance(e, TrialFinished)
    ]
    assert len(rows) == len(finished) == 20
    assert {row["status"] for row in rows} == {"found", "not_found"}
    for row, event in zip(rows, finished, strict=True):
        answer = event.answer
        assert (row["status"], row["cost"]) == (answer.status.name.lower(), answer.cost)
        assert (row["epochs"], row["evaluations"]) == (answer.epochs, answer.evaluations)
        assert row["feasible"] == (len(answer.path) > 0) == (row["obstacles"] == 0)
        assert row["obstacles"] == answer.obstacles
        assert row["optimal_cost"] == optimum
        if row["feasible"]:
            assert row["optimality_ratio"] == pytest.approx(row["cost"] / optimum)


def test_the_manifest_says_what_was_set_and_what_came_of_it(tmp_path):
    run = make_run(tmp_path, "ga1", "kg18_test3", trials=20, recorders=())
    execution = execute(run, "test")
    known = records.Manifest.read(execution.folder)
    assert known.settings == run.settings == read_settings(execution.folder / "config.yaml")
    rows = pq.read_table(execution.folder / "trials.parquet").to_pandas()
    found = int(rows["feasible"].sum())
    assert (known.results.trials, known.results.succeeded) == (20, found) and found < 20
    assert known.results.sums["evaluations"] == rows["evaluations"].sum()
    assert known.results.sums["length"] == pytest.approx(rows["length"].sum(), rel=1e-14)
    assert known.results.counts["length"] == found
    assert "seed" not in known.results.sums and "map" not in known.results.sums


def test_other_settings_maps_and_code_are_other_runs(monkeypatch):
    grid, other = generate("kg18_test1", 0), generate("kg18_test1", 1)
    problem = Problem(grid, grid.start, grid.target)
    found = {
        keys.run_key({"a": 1}, problem, {}),
        keys.run_key({"a": 2}, problem, {}),
        keys.run_key({"a": 1}, problem, {"a/k.map": "1"}),
        keys.run_key({"a": 1}, problem, {"a/k.map": "2"}),
        keys.run_key({"a": 1}, Problem(other, grid.start, grid.target), {}),
        keys.run_key({"a": 1}, Problem(grid, grid.start, (97, 24)), {}),
    }
    monkeypatch.setattr(keys, "code_hash", lambda: "other")
    found.add(keys.run_key({"a": 1}, problem, {}))
    assert len(found) == 7


def test_the_same_setting_with_other_code_or_more_trials_is_the_same_setting(monkeypatch):
    grid = generate("kg18_test1", 0)
    problem = Problem(grid, grid.start, grid.target)

    def settings(trials, recorder):
        return flatten({"seed": 1, "trials": trials, "recorder": {recorder: {"kind": recorder}}})

    few = keys.setting_hash(settings(3, "mcap"), problem, {})
    monkeypatch.setattr(keys, "code_hash", lambda: "other")
    assert keys.setting_hash(settings(9, "none"), problem, {}) == few
    assert keys.setting_hash({"seed": 2}, problem, {}) != few


class ReadsLate:
    """A planner that looks into a file each time that it plans."""

    exact = True
    minimises = "weights"

    def __init__(self, path):
        self.path = path

    def plan(self, problem, stream):
        self.path.read_text()
        return shortest_path(problem)


def test_a_file_that_is_read_only_while_trials_run_is_compared(tmp_path):
    path = tmp_path / "late.txt"
    path.write_text("1")
    run = replace(make_run(tmp_path / "out", trials=1), task=PlanTask(ReadsLate(path)))
    assert [execute(run, "test").state for _ in range(2)] == ["done", "skipped"]
    manifest = records.Manifest.read(execute(run, "test").folder)
    assert (list(manifest.late_inputs), manifest.method_inputs) == ([str(path)], {})
    path.write_text("2")
    assert [execute(run, "test").state for _ in range(2)] == ["done", "skipped"]


def test_a_killed_run_leaves_nothing_that_looks_whole(tmp_path):
    """The log that it leaves can be saved, and the same command does the run afterwards."""
    code = (
        "import sys, pathlib; sys.path.insert(0, sys.argv[1]); import test_experiment as t; "
        "run = t.make_run(sys.argv[2], 'ga1', 'kg18_test4', trials=100_000); "
        "t.execute(run, 'test')"
    )
    here = os.path.dirname(__file__)  # noqa: PTH120
    process = subprocess.Popen([sys.executable, "-c", code, here, str(tmp_path)])
    try:
        deadline = time.monotonic() + 60
        while not any(p.stat().st_size > 300_000 for p in tmp_path.rglob("run.mcap.part")):
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.05)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    (folder,) = (tmp_path / "test").iterdir()
    assert json.loads((folder / "status.json").read_bytes())["state"] == "running"
    assert not (folder / "run.mcap").exists()
    known = Manifest.read(folder)  # what it was
    assert (known.map, known.method, known.trials, known.files) == (
        "kg18_test4", "ga1", 100_000, {},
    )  # fmt: skip
    with runfolder.RunFolder(folder).lock():  # nobody holds it: the run is dead
        assert not whole.is_whole(runfolder.RunFolder(folder), known.settings)
    saved = tmp_path / "saved.mcap"
    assert log_cli.main(["salvage", str(folder / "run.part/run.mcap.part"), "-o", str(saved)]) == 0
    assert sum(1 for _ in read_events(saved)) > 3


def test_a_full_disk_is_a_failed_run(tmp_path, monkeypatch):
    run = make_run(tmp_path, "ga1", recorders=("mcap", "rerun"))

    def full(path, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("gapath.recorders.rerun.recording.write_part", full)
    with pytest.raises(InputError, match="recorder rerun: got No space"):
        execute(run, "test")
    (folder,) = (tmp_path / "test").iterdir()
    status = json.loads((folder / "status.json").read_bytes())
    assert status["state"] == "failed"
    assert "No space left" in status["message"]
    assert not (folder / "run.mcap").exists()
