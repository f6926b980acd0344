"""Where sweeps stand, for who looks on: lines that end with the sweeps, and the report's."""

import threading

import pytest

from gapath.pipelines.report import cli, watch
from gapath.pipelines.report.report import make_report
from gapath.running.sweep import SweepFile, tell


@pytest.fixture
def sweep(gapath, tmp_path):
    """A sweep of three jobs, one of which was whole before."""
    assert gapath("map=kg18_test1", "planner=astar", "recorder=none")[0] == 0
    command = "gapath -m seed=1,2,3"
    head = {"command": command, "jobs": 3, "whole": 1, "folders": ["a", "b", "c"]}
    return SweepFile(tmp_path / "out" / "plan", head)


def test_who_watches_sees_jobs_end_and_ends_with_the_sweep(sweep, tmp_path, capfd, monkeypatch):
    def pause(seconds):
        looks.append(seconds)
        if len(looks) == 2:
            tell(sweep.path, begun=0, words=["seed=2"])
            tell(sweep.path, ended=0, code=2, trials=7)
            tell(sweep.path, begun=1, words=["seed=3"])
        if len(looks) == 4:
            tell(sweep.path, ended=1, code=0, trials=5)
            sweep.close(done=False)

    looks = []
    monkeypatch.setattr(watch.time, "sleep", pause)
    ended = threading.Timer(60, lambda: sweep.close(done=False))  # should it never end
    ended.start()
    assert cli.main(["watch", str(tmp_path / "out")]) == 0
    ended.cancel()
    first, second, last, runs = capfd.readouterr().out.splitlines()
    assert first == "plan: 1 of 3 jobs ended, 1 of them whole before, 0 running"
    assert second.startswith("plan: 2 of 3 jobs ended, 1 of them whole before, 1 failed, 1 running")
    assert "jobs a minute" in second and "trials/s, about 0:00 left" in second
    assert last == (
        "plan: a sweep that is not finished: 3 of 3 jobs ended, 1 of them whole before, 1 failed, "
        "1 runs are left; `gapath -m seed=1,2,3` goes on"
    )
    assert runs == f"runs in {tmp_path}/out: 1 done"
    assert len(looks) == 4


def test_to_look_once_ends_at_once(sweep, tmp_path, capfd):
    assert cli.main(["watch", "--once", str(tmp_path / "out")]) == 0
    assert capfd.readouterr().out.startswith("plan: 1 of 3 jobs ended, 1 of them whole before, 0")
    sweep.close(done=True)
    assert cli.main(["watch", str(tmp_path / "out")]) == 0
    assert capfd.readouterr().out == f"runs in {tmp_path}/out: 1 done\n"
    assert cli.main(["watch", str(tmp_path / "none")]) == 2


def test_a_report_of_a_sweep_that_is_not_finished_says_so(sweep, tmp_path, undrawn):
    sweep.close(done=False)
    _, skipped = make_report(tmp_path / "out", tmp_path / "report")
    (told,) = [each.reason for each in skipped if each.run.startswith("plan/sweep-")]
    assert told.startswith("a sweep that is not finished: 1 of 3 jobs ended")
    assert told.endswith("2 runs are left; `gapath -m seed=1,2,3` goes on")
