"""A crate's runs done again: the four verdicts, each of a real crate."""

import json
from dataclasses import replace

import pytest
from runs_for_crates import called, make_runs, resealed, rewritten, run_with

from gapath.events import RunStarted, TrialFinished
from gapath.recorders import mcap
from gapath.store.keys import versions


@pytest.fixture
def made(gapath):
    return make_runs(gapath)


@pytest.fixture
def answer(made, capfd, tmp_path):
    """Make a crate of a run, repeat it; gives exit code, sentence and what JSON says of it."""

    def repeat(run):
        crate = tmp_path / "crate"
        assert called(capfd, "crate", run, crate)[0] == 0
        code, out, err = called(capfd, "repeat", crate)
        assert not err
        again, as_json, _ = called(capfd, "repeat", crate, "--json")
        assert again == code
        content = json.loads(as_json)
        (only,) = content["runs"]
        assert content["verdict"] == only["verdict"]
        line, summary = out.splitlines()
        assert line.startswith(f"office/{run.name}: {only['verdict']}, ")
        assert summary == f"{crate}: {only['verdict']}; of 1 run 1 {only['verdict']}"
        return code, line, only

    return repeat


def costlier(event):
    """Say of the second trial that its path cost more."""
    if isinstance(event, TrialFinished) and event.trial == 1:
        return replace(event, answer=replace(event.answer, weights=event.answer.weights + 1))
    return event


def test_what_comes_to_the_same_bytes_is_reproduced(made, answer):
    code, line, only = answer(run_with(made, "astar"))
    assert (code, only["verdict"], only["difference"], only["others"]) == (0, "reproduced", "", {})
    assert f"bit for bit, {only['messages']} messages" in line
    assert only["messages"] > 4


def test_the_same_messages_in_other_chunks_of_other_versions_are_equivalent(
    made, answer, monkeypatch
):
    run = run_with(made, "astar")
    with monkeypatch.context() as patch:
        patch.setattr("gapath.recorders.mcap.log.CHUNK_MESSAGES", 2)
        rewritten(run, versions={"zstandard": "0.1"})
    code, line, only = answer(run)
    assert (code, only["verdict"], only["difference"]) == (0, "equivalent", "")
    assert only["others"] == {"zstandard": ["0.1", versions()["zstandard"]]}
    assert f"made with zstandard 0.1 ({versions()['zstandard']} here)" in line


def test_another_result_of_the_same_code_is_different(made, answer):
    run = run_with(made, "astar")
    rewritten(run, costlier)
    code, line, only = answer(run)
    assert (code, only["verdict"]) == (1, "different")
    assert "step 1, /result" in only["difference"]
    assert "4.5 in the log, 3.5 now" in only["difference"]
    assert only["difference"] in line


def test_other_bytes_of_the_same_versions_are_different(made, answer, monkeypatch):
    run = run_with(made, "astar")
    with monkeypatch.context() as patch:
        patch.setattr("gapath.recorders.mcap.log.CHUNK_MESSAGES", 2)
        rewritten(run)
    code, line, only = answer(run)
    assert (code, only["verdict"]) == (1, "different")
    assert "though all" in line


def test_another_result_of_other_code_is_inconclusive(made, answer):
    run = run_with(made, "astar")
    rewritten(run, costlier, versions={"code": "0" * 16})
    code, line, only = answer(run)
    assert (code, only["verdict"]) == (3, "inconclusive")
    assert "4.5 in the log, 3.5 now" in only["difference"]
    assert f"code {'0' * 16} ({versions()['code']} here)" in line


@pytest.mark.parametrize("group", ["planner", "map"])
def test_what_is_not_installed_here_is_inconclusive(made, answer, group):
    def of_a_package(event):
        if isinstance(event, RunStarted):
            return replace(event, settings={**event.settings, f"{group}.kind": "theirs"})
        return event

    run = run_with(made, "astar")
    rewritten(run, of_a_package, versions={"their-package": "1.2"})
    code, line, only = answer(run)
    assert (code, only["verdict"]) == (3, "inconclusive")
    assert f"{group}.kind: theirs; made with their-package 1.2 (none here)" in line


def test_a_run_without_a_log_is_inconclusive(made, answer):
    run = run_with(made, "astar")
    (run / mcap.FILE).unlink()
    resealed(run)
    code, line, only = answer(run)
    assert (code, only["verdict"]) == (3, "inconclusive")
    assert line.endswith("inconclusive, it has no log, so neither map nor steps")


def test_a_crate_is_what_the_worst_of_its_runs_is(made, capfd):
    rewritten(run_with(made, "astar"), costlier)
    (run_with(made, "dijkstra") / mcap.FILE).unlink()
    resealed(run_with(made, "dijkstra"))
    assert called(capfd, "crate", made, "crate")[0] == 0
    code, out, _ = called(capfd, "repeat", "crate")
    assert code == 1
    assert out.splitlines()[-1] == "crate: different; of 2 runs 1 inconclusive, 1 different"


def test_what_takes_long_is_asked_for(made, capfd, monkeypatch):
    assert called(capfd, "crate", made, "crate")[0] == 0
    monkeypatch.setattr("gapath.running.verify.MOST_WORK", 0)
    code, out, err = called(capfd, "repeat", "crate")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "--yes" in err
    assert called(capfd, "repeat", "crate", "--yes")[0] == 0
