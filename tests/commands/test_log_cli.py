"""The ``gapath-log`` command, in process."""

import dataclasses
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gapath.commands import log as log_cli
from gapath.events import (
    NEVER_LEFT,
    DriveFinished,
    DriveStarted,
    Evolved,
    Mode,
    Outcome,
    RunFinished,
    RunStarted,
    Stepped,
    TrialFinished,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.history.evolution import Evolution
from gapath.problem import Answer, PlanStatus, Problem
from gapath.recorders import mcap
from gapath.running import verify
from gapath.store.keys import versions


def run_events(trials=30):
    """Give the events of a run on an empty map; every third trial finds nothing."""
    grid = GridMap("leer", np.full((4, 6), 0.5), resolution=0.1)
    path = np.array([[0, 0], [1, 1], [2, 1]], dtype=np.int32)
    yield RunStarted(
        "table1", "ga3", "plan", Problem(grid, (0, 0), (2, 1)), 7, trials, {"seed": 7},
        {"gapath": "0.1.0"}, path, 1.5,
    )  # fmt: skip
    for trial in range(trials):
        step = 2 * trial
        best, points = np.array([np.nan, 1.5]), np.zeros((2, 2, 2), dtype=np.int32)
        genes = points.reshape(2, 4)
        yield TrialStarted(step, trial, 7)
        yield Evolved(step, trial, 0, Evolution(best, best, genes, points, "control_points"))
        status = PlanStatus.NOT_FOUND if trial % 3 == 2 else PlanStatus.FOUND
        walked = path if status is PlanStatus.FOUND else path[:0]
        yield TrialFinished(step + 2, trial, Answer(status, walked, 1.5, 0, 0.0, 2, 60))
    yield RunFinished(2 * trials, trials, 2 * trials // 3)


def drive_events(seconds=1e-4):
    """Give the events of two drives on an empty map; the second one overruns."""
    grid = GridMap("leer", np.full((4, 6), 0.5))
    path = np.array([[0, 0], [1, 1]], dtype=np.int32)
    yield RunStarted(
        "drives", "kg18", "drive", Problem(grid, (0, 0), (1, 1)), 7, 2, {"task": "drive"},
        {"gapath": "0.1.0"}, path, 1.0,
    )  # fmt: skip
    fields, entries = path[1:], np.array([1 << 15], dtype=np.int32)
    for trial in range(2):
        step = 2 * trial
        yield TrialStarted(step, trial, 7)
        yield DriveStarted(step, trial, 1, 0.5, 1)
        yield Stepped(step, trial, (0, 0), 1, Mode.EXPLORE, fields, entries, seconds)
        yield Stepped(
            step + 1, trial, (1 - trial,) * 2, 1, Mode.EXPLORE, fields[:0], entries[:0], seconds
        )
        yield DriveFinished(step + 1, trial, Outcome(2 * trial), 1, trial)
    yield RunFinished(4, 2, 1)


@pytest.fixture(autouse=True)
def short_chunks(monkeypatch):
    monkeypatch.setattr("gapath.recorders.mcap.log.CHUNK_MESSAGES", 10)


def logged(events, folder):
    recorder = mcap.Recorder(step_s=0.1)
    recorder.open(str(folder))
    for event in events:
        recorder.record(event)
    recorder.close()
    return folder / "run.mcap"


@pytest.fixture
def log(tmp_path):
    return logged(run_events(), tmp_path)


@pytest.fixture
def drive_log(tmp_path):
    return logged(drive_events(), tmp_path)


@pytest.fixture
def cut(log):
    """Give what a killed run leaves."""
    part = log.with_name("run.mcap.part")
    part.write_bytes(log.read_bytes()[: log.stat().st_size // 2])
    log.unlink()
    return part


@pytest.fixture
def replay(monkeypatch):
    """Let the run that is done again be whatever a test wants."""
    made = SimpleNamespace(events=run_events, remarks=[])
    monkeypatch.setattr(verify, "made_again", lambda logged, kernels: made)
    monkeypatch.setattr(verify, "_check_work", lambda *made: None)
    monkeypatch.setattr(verify, "events_again", lambda made: made.events())
    return made


VERSIONS = "made with gapath 0.1.0 ({gapath} here), ".format(**versions()) + ", ".join(
    f"no version of {name} told" for name in versions() if name != "gapath"
)


def call(capsys, *argv):
    code = log_cli.main([str(word) for word in argv])
    printed = capsys.readouterr()
    assert "Traceback" not in printed.err
    return code, printed.out, printed.err


def test_info_of_a_whole_log(log, capsys):
    code, out, err = call(capsys, "info", log)
    assert (code, err) == (0, "")
    lines = {line.split(":")[0]: line for line in out.splitlines()}
    assert lines["state"].endswith(" whole")
    assert lines["trials"].endswith("30 of 30: 20 found, 10 not_found")
    rare = "2, 5, 8, 11, 14, 17, 20, 23, 26 and 1 more"
    assert lines["not_found"] == f"{'not_found:':14}trial {rare}"
    assert "found" not in lines
    assert "leer, instance 0, 6 x 4 fields of 0.1 m" in lines["map"]
    assert "(0, 0) to (2, 1)" in lines["problem"]
    assert "  /ga_run       30" in out.splitlines()
    assert "  seed: 7" in out.splitlines()


def test_info_of_drives(drive_log, capsys):
    _, out, _ = call(capsys, "info", drive_log)
    lines = {line.split(":")[0]: line for line in out.splitlines()}
    assert lines["trials"].endswith("2 of 2: 1 reached, 1 overran")
    assert lines["reached"].endswith(" trial 0") and lines["overran"].endswith(" trial 1")
    assert lines["navigator"].endswith(" kg18")
    assert lines["shortest"].endswith(" 1 steps possible")
    assert "  /drive_step   4" in out.splitlines()


def test_info_of_a_drive_that_ended_in_many_words(tmp_path, capsys):
    events = [
        replace(event, outcome=Outcome.RETURNED) if getattr(event, "outcome", 0) else event
        for event in drive_events()
    ]
    _, out, _ = call(capsys, "info", logged(events, tmp_path))
    assert f"\nreturned ({NEVER_LEFT}): trial 1\n" in out


def test_verify_of_drives_does_not_compare_wall_time(drive_log, replay, capsys):
    replay.events = lambda: drive_events(seconds=5.0)
    assert call(capsys, "verify", drive_log)[0] == 0

    def elsewhere():
        for event in drive_events():
            if isinstance(event, Stepped) and event.step == 3:
                event = dataclasses.replace(event, place=(0, 1))
            yield event

    replay.events = elsewhere
    code, out, _ = call(capsys, "verify", drive_log)
    assert code == 1
    assert "message 20, step 3, /pose.pose.position.y: 3.5 in the log, 2.5 now" in out


def test_rerun_of_drives(drive_log, capsys):
    code, out, _ = call(capsys, "rerun", drive_log, "--trials", "1")
    assert (code, out) == (0, f"{drive_log.with_name('trial-1.rrd')}\n")


def test_info_of_a_log_that_was_cut_off(cut, capsys):
    code, out, _ = call(capsys, "info", cut)
    assert code == 0
    assert "cut off or damaged" in out and f"gapath-log salvage {cut}" in out


def test_salvage_then_info(cut, capsys):
    code, out, _ = call(capsys, "salvage", cut)
    whole = cut.with_suffix("")
    assert (code, out) == (0, f"{whole}: 126 messages saved and read back\n")
    _, out, _ = call(capsys, "info", whole)
    assert "whole, but the run was interrupted" in out


def test_salvage_names_its_output(cut, capsys):
    damaged = cut.rename(cut.with_name("a.mcap"))
    assert call(capsys, "salvage", damaged)[0] == 0
    assert damaged.with_name("a.salvaged.mcap").is_file()
    other = damaged.with_name("other.mcap")
    assert call(capsys, "salvage", damaged, "-o", other)[0] == 0
    assert other.is_file()


def test_verify_of_what_is_reproduced(log, replay, capsys):
    code, out, _ = call(capsys, "verify", log)
    assert (code, out) == (0, f"{log}: reproduced, byte for byte, 128 messages; {VERSIONS}\n")


def test_verify_of_an_interrupted_run_compares_what_is_there(cut, replay, capsys):
    call(capsys, "salvage", cut)
    code, out, _ = call(capsys, "verify", cut.with_suffix(""))
    assert code == 3
    assert (
        ": interrupted after trial 29, equal so far, byte for byte, 126 messages; made with" in out
    )


def test_verify_of_several_logs_says_a_line_of_each(log, replay, capsys, tmp_path):
    replay.events = changed(3, weights=2.5)
    code, out, err = call(capsys, "verify", log, log)
    assert (code, err) == (1, "")
    begins = f"{log}: differs after 9 messages that are equal"
    assert [line.partition(":")[0] for line in out.splitlines()] == [str(log)] * 2
    assert out.count(begins) == 2
    bad = tmp_path / "bad.mcap"
    code, out, err = call(capsys, "verify", bad, log)
    assert code == 2
    assert out.count("\n") == err.count("\n") == 1
    assert str(bad) in err and str(log) in out


def test_salvage_is_suggested_only_where_there_is_something_to_save(log, replay, capsys, tmp_path):
    whole = log.read_bytes()
    for damaged, hopeful in [(whole[:-600], True), (whole[:40], False), (b"seed: 7", False)]:
        log.write_bytes(damaged)
        code, _, err = call(capsys, "verify", log)
        assert code == 2
        assert (f"gapath-log salvage {log}" in err) == hopeful
    assert "gapath-log salvage" not in call(capsys, "verify", tmp_path / "none.mcap")[2]


def changed(number, **fields):
    def events():
        for index, event in enumerate(run_events()):
            if index == number:
                event = dataclasses.replace(event, answer=replace(event.answer, **fields))
            yield event

    return events


def other_gene():
    for event in run_events():
        if isinstance(event, Evolved) and event.trial == 4:
            genes = event.evolution.chromosomes.copy()
            genes[1, 2] = 9
            event = dataclasses.replace(
                event, evolution=event.evolution._replace(chromosomes=genes)
            )
        yield event


DIFFERENCES = {
    "cost": (
        changed(3, weights=2.5),
        "message 9, step 2, /result.weights: 1.5 in the log, 2.5 now",
    ),
    "gene": (other_gene, "message 23, step 8, /ga_run.chromosomes[6]: 0 in the log, 9 now"),
    "path": (
        changed(3, path=np.zeros((1, 2), dtype=np.int32)),
        "message 8, step 2, /path.poses[1]",
    ),
    "status": (
        changed(3, status=PlanStatus.INFEASIBLE),
        "schema gapath_msgs/msg/Result in the log, message 9, step 2, /log now",
    ),
    "shorter": (lambda: list(run_events())[:-1], ", step 60, /log in the log, nothing now"),
    "kind": (
        lambda: [next(run_events()), RunFinished(0, 0, 0)],
        "schema gapath_msgs/msg/TrialStart in the log, message 6, step 0, /log now",
    ),
}


@pytest.mark.parametrize(("events", "message"), DIFFERENCES.values(), ids=DIFFERENCES)
def test_verify_names_the_first_difference(events, message, log, replay, capsys):
    replay.events = events
    code, out, _ = call(capsys, "verify", log)
    assert code == 1
    assert "differs after" in out and message in out


def test_rerun_makes_recordings(log, capsys, tmp_path):
    folder = tmp_path / "new" / "folder"
    code, out, _ = call(capsys, "rerun", log, "--trials", "0,3", "-o", folder)
    assert code == 0
    assert out.splitlines() == [str(folder / "trial-0.rrd"), str(folder / "trial-3.rrd")]
    assert (folder / "trial-3.rrd").stat().st_size > 1000
    assert call(capsys, "rerun", log)[1] == f"{log.with_name('trial-0.rrd')}\n"


BAD = {
    "missing": (lambda log: ["info", log.with_name("no.mcap")], "no.mcap"),
    "missing to view": (lambda log: ["view", log.with_name("no.mcap")], "no.mcap"),
    "folder": (lambda log: ["verify", log.parent], "the folder of a run that is whole"),
    "trial": (lambda log: ["rerun", log, "--trials", "30"], "recorder.rerun.trials"),
    "output exists": (lambda log: ["salvage", log, "-o", log], "exists"),
    "no folder": (lambda log: ["salvage", log, "-o", log / "x" / "y.mcap"], "y.mcap"),
    "yaml": (lambda log: ["info", __file__], "test_log_cli.py"),
}


@pytest.mark.parametrize(("argv", "named"), BAD.values(), ids=BAD)
def test_bad_input_is_one_line_and_exit_code_2(argv, named, log, replay, capsys):
    before = sorted(log.parent.iterdir())
    code, out, err = call(capsys, *argv(log))
    assert (code, out) == (2, "")
    assert named in err and err.count("\n") == 1
    assert sorted(log.parent.iterdir()) == before


@pytest.mark.parametrize("argv", [["rerun", "x", "--trials", "a"], [], ["info"], ["nothing", "x"]])
def test_wrong_usage_exits_with_2(argv, capsys):
    with pytest.raises(SystemExit) as stopped:
        log_cli.main(argv)
    assert stopped.value.code == 2


def test_help_lists_the_commands(capsys):
    with pytest.raises(SystemExit) as stopped:
        log_cli.main(["--help"])
    assert stopped.value.code == 0
    out = capsys.readouterr().out
    assert all(
        f"    {name} " in out
        for name in ("info", "verify", "salvage", "rerun", "view", "picture", "movie")
    )


def test_info_into_a_closed_pipe_is_no_error(log):
    command = [sys.executable, "-m", "gapath.commands.log", "info", str(log)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 0
