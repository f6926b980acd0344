"""The same sweep on every engine, interrupted and resumed: the same rows, and no process stays."""

import contextlib
import importlib.util
import json
import os
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from ending import INT, TERM, ended, started, states, wait
from scale import rounds

from gapath.running.sweep import sweep_files, unfinished
from gapath.store.records import find_runs

JOBS = rounds(6, 60)
PLUGINS = {"joblib": "joblib", "submitit_local": "submitit"}
ENGINES = rounds(("joblib",), ("joblib", "submitit_local"))
SWEEP = ["-m", "map=kg18_test3", "planner=ga3", "trials=200", "recorder=mcap",
         f"seed=range({JOBS})", "name=sweep"]  # fmt: skip


def made(out):
    """What a sweep came to: by key the rows but for times, and the log's hash."""
    found = {}
    for run in find_runs(out):
        assert run.state == "done", run.fault
        table = pq.read_table(run.folder / "trials.parquet")
        kept = table.select([name for name in table.column_names if not name.endswith("_s")])
        found[run.folder.name] = (str(kept.to_pydict()), run.known.files["run.mcap"].sha256)
    return found


def processes(out):
    """Those that were started for a sweep and live, by their environment."""
    mark, found = f"GAPATH_TRIED={out}".encode(), []
    for place in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if mark in (place / "environ").read_bytes().split(b"\0"):
                found.append((place / "cmdline").read_bytes())
    return found


def begun(out, engine, errors):
    words = [*SWEEP, f"output={out}", f"hydra/launcher={engine}"]
    return started("gapath", words, errors, GAPATH_TRIED=str(out))


@pytest.fixture(scope="module")
def basic(tmp_path_factory):
    folder = tmp_path_factory.mktemp("basic")
    process = begun(folder / "out", "basic", folder / "errors")
    wait(process, lambda: False, 600)
    assert (process.returncode, (folder / "errors").read_text()) == (0, "")
    return made(folder / "out")


@pytest.mark.parametrize("engine", ENGINES)
def test_a_sweep_that_was_interrupted_comes_to_the_same(engine, basic, tmp_path):
    if importlib.util.find_spec(f"hydra_plugins.hydra_{PLUGINS[engine]}_launcher") is None:
        pytest.skip("not installed")
    out, errors = tmp_path / "out", tmp_path / "errors"
    whole = set()
    for number, share in [(TERM, 0.2), (INT, 0.6)][: rounds(1, 2)]:
        process = begun(out, engine, errors)
        wait(process, lambda share=share: states(out).count("done") >= max(share * JOBS, 1), 600)
        ended(process, number)
        assert process.returncode == 128 + number
        end = time.monotonic() + 10
        while processes(out):
            assert time.monotonic() < end, processes(out)
            time.sleep(0.05)
        assert errors.read_text().startswith("gapath: ")
        assert "running" not in states(out)
        (left,) = unfinished(out)
        assert not left.alive
        now = {run.folder for run in find_runs(out) if not run.fault}
        assert whole <= now
        whole = now
    times = {path: (path / "status.json").read_bytes() for path in whole}
    process = begun(out, engine, errors)
    wait(process, lambda: False, 600)
    assert process.returncode == 0, errors.read_text()
    assert {path: (path / "status.json").read_bytes() for path in whole} == times
    assert made(out) == basic
    assert sweep_files(out) == []
    print(f"{engine}: {JOBS} jobs, interrupted {rounds(1, 2)} times, {len(whole)} whole before the "
          f"end: rows and logs of the basic launcher, no process stayed")  # fmt: skip


@pytest.mark.parametrize("engine", ENGINES)
def test_a_sweep_that_is_killed_takes_its_processes_along(engine, tmp_path):
    if importlib.util.find_spec(f"hydra_plugins.hydra_{PLUGINS[engine]}_launcher") is None:
        pytest.skip("not installed")
    out = tmp_path / "out"
    process = begun(out, engine, tmp_path / "errors")
    wait(process, lambda: states(out).count("running") >= 2, 120)
    os.kill(process.pid, 9)
    process.wait()
    end = time.monotonic() + 10
    while processes(out):
        assert time.monotonic() < end, processes(out)
        time.sleep(0.05)
    assert "running" not in states(out)
    assert json.loads((out / "sweep" / unfinished(out)[0].path.name).read_text().splitlines()[0])
