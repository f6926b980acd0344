"""Commands that a signal ends, and all that comes of a run but its times."""

import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import pyarrow.parquet as pq

from gapath import __main__
from gapath.running.experiment import Execution, run_folder
from gapath.running.sweep import BUSY
from gapath.store.records import Manifest
from gapath.store.runfolder import BEFORE, PROGRESS, WORK
from gapath.store.status import STATUS, RunState
from gapath.store.whole import is_whole

INT, TERM, KILL = signal.SIGINT, signal.SIGTERM, signal.SIGKILL
WORDS = {INT: "interrupted", TERM: "terminated"}
KEPT = "; what is done is kept, and the same command goes on"  # of gapath itself

ROOT = Path(__file__).parents[2]
SCRIPTS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["scripts"]


class Forked:
    """Work, under the signals of `gapath`, in a process that need not import anything.

    It writes into a file what standard error is told.
    """

    def __init__(self, work, errors):
        self.returncode = None
        self.pid = os.fork()
        if not self.pid:
            self._run(work, errors)

    def _run(self, work, errors):
        code = 99
        try:
            signal.signal(INT, signal.default_int_handler)
            os.dup2(os.open(errors, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            sys.stdout, sys.stderr = (os.fdopen(n, "w", closefd=False) for n in (1, 2))
            work()
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


def command(words, before=lambda: None):
    """The command `gapath`, as work to be forked."""

    def work():
        sys.argv = ["gapath", *words]
        before()
        __main__.main()

    return work


def runs_of(gapath, monkeypatch, words):
    """Give the runs that a command would do."""
    runs = []

    def take(run, *given, **more):
        runs.append(run)
        return Execution(run_folder(run).path, RunState.BUSY, [])

    with monkeypatch.context() as patch:
        patch.setattr("gapath.commands.run.execute", take)
        assert gapath(*words)[0] == BUSY
    return runs


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


def shown(path):
    """What a recording has but the identifiers, which no two share."""
    from rerun.chunk import RrdReader

    chunks = RrdReader(str(path)).stream()
    tables = [(each.entity_path, each.to_record_batch().to_pydict()) for each in chunks]
    for _, table in tables:
        table.pop("rerun.controls.RowId", None)
    return sorted(map(str, tables))


def outcome(folder):
    """All that a run's folder holds but times, and what depends on them."""
    assert is_whole(folder, Manifest.read(folder.path).settings)
    files = {path.name: path.read_bytes() for path in folder.path.iterdir()}
    assert not {WORK, BEFORE, PROGRESS} & files.keys()
    table = pq.read_table(folder.path / "trials.parquet")
    kept = [name for name in table.column_names if not name.endswith("_s")]
    files |= {name: shown(folder.path / name) for name in files if name.endswith(".rrd")}
    files["trials.parquet"] = str(table.select(kept).to_pylist())
    manifest = json.loads(files.pop("manifest.json"))
    for name in [name for name in files if name.endswith((".rrd", ".parquet"))]:
        del manifest["files"][name]
    del files["status.json"], manifest["provenance"]  # which has times, too
    for sums in manifest["results"].values():
        if isinstance(sums, dict):
            for name in [name for name in sums if name.endswith("_s")]:
                del sums[name]
    return files, manifest
