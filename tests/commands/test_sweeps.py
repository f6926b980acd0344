"""Sweeps on every engine: checked first, the same rows, exit codes, whole runs left alone."""

import json
import signal
import subprocess
import sys
import tracemalloc

import pyarrow.parquet as pq
import pytest
from hydra import initialize_config_dir
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra.core.global_hydra import GlobalHydra
from hydra.core.plugins import Plugins
from hydra.types import RunMode
from omegaconf import OmegaConf

from gapath.commands import composing
from gapath.commands import run as cli
from gapath.running.config import conf_folder
from gapath.running.sweep import BUSY, Standing, SweepFile, difference, sweep_files, unfinished
from gapath.store.records import find_runs
from gapath.store.runfolder import RunFolder

ENGINES = ("basic", "joblib")
SMALL = ("-m", "map=kg18_test1", "planner=ga1", "planner.population=8", "recorder=mcap", "trials=3")


def on(engine):
    more = {"joblib": ["hydra.launcher.n_jobs=2"]}
    return [f"hydra/launcher={engine}", *more.get(engine, [])]


def rows(outputs):
    """The rows of all runs but for times, by key, and the hashes of logs."""
    found = {}
    for run in find_runs(outputs):
        table = pq.read_table(run.folder / "trials.parquet")
        kept = [name for name in table.column_names if not name.endswith("_s")]
        found[run.folder.name] = (
            run.state,
            str(table.select(kept).to_pydict()),  # NaN is no other NaN
            run.known.files["run.mcap"].sha256,
        )
    return found


@pytest.mark.parametrize(
    "words",
    [
        ["seed=1", "trials=3"],
        ["planner=ga1", "planner.population=30", "seed=2"],
        ["planner=ga1", "planner.population=60", "+planner.more={a: 1}"],
        ["recorder=[]", "map=file", "map.path=a.png", "map.start=[1,2]"],
        ["experiment=table1", "seed=3", "name=other"],
        ["recorder=none", "task=drive", "drive.sensor={range: 2}", "~navigator"],
    ],
)
def test_a_job_is_composed_as_by_hydra(words):
    with initialize_config_dir(conf_folder(), version_base="1.3"):
        loader = GlobalHydra.instance().config_loader()
        given = (["seed=1,2", "hydra.mode=MULTIRUN"], RunMode.MULTIRUN)
        master = loader.load_configuration("config", *given)
        compose = composing.Composer(loader, master)
        compose(["planner=ga1", "seed=7", "planner.population=9"])
        ours, hydras = compose(words), composing._compose(loader, master, words)
    assert OmegaConf.to_yaml(ours) == OmegaConf.to_yaml(hydras)


def test_jobs_that_choose_the_same_are_composed_once(gapath, tmp_path, monkeypatch):
    def load(self, *, overrides, run_mode, **rest):
        if run_mode is RunMode.RUN:
            asked.append(overrides)
        return original(self, overrides=overrides, run_mode=run_mode, **rest)

    asked, original = [], ConfigLoaderImpl.load_configuration
    monkeypatch.setattr(ConfigLoaderImpl, "load_configuration", load)
    sweep = ("-m", "planner=astar,dijkstra", "recorder=none", "map=kg18_test1", "seed=5,6,7")
    code, _, errors = gapath(*sweep)
    assert (code, errors) == (0, "")
    assert len(asked) == 2
    seeds = sorted(run.known.seed for run in find_runs(tmp_path / "out"))
    assert seeds == [5, 5, 6, 6, 7, 7]


def test_every_engine_comes_to_the_same(gapath, tmp_path):
    made = {}
    for engine in ENGINES:
        out = tmp_path / engine
        code, text, errors = gapath(*SMALL, "seed=1,2,3", *on(engine), output=out)
        assert (code, errors) == (0, ""), engine
        assert text.count("of 3 found, median") == 3, text
        assert sweep_files(out) == []
        made[engine] = rows(out)
    assert len(made["basic"]) == 3
    assert made["basic"] == made["joblib"]


@pytest.mark.parametrize("engine", ENGINES)
def test_of_a_sweep_only_what_is_left_is_done(gapath, tmp_path, engine):
    out = tmp_path / "out"
    gapath(*SMALL, "seed=1,2")
    first = {run.folder: (run.folder / "status.json").read_bytes() for run in find_runs(out)}
    gapath(*SMALL, "seed=3,4")
    third = next(run.folder for run in find_runs(out) if run.known.seed == 3)
    fourth = next(run.folder for run in find_runs(out) if run.known.seed == 4)
    (fourth / "run.mcap").write_bytes(b"broken")
    bad = RunFolder(third)
    for file in third.iterdir():
        file.unlink()
    (third / "run.lock").mkdir()  # this job can only be refused
    code, text, errors = gapath(*SMALL, "seed=1,2,3,4", *on(engine))
    assert code == cli.BAD_INPUT
    assert text.startswith(f"skipped: 2 of 4 runs are whole, in {out}/plan (force=true")
    assert text.count("of 3 found") == 1
    assert errors.startswith(f"gapath: {third}/run.lock: got ")
    assert errors.count("\n") == 1
    assert {path: (path / "status.json").read_bytes() for path in first} == first
    (left,) = unfinished(out)
    assert (left.jobs, left.whole, left.failed, left.left) == (4, 2, 1, 1)
    assert not left.alive
    (third / "run.lock").rmdir()
    with bad.lock():
        code, text, _ = gapath(*SMALL, "seed=1,2,3,4", *on(engine))
    assert (code, "another process is working on" in text) == (BUSY, True)
    code, text, _ = gapath(*SMALL, "seed=1,2,3,4", *on(engine))
    assert (code, text.count("of 3 found")) == (0, 1)
    assert unfinished(out) == sweep_files(out) == []
    code, text, errors = gapath(*SMALL, "seed=1,2,3,4", *on(engine))
    assert (code, errors, text.count("\n")) == (0, "", 1)
    assert text.startswith("skipped: 4 of 4 runs are whole")


@pytest.mark.parametrize(
    ("engine", "right"),
    [
        ("jobilb", ": got jobilb, expected one of basic, joblib, ray"),
        ("joblib", "=joblib needs hydra-joblib-launcher: pip install 'gapath[joblib]'\n"),
        ("submitit_slurm", "=submitit_slurm needs hydra-submitit-launcher: pip install"),
        ("ray", "=ray needs hydra-ray-launcher: pip install 'gapath[ray]'\n"),
    ],
)
def test_an_engine_that_is_not_there_is_one_line(gapath, tmp_path, monkeypatch, engine, right):
    known = Plugins.instance().class_name_to_class
    monkeypatch.setattr(
        Plugins.instance(), "class_name_to_class", {n: c for n, c in known.items() if "Basic" in n}
    )
    code, text, errors = gapath(*SMALL, "seed=1,2", f"hydra/launcher={engine}")
    assert (code, text, errors.count("\n")) == (cli.BAD_INPUT, "", 1)
    assert errors.startswith(f"gapath: hydra/launcher{right}")
    assert not (tmp_path / "out").exists()


def test_a_wrong_job_is_told_before_the_first_one_by_every_engine(gapath, tmp_path):
    code, text, errors = gapath(*SMALL, "seed=1,-2", *on("joblib"))
    assert (code, text) == (cli.BAD_INPUT, "")
    assert errors == "gapath: seed: got -2, expected an integer in [0, 2^64)\n"
    assert not (tmp_path / "out").exists()


def test_a_changed_sweep_says_what_differs_from_one_that_was_not_finished(gapath, tmp_path):
    out = tmp_path / "out"
    head = {"command": "gapath -m planner=ga1 planner.population=8 seed=1,2,9", "jobs": 3,
            "whole": 0, "folders": ["a", "b", "c"]}  # fmt: skip
    SweepFile(out / "plan", head).close(done=False)
    code, _, errors = gapath(*SMALL, "seed=1,2")
    assert code == 0
    assert "another sweep here was not finished, 3 runs are left: it had seed=1,2,9 where" in errors
    assert errors.count("\n") == 1
    (left,) = unfinished(out)
    assert left.folders == ["a", "b", "c"]


def test_differences_of_commands():
    assert difference("gapath -m a=1 b=2", "gapath -m b=2 a=1") == ""
    assert difference("gapath a=1 b=2", "gapath a=1 b=3") == "b=2 where this has b=3"
    assert difference("gapath a=1", "gapath a=1 b=3") == "nothing where this has b=3"


def test_what_others_write_into_the_file_of_a_sweep_harms_nobody(tmp_path):
    head = {"command": "gapath", "jobs": 2, "whole": 0, "folders": ["a", "b"]}
    file = SweepFile(tmp_path / "plan", head)
    with file.path.open("ab") as more:
        more.write(b'\xff\n[1]\n{"ended": "x"}\n{"ended": 0}\nnull\n' + b"[" * 9999 + b"\n")
        for number in (b"Infinity", b"NaN", b"-1", b"1e300", b"null", b"9" * 400, b'""', b"[1]"):
            more.write(b'{"begun": %b, "words": []}\n{"ended": 1, "code": %b, "trials": 3}\n'
                       b'{"command": "", "jobs": %b, "whole": 0, "folders": [], "at": 0}\n'
                       b'{"command": "", "jobs": 5, "whole": 0, "folders": [], "at": %b}\n'
                       % (number, number, number, number))  # fmt: skip
        more.write(json.dumps({"ended": 0, "code": 0, "trials": 3}).encode() + b'\n{"half":')
    standing = Standing(file.path)
    standing.read()
    assert (standing.ended, standing.left, standing.trials, standing.alive) == (1, 1, 3, True)
    assert standing.unfinished() and not standing.running
    file.close(done=False)
    assert not standing.alive


def test_of_a_file_that_is_no_sweeps_no_more_is_read_than_of_one(tmp_path):
    path = tmp_path / "plan" / "sweep-a-1.jsonl"
    path.parent.mkdir()
    path.write_bytes(b"[" + b"[]," * 2**25)
    tracemalloc.start()
    try:
        assert unfinished(tmp_path) == []
        assert tracemalloc.get_traced_memory()[1] < 2**26
    finally:
        tracemalloc.stop()
    for line in (b"\n", b'{"begun": 1, "words": []}\n'):
        path.write_bytes(line * 2**21)
        standing = Standing(path, _lines=1000)
        standing.read()
        standing.read()
        assert standing._file.tell() <= 2**20


def test_a_worker_whose_sweep_was_gone_before_it_began_ends_too():
    idle = (
        "import sys, time; from gapath.commands.signals import following\n"
        "with following(lambda: False, int(sys.argv[1])): pass\n"
        "print('idle', flush=True); time.sleep(60)"
    )
    gone = subprocess.Popen(["true"])
    gone.wait()
    worker = [sys.executable, "-c", idle, str(gone.pid)]
    done = subprocess.run(worker, timeout=50, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (128 + signal.SIGTERM, "idle\n", "")
