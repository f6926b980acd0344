"""Control-C and SIGTERM while this or that is done: one line, at once, true states."""

import os
import signal
import time
from contextlib import suppress
from pathlib import Path

import pytest
from ending import (
    INT,
    KEPT,
    SCRIPTS,
    TERM,
    WORDS,
    Forked,
    command,
    ended,
    is_watching,
    started,
    states,
    wait,
)

from gapath.commands import signals
from gapath.store import durable, whole
from gapath.store import status as statuses
from gapath.store.records import find_runs

SECONDS = 4.0  # for one signal on a busy machine; `test_kills` asks for 0.5 s of half of them


@pytest.fixture(autouse=True)
def disk_is_fast(monkeypatch):
    """Of this process and those that are forked: here nothing is about what is durable."""
    monkeypatch.setattr("os.fsync", lambda file: None)


@pytest.mark.parametrize("number", [INT, TERM])
@pytest.mark.parametrize("script", SCRIPTS)
def test_every_command_ends_while_it_starts(script, number, tmp_path):
    errors = tmp_path / "errors"
    process = started(script, ["map.map", "-o", "x"], errors)
    wait(process, lambda: is_watching(process))
    seconds = ended(process, number)
    assert process.returncode == 128 + number
    assert errors.read_text() == f"{script}: {WORDS[number]}{KEPT * (script == 'gapath')}\n"
    assert seconds < SECONDS


SMALL = ["map=kg18_test1", "planner=astar", "recorder=mcap"]
GENETIC = ["map=kg18_test4", "planner=ga3", "recorder=none"]
DRIVE = ["task=drive", "map=kg18_map4", "navigator=kg18", "recorder=none"]
LONG = ["planner.population=4000", "planner.max_epochs=100000"]  # a minute in a kernel
MOMENTS = {
    "in a kernel": (GENETIC, LONG, INT),
    "in kernels on threads": (GENETIC, [*LONG, "threads=2", "trials=4"], TERM),
    "between trials": (SMALL, ["trials=1000000"], INT),
    "in a drive": (DRIVE, ["trials=100000"], TERM),
}


@pytest.mark.parametrize("moment", MOMENTS)
def test_a_run_ends(moment, gapath, tmp_path):
    some, more, number = MOMENTS[moment]
    assert gapath(*some, output=tmp_path / "first")[0] == 0  # so that the child has the kernels
    out, errors = tmp_path / "out", tmp_path / "errors"
    process = Forked(command([*some, *more, f"output={out}"]), errors)
    wait(process, lambda: states(out))
    time.sleep(0.3)
    seconds = ended(process, number)
    *warned, last = errors.read_text().splitlines()
    assert (process.returncode, last) == (128 + number, f"gapath: {WORDS[number]}{KEPT}")
    assert all("; Control-C ends it" in line for line in warned)
    assert seconds < SECONDS
    assert states(out) == ["interrupted"]
    (run,) = find_runs(out)
    assert run.fault == "interrupted"


def test_no_job_of_a_sweep_starts_while_all_are_checked(tmp_path):
    out, errors = tmp_path / "out", tmp_path / "errors"
    sweep = command(["-m", *SMALL, "seed=range(100000)", f"output={out}"])
    process = Forked(sweep, errors)
    wait(process, lambda: is_watching(process))
    time.sleep(0.3)
    seconds = ended(process, INT)
    assert (process.returncode, errors.read_text()) == (130, f"gapath: interrupted{KEPT}\n")
    assert seconds < SECONDS
    assert not out.exists()


def test_a_signal_comes_too_late_once_all_is_done(tmp_path):
    """While Python ends: neither the line nor another exit code."""
    errors = tmp_path / "errors"
    late = (
        "import atexit, os, time;"
        f"atexit.register(lambda: [(os.kill(os.getpid(), n), time.sleep(0.1)) for n in {LATE}])"
    )
    process = started("gapath-genotype", ["--version"], errors, late)
    wait(process, lambda: False)
    assert (process.returncode, errors.read_text()) == (0, "")


LATE = (int(INT), int(TERM))


def test_the_viewer_ends_with_the_command(tmp_path):
    """Which another program starts: it is none of the command's own children."""
    viewer, told, file = (tmp_path / name for name in ("viewer", "told", "x.rrd"))
    viewer.write_text(f"#!/bin/sh\necho $$ > {told}\nexec sleep 100\n")
    viewer.chmod(0o755)
    file.touch()
    path = str(viewer)
    there = {"RERUN_CLI_PATH": path, "DISPLAY": ":0"}
    process = started("gapath-log", ["view", str(file)], tmp_path / "errors", **there)
    wait(process, lambda: told.exists() and told.read_text())
    command = Path(f"/proc/{int(told.read_text())}/cmdline")
    assert command.read_bytes()
    assert ended(process, TERM) < SECONDS
    end = time.monotonic() + SECONDS
    with suppress(FileNotFoundError):
        while command.read_bytes():  # nothing, once nobody but its parent knows of it
            assert time.monotonic() < end
            time.sleep(0.01)


@pytest.mark.parametrize(
    ("patience", "numbers"), [(600.0, [INT, INT]), (600.0, [TERM, INT]), (signals.PATIENCE, [TERM])]
)
def test_a_second_signal_waits_for_nothing(patience, numbers, tmp_path, monkeypatch):
    """Last words that take for ever end with the second signal, else when patience does."""
    out, errors = tmp_path / "out", tmp_path / "errors"

    def hold():
        statuses.TURN.acquire()  # as by a disk that does not answer, in another thread

    monkeypatch.setattr(signals, "PATIENCE", patience)
    process = Forked(command([*GENETIC, *LONG, f"output={out}"], hold), errors)
    wait(process, lambda: is_watching(process))
    first, *more = numbers
    if more:
        process.send_signal(first)
        wait(process, errors.read_text)  # else the two may become one
        time.sleep(0.05)
        assert process.poll() is None
    seconds = ended(process, numbers[-1])
    assert (process.returncode, errors.read_text()) == (
        128 + first,
        f"gapath: {WORDS[first]}{KEPT}\n",
    )
    assert seconds < SECONDS


def test_a_run_that_is_taking_its_place_is_done(gapath, tmp_path):
    """A signal between the last status and its place waits for that, and says nothing else."""
    words, errors = [*SMALL, "name=late"], tmp_path / "errors"

    def late(source, target):
        os.kill(os.getpid(), INT)
        time.sleep(0.2)
        durable.publish(source, target)

    def before():
        whole.publish = late

    process = Forked(command([*words, f"output={tmp_path / 'out'}"], before), errors)
    wait(process, lambda: False)
    assert (process.returncode, errors.read_text()) == (130, f"gapath: interrupted{KEPT}\n")
    assert states(tmp_path / "out") == ["done"]
    assert "skipped" in gapath(*words)[1]


def test_who_imports_gapath_keeps_the_signals(gapath):
    assert gapath(*SMALL)[0] == 0
    assert signal.getsignal(TERM) == signal.SIG_DFL
    assert signal.set_wakeup_fd(-1) == -1
