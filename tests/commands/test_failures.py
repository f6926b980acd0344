"""Runs that fail, are interrupted or are ended by a component: what is told, and what stays."""

import json
import re
import sys

import pytest

from gapath.commands import run as cli
from gapath.pipelines.reading.frame import run_frame
from gapath.store.records import find_runs


def only(folder):
    (path,) = folder.iterdir()
    return path


@pytest.mark.parametrize("kind", [RuntimeError, SystemExit])
def test_a_sweep_does_every_setting_and_goes_on_after_a_failure(gapath, monkeypatch, kind):
    def fail(run, command, **shown):
        if run.method.name == "ga1[population=8]":
            raise kind("no luck")
        return execute(run, command, **shown)

    execute = cli.execute
    monkeypatch.setattr(cli, "execute", fail)
    code, text, errors = gapath(
        "-m",
        "map=kg18_test1",
        "planner=ga1",
        "planner.population=8,12,16",
        "recorder=none",
        "trials=3",
    )
    assert code == 1
    assert f"gapath: {kind.__name__}: no luck (test_failures.py, line " in errors
    lines = [line for line in text.splitlines() if "of 3 found" in line]
    assert [line.split(":")[0].split()[1] for line in lines] == [
        "ga1[population=12]",
        "ga1[population=16]",
    ]


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (lambda *given: 1 / 0, "ZeroDivisionError: division by zero"),
        (lambda *given: sys.exit(0), "SystemExit: 0"),
        (lambda *given: sys.exit(), "SystemExit:"),
    ],
)
def test_a_failing_run_says_so_in_its_folder(gapath, tmp_path, monkeypatch, fault, said):
    monkeypatch.setattr("gapath.tasks.plan.plan_trials", fault)
    code, _, errors = gapath("map=kg18_test1")
    assert code == 1
    folder = only(tmp_path / "out" / "plan")
    assert re.fullmatch(
        rf"gapath: task plan: {said} \(test_failures.py, line \d+\); "
        f"the traceback is in {folder}/status.json\n",
        errors,
    )
    status = json.loads((folder / "status.json").read_bytes())
    assert status["state"] == "failed"
    assert said.rstrip(":") in status["message"]


def test_a_sweep_whose_check_is_ended_by_a_component_says_so(gapath, monkeypatch):
    monkeypatch.setattr(cli, "make_run", lambda *given: sys.exit(0))
    code, text, errors = gapath("-m", "map=kg18_test1,kg18_test2", "planner=astar")
    assert (code, text) == (1, "")
    assert re.fullmatch(r"gapath: SystemExit: 0 \(test_failures.py, line \d+\)\n", errors)


def test_an_interrupted_run_says_so(gapath, tmp_path, monkeypatch):
    def interrupt(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("gapath.tasks.plan.plan_trials", interrupt)
    run = ("map=kg18_test1", "planner=ga1", "planner.population=60", "seed=7", "trials=5")
    with pytest.raises(KeyboardInterrupt):
        gapath(*run)
    folder = only(tmp_path / "out" / "plan")
    assert json.loads((folder / "status.json").read_bytes())["state"] == "interrupted"
    (listed,) = run_frame(find_runs(tmp_path / "out")).to_dict("records")
    assert {name: listed[name] for name in ("map", "method", "seed", "trials", "fault")} == {
        "map": "kg18_test1", "method": "ga1[population=60]", "seed": 7, "trials": 5,
        "fault": "interrupted",
    }  # fmt: skip
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    assert "skipped" not in gapath(*run)[1]


def test_a_forced_run_that_fails_keeps_what_was_there(gapath, tmp_path, monkeypatch):
    run = ["map=kg18_test1", "planner=astar", "recorder=none"]
    gapath(*run)
    folder = only(tmp_path / "out" / "plan")
    before = (folder / "trials.parquet").read_bytes()
    monkeypatch.setattr("gapath.tasks.plan.plan_trials", lambda *given: 1 / 0)
    assert gapath(*run, "force=true")[0] == 1
    assert (folder / "trials.parquet").read_bytes() == before
