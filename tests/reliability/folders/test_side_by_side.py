"""Processes on one run folder: one does the run, the others say so; looks disturb nobody."""

import errno
import os
import signal
import sys
import time

import pytest
from scale import rounds
from small_run import small_run

from gapath.commands import run as cli
from gapath.errors import InputError
from gapath.running.experiment import execute, run_folder
from gapath.store.records import find_runs, read_record
from gapath.store.runfolder import LOCK, RunFolder, is_locked
from gapath.store.whole import is_whole

STATES = ("done", "skipped", "busy")


def forked(work):
    """Start a process, which ends with the code that a function gives."""
    child = os.fork()
    if child:
        return child
    try:
        os._exit(work())
    except BaseException:  # it must not go on as a second pytest
        os._exit(99)


def code_of(child):
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def test_processes_that_start_at_once_do_a_run_once(tmp_path, monkeypatch):
    monkeypatch.setattr("os.fsync", lambda file: None)
    n = rounds(10, 300)
    for i in range(n):
        run = small_run(tmp_path / str(i))
        start = time.time() + 0.02

        def work(run=run, start=start):
            time.sleep(max(0.0, start - time.time()))
            return STATES.index(execute(run, "test").state)

        states = [STATES[code_of(child)] for child in [forked(work) for _ in range(3)]]
        assert states.count("done") == 1, states
        assert is_whole(run_folder(run), run.settings)
    print(f"{n} times 3 processes: each run done once, whole")


def test_a_report_meanwhile_sees_the_old_run_or_the_new_one(tmp_path):
    n = rounds(10, 300)
    folder = execute(small_run(tmp_path), "test").folder

    def again():
        for _ in range(n):
            execute(small_run(tmp_path, force=True), "test")
        return 0

    child, looks, dates = forked(again), 0, set()
    while not os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT):
        found = read_record(folder)
        looks += 1
        dates.add(found.date)
        assert (found.fault, found.state) == ("", "done")
    assert code_of(child) == 0
    print(f"{looks} looks at a run that was done again {n} times: always whole")
    assert len(dates) > n // 3


def test_looks_at_a_lock_make_no_run_busy(tmp_path):
    folder = RunFolder(tmp_path / "run")
    folder.create()
    n, lock = rounds(2000, 200_000), folder.path / LOCK
    with folder.lock():
        assert is_locked(lock)

    def look():
        while True:
            is_locked(lock)

    lookers = [forked(look) for _ in range(2)]
    try:
        for _ in range(n):
            with folder.lock():
                pass
    finally:
        for child in lookers:
            os.kill(child, signal.SIGKILL)
            code_of(child)
    assert not is_locked(lock)
    print(f"{n} locks taken beside two processes that only look: never busy")


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS])
def test_a_file_system_without_locks_is_not_busy(number, tmp_path, monkeypatch, capsys):
    def flock(file, how):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr("fcntl.flock", flock)
    with pytest.raises(InputError, match="a file system that cannot lock") as refusal:
        execute(small_run(tmp_path), "test")
    assert cli.refuse(refusal.value, [], sweep=False) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not [path for path in tmp_path.rglob("*") if path.is_file() and path.name != LOCK]


def test_sweeps_that_start_at_once_do_each_run_once(gapath, tmp_path, monkeypatch, capfd):
    words = ["-m", "map=kg18_test1", "planner=astar", "recorder=none", "name=twice"]
    assert gapath(*words, "seed=9")[0] == 0  # what is imported late
    out, seeds = tmp_path / "swept", rounds("1,2,3", ",".join(map(str, range(1, 31))))
    monkeypatch.setattr(sys, "argv", ["gapath", *words, f"seed={seeds}", f"output={out}"])

    def sweep(number):
        sys.stdout = sys.stderr = (tmp_path / f"said{number}").open("w")
        try:
            cli.main()
        except SystemExit as stop:
            return stop.code or 0
        finally:
            sys.stdout.flush()
        return 0

    children = [forked(lambda number=number: sweep(number)) for number in range(2)]
    codes = {code_of(child) for child in children}
    said = [line for i in range(2) for line in (tmp_path / f"said{i}").read_text().splitlines()]
    assert codes <= {0, cli.BUSY}, said
    done = [line for line in said if "skipped" not in line and "busy" not in line]
    runs = find_runs(out)
    assert len(runs) == len(done) == seeds.count(",") + 1, said
    assert not any(run.fault for run in runs)
