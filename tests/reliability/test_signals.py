"""Control-C and SIGTERM at any moment: one line, at once, true states; the same command goes on."""

import json
import os
import random
import shutil
import signal
import statistics
import subprocess
import sys
import time
import tomllib
from contextlib import suppress
from pathlib import Path

import pytest
from scale import rounds

from gapath import __main__
from gapath.commands import signals
from gapath.recorders.mcap import FILE
from gapath.store import durable, whole
from gapath.store import status as statuses
from gapath.store.records import find_runs
from gapath.store.status import STATUS

INT, TERM = signal.SIGINT, signal.SIGTERM
WORDS = {INT: "interrupted", TERM: "terminated"}
SECONDS = 4.0  # on a machine that is busy; the figures are those of the long form

ROOT = Path(__file__).parents[2]
SCRIPTS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["scripts"]


@pytest.fixture(autouse=True)
def disk_is_fast(monkeypatch):
    """Of this process and those that are forked: here nothing is about what is durable."""
    monkeypatch.setattr("os.fsync", lambda file: None)


class Forked:
    """The command `gapath` in a process that need not import anything."""

    def __init__(self, words, errors, before=lambda: None):
        self.returncode = None
        self.pid = os.fork()
        if not self.pid:
            self._run(words, errors, before)

    def _run(self, words, errors, before):
        code = 99
        try:
            signal.signal(INT, signal.default_int_handler)
            os.dup2(os.open(errors, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            sys.argv, sys.stdout = ["gapath", *words], os.fdopen(1, "w", closefd=False)
            before()
            __main__.main()
            code = 0
        except SystemExit as stop:
            code = stop.code or 0
        finally:  # it must not go on as a second pytest
            os._exit(code)

    def poll(self):
        if self.returncode is None and (found := os.waitpid(self.pid, os.WNOHANG))[0]:
            self.returncode = os.waitstatus_to_exitcode(found[1])
        return self.returncode

    def send_signal(self, number):
        os.kill(self.pid, number)


def started(script, words, errors, before="pass", **environment):
    """A command of the project in a new process, as its script starts it."""
    module, name = SCRIPTS[script].split(":")
    code = f"{before}; from {module} import {name} as command; raise SystemExit(command())"
    with errors.open("wb") as file:
        return subprocess.Popen(
            [sys.executable, "-c", code, *words], stdout=subprocess.DEVNULL, stderr=file,
            env=os.environ | environment,
            preexec_fn=lambda: signal.signal(INT, signal.SIG_DFL),  # where tests ignore it
        )  # fmt: skip


def is_watching(process):
    """Whether it catches SIGTERM, from which moment on it promises something."""
    status = Path(f"/proc/{process.pid}/status").read_text("ascii")
    (caught,) = (int(line.split()[1], 16) for line in status.splitlines() if "SigCgt" in line)
    return caught >> (TERM - 1) & 1


def wait(process, until, seconds=60.0):
    """Wait until something is so, or the process ends; raises AssertionError after a time."""
    end = time.monotonic() + seconds
    while process.poll() is None and not until():
        assert time.monotonic() < end
        time.sleep(0.002)


def ended(process, *numbers):
    """Send signals; give for how many seconds it went on."""
    begin = time.monotonic()
    try:
        for number in numbers:
            process.send_signal(number)
        wait(process, lambda: False, 10.0)
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGKILL)
            wait(process, lambda: False)
    return time.monotonic() - begin


def states(out):
    """What the runs' own files say, whatever a reader makes of them."""
    return [json.loads(path.read_bytes())["state"] for path in out.glob(f"*/*/{STATUS}")]


@pytest.mark.parametrize("number", [INT, TERM])
@pytest.mark.parametrize("script", SCRIPTS)
def test_every_command_ends_while_it_starts(script, number, tmp_path):
    errors = tmp_path / "errors"
    process = started(script, ["map.map", "-o", "x"], errors)
    wait(process, lambda: is_watching(process))
    seconds = ended(process, number)
    assert process.returncode == 128 + number
    assert errors.read_text() == f"{script}: {WORDS[number]}\n"
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
    process = Forked([*some, *more, f"output={out}"], errors)
    wait(process, lambda: states(out))
    time.sleep(0.3)
    seconds = ended(process, number)
    assert (process.returncode, errors.read_text()) == (
        128 + number, f"gapath: {WORDS[number]}\n"
    )  # fmt: skip
    assert seconds < SECONDS
    assert states(out) == ["interrupted"]
    (run,) = find_runs(out)
    assert run.fault == "interrupted"


def test_no_job_of_a_sweep_starts_while_all_are_checked(tmp_path):
    out, errors = tmp_path / "out", tmp_path / "errors"
    process = Forked(["-m", *SMALL, "seed=range(100000)", f"output={out}"], errors)
    wait(process, lambda: is_watching(process))
    time.sleep(0.3)
    seconds = ended(process, INT)
    assert (process.returncode, errors.read_text()) == (130, "gapath: interrupted\n")
    assert seconds < SECONDS
    assert not out.exists()


def test_a_sweep_goes_on_where_it_ended(gapath, tmp_path):
    out, errors = tmp_path / "out", tmp_path / "errors"
    words = ["-m", *SMALL, f"seed=range({JOBS})", "name=sweep"]
    process = Forked([*words, f"output={out}"], errors)
    wait(process, lambda: states(out).count("done") >= 2)
    ended(process, TERM)
    assert (process.returncode, errors.read_text()) == (143, "gapath: terminated\n")
    assert "running" not in states(out)
    done = {run.folder.name for run in find_runs(out) if not run.fault}
    assert 2 <= len(done) < JOBS
    code, text, _ = gapath(*words)
    assert (code, text.count("skipped")) == (0, len(done))
    assert states(out) == ["done"] * JOBS


JOBS = 8


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
    process = started("gapath-log", ["view", str(file)], tmp_path / "errors", RERUN_CLI_PATH=path)
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
    process = Forked([*GENETIC, *LONG, f"output={out}"], errors, hold)
    wait(process, lambda: is_watching(process))
    first, *more = numbers
    if more:
        process.send_signal(first)
        wait(process, errors.read_text)  # else the two may become one
        time.sleep(0.05)
        assert process.poll() is None
    seconds = ended(process, numbers[-1])
    assert (process.returncode, errors.read_text()) == (128 + first, f"gapath: {WORDS[first]}\n")
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

    process = Forked([*words, f"output={tmp_path / 'out'}"], errors, before)
    wait(process, lambda: False)
    assert (process.returncode, errors.read_text()) == (130, "gapath: interrupted\n")
    assert states(tmp_path / "out") == ["done"]
    assert "skipped" in gapath(*words)[1]


def test_who_imports_gapath_keeps_the_signals(gapath):
    assert gapath(*SMALL)[0] == 0
    assert signal.getsignal(TERM) == signal.SIG_DFL
    assert signal.set_wakeup_fd(-1) == -1


COLD = ["map=kg18_test4", "planner=ga3", "trials=20", "recorder=mcap", "seed=3"]
AT_RANDOM = [
    ("gapath", ["map=kg18_test4", "planner=ga3", "trials=60", "recorder=mcap"]),
    ("gapath", ["map=kg18_test4", "planner=ga3", "trials=60", "threads=2", "seed=2"]),
    ("gapath", ["task=drive", "map=kg18_map4", "navigator=kg18", "trials=20", "recorder=mcap"]),
    ("gapath", ["-m", *SMALL, "trials=300", "seed=range(8)"]),
    ("gapath", COLD),
    ("gapath-report", ["REFERENCE", "-o", "REPORT"]),
    ("gapath-log", ["verify", "LOG"]),
]
TIMES = 15


@pytest.mark.skipif(rounds(True, False), reason="takes minutes")
def test_at_random_moments(tmp_path, capsys):
    chance, told = random.Random(7), []
    names = {"REFERENCE": tmp_path / "0", "REPORT": tmp_path / "report"}
    for i, (script, given) in enumerate(AT_RANDOM):
        words = [str(names.get(word, word)) for word in given]
        told += _at_random(script, words, tmp_path, i, chance)
        names["LOG"] = next((tmp_path / "0").rglob(FILE))
        with capsys.disabled():
            seconds = sorted(told)
            print(
                f"\n{len(told)} signals at random moments: none lost, none unequal; "
                f"ended after {statistics.median(seconds):.3f} s, at worst {seconds[-1]:.3f} s"
            )


def _at_random(script, words, place, number, chance):
    """Interrupt a command again and again, then let it end; give how long each end took."""
    reference, out, errors = place / str(number), place / f"{number}.out", place / "errors"
    cold = {"NUMBA_CACHE_DIR": str(place / "cache")} if words == COLD else {}

    def start(folder, **environment):
        own = [f"output={folder}"] if script == "gapath" else []
        process = started(script, [*words, *own], errors, **environment)
        wait(process, lambda: is_watching(process))
        return process

    assert start(reference).wait(600) == 0, errors.read_text()  # now kernels are compiled
    begin = time.monotonic()
    assert start(place / f"{number}.again").wait(600) == 0, errors.read_text()
    length, told = 20.0 if cold else time.monotonic() - begin, []
    while len(told) < TIMES:
        process, done = start(out, **cold), _done(out)
        with suppress(subprocess.TimeoutExpired):
            process.wait(chance.uniform(0, length))
        numbers = chance.choice([[INT], [TERM], [INT, INT]])
        seconds = ended(process, *numbers) if process.poll() is None else 0.0
        if process.returncode in (0, -numbers[0]):  # all was done, Python itself was ending
            assert errors.read_text() in ("", f"{script}: {WORDS[numbers[0]]}\n")
            assert _logs(out) == _logs(reference)
            shutil.rmtree(out, ignore_errors=True)
            continue
        assert process.returncode == 128 + numbers[0], errors.read_text()
        line = f"{script}: {WORDS[numbers[0]]}\n"
        assert errors.read_text() in ((line,) if len(numbers) == 1 else ("", line))
        assert len(numbers) == 2 or seconds > signals.PATIENCE or "running" not in states(out)
        assert done.items() <= _done(out).items(), "a finished run was done again"
        told.append(seconds)
    assert start(out, **cold).wait(600) == 0, errors.read_text()
    assert _logs(out) == _logs(reference)
    return told


def _done(out):
    """The statuses of runs that are whole, with their times."""
    texts = {path: path.read_bytes() for path in out.glob(f"*/*/{STATUS}")}
    return {path: text for path, text in texts.items() if b'"done"' in text}


def _logs(out):
    return {path.relative_to(out): path.read_bytes() for path in out.glob(f"*/*/{FILE}")}
