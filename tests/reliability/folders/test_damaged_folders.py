"""Run folders that are damaged, altered or set as a trap: never taken for whole, never followed."""

import json
import os
import shutil
import signal
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from scale import rounds
from small_run import calls, small_run

from gapath.errors import InputError
from gapath.running.experiment import execute, run_folder
from gapath.store.records import FileEntry, Manifest, read_record
from gapath.store.runfolder import LOCK, RunFolder
from gapath.store.status import Status
from gapath.store.whole import is_whole

FILES = ("status.json", "manifest.json", "config.yaml", "trials.parquet", "run.mcap")


@pytest.fixture
def run(tmp_path, monkeypatch):
    """A run that is whole."""
    monkeypatch.setattr("os.fsync", lambda file: None)
    run = small_run(tmp_path / "out")
    assert execute(run, "test").state == "done"
    return run


@contextmanager
def at_once():
    """Fail instead of waiting for ever."""

    def late(*given):
        raise AssertionError("it waits")  # no OSError, which would be caught

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(20)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def damaged(data, rng, n):
    """Flips of single bits, cuts and appended bytes."""
    bits = np.unique(rng.integers(0, 8 * len(data), n))
    for bit in bits.tolist():
        changed = bytearray(data)
        changed[bit // 8] ^= 1 << bit % 8
        yield f"bit {bit}", bytes(changed)
    for size in np.unique(rng.integers(0, len(data), n // 4)).tolist():
        yield f"cut to {size}", data[:size]
    for tail in (b"\0", b"\n", b" ", b"{}", data[-40:], data):
        yield f"{len(tail)} bytes more", data + tail


@pytest.mark.parametrize("name", FILES)
def test_no_change_of_a_file_goes_unnoticed(name, run):
    folder, tried = run_folder(run), 0
    path, rng = folder.path / name, np.random.default_rng(1)
    data = path.read_bytes()
    n = rounds(200, 8 * len(data) if name.endswith(".json") else 4000)
    for what, changed in damaged(data, rng, n):
        path.write_bytes(changed)
        tried += 1
        assert not is_whole(folder, run.settings), what
        if name.endswith(".json"):
            assert name in read_record(folder.path).fault, what
    print(f"{name}: {tried} changes, all noticed")
    path.write_bytes(data)
    assert is_whole(folder, run.settings) and not read_record(folder.path).fault


def test_a_status_of_earlier_versions_is_read(run):
    folder = run_folder(run).path
    (folder / "status.json").write_text(
        '{"state": "done", "started": "2026", "finished": "2027", "message": ""}'
    )
    found = read_record(folder)
    assert (found.fault, found.state, found.date) == ("", "done", "2027")
    status = json.loads((folder / "status.json").read_text()) | {"sha255": "0"}
    (folder / "status.json").write_text(json.dumps(status))
    assert "status.json" in read_record(folder).fault


def test_only_what_the_run_before_wrote_is_replaced(tmp_path, monkeypatch):
    execute(small_run(tmp_path, recorders=("mcap", "rerun")), "test")
    run = small_run(tmp_path, force=True)
    folder = run_folder(run).path
    theirs = {"notes.txt": b"mine", "trial-3.rrd": b"of gapath-log rerun", "x.part": b""}
    for name, content in theirs.items():
        (folder / name).write_bytes(content)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    with monkeypatch.context() as patch, pytest.raises(RuntimeError):
        patch.setattr("gapath.running.experiment._do_trials", _fail)
        execute(run, "test")
    assert {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()} == before
    assert "RuntimeError" in Status.read(folder / "run.part").message
    execute(run, "test")
    assert before.keys() - {path.name for path in folder.iterdir()} == {"trial-0.rrd"}
    assert {name: (folder / name).read_bytes() for name in theirs} == theirs


def test_a_file_that_the_run_before_had_not_written_is_kept_by_another_name(tmp_path):
    run = small_run(tmp_path)
    execute(run, "test")
    folder = run_folder(run).path
    (folder / "trial-0.rrd").write_text("mine")
    (folder / "trial-0.rrd.1").write_text("mine, too")
    both = small_run(tmp_path, recorders=("mcap", "rerun"), force=True)
    for _ in range(2):
        execute(both, "test")
        assert is_whole(run_folder(run), run.settings) and run_folder(both).path == folder
        assert (folder / "trial-0.rrd").stat().st_size > 99
        mine = {path.suffix: path.read_text() for path in folder.glob("*.rrd.*")}
        assert mine == {".1": "mine, too", ".2": "mine"}


def _fail(*given):
    raise RuntimeError("a fault of a component")


PLANTED = (*FILES, "status.json.part", "manifest.json.part", "run.mcap.part")


@pytest.mark.parametrize("where", ["", "run.part"])
@pytest.mark.parametrize("name", PLANTED)
def test_links_are_not_followed(name, where, tmp_path):
    run, victim = small_run(tmp_path / "out"), tmp_path / "victim"
    victim.write_bytes(b"theirs")
    place = run_folder(run).path / where
    place.mkdir(parents=True)
    (place / name).symlink_to(victim)
    assert execute(run, "test").state == "done"
    assert victim.read_bytes() == b"theirs"
    assert is_whole(run_folder(run), run.settings)
    if not where and name in FILES:
        (place / name).rename(victim)
        (place / name).symlink_to(victim)
        assert not is_whole(run_folder(run), run.settings)


def test_folders_and_locks_that_are_links_are_refused_or_go(tmp_path):
    run, other = small_run(tmp_path / "out"), tmp_path / "other"
    other.mkdir()
    (other / "manifest.json").write_text("{}")
    folder = run_folder(run).path
    folder.parent.mkdir(parents=True)
    folder.symlink_to(other)
    with pytest.raises(InputError, match="expected a folder of its own, not a link"):
        execute(run, "test")
    folder.unlink()
    folder.mkdir()
    (folder / LOCK).symlink_to(other / "manifest.json")
    with pytest.raises(InputError, match=r"run\.lock: got a link"):
        execute(run, "test")
    (folder / LOCK).unlink()
    (folder / LOCK).mkdir()
    with pytest.raises(InputError, match=r"run\.lock: got .*folder"):
        execute(run, "test")
    (folder / LOCK).rmdir()
    (folder / "run.part").symlink_to(other)
    assert execute(run, "test").state == "done"
    assert [path.name for path in other.iterdir()] == ["manifest.json"]
    assert (other / "manifest.json").read_text() == "{}"


def test_a_folder_in_the_place_of_a_file_is_told_before_a_trial_is_done(run, monkeypatch):
    folder = run_folder(run).path
    (folder / "run.mcap").unlink()
    (folder / "run.mcap").mkdir()
    monkeypatch.setattr("gapath.tasks.plan.plan_trials", None)
    with pytest.raises(InputError, match=r"run\.mcap: got a folder"):
        execute(run, "test")
    assert Status.read(folder).state == "failed"


@pytest.mark.parametrize("name", [*FILES, LOCK])
@pytest.mark.parametrize("kind", ["pipe", "device"])
def test_pipes_and_devices_are_no_files(name, kind, run):
    folder = run_folder(run)
    path = folder.path / name
    path.unlink()
    if kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("/dev/zero")
    with at_once():
        assert bool(read_record(folder.path).fault) == (name != LOCK)
        assert is_whole(folder, run.settings) == (name == LOCK)
        if name == LOCK:
            with pytest.raises(InputError, match=r"run\.lock: got"):
                execute(replace(run, force=True), "test")
        else:
            assert execute(run, "test").state == "done"


def put(folder, **changes):
    """Alter a manifest, and have the status vouch for it."""
    known = replace(Manifest.read(folder.path), **changes)
    replace(Status.read(folder.path), manifest=known.write(folder)).write(folder)


def test_another_runs_files_under_a_key_are_not_this_run(run, tmp_path):
    folder, other = run_folder(run), small_run(tmp_path / "out", trials=4)
    execute(other, "test")
    passwd = FileEntry("0" * 64, 1)

    def files():
        return Manifest.read(folder.path).files

    for spoil in (
        lambda: (shutil.rmtree(folder.path), shutil.copytree(run_folder(other).path, folder.path)),
        lambda: put(folder, files={}),
        lambda: put(folder, files={"trials.parquet": files()["trials.parquet"]}),
        lambda: put(folder, files={**files(), "../../etc/passwd": passwd}),
        lambda: put(folder, files={**files(), "..": passwd}),
        lambda: put(folder, settings={**run.settings, "trials": 4}),
        lambda: put(folder, settings=None),
        lambda: put(folder, key="0" * 16),
    ):  # fmt: skip
        assert is_whole(folder, run.settings)
        spoil()
        assert not is_whole(folder, run.settings)
        assert execute(run, "test").state == "done"


def test_a_whole_run_is_skipped_without_a_write(run, monkeypatch, tmp_path):
    with calls(monkeypatch, tmp_path, 1, "EACCES") as told:
        assert execute(run, "test").state == "skipped"
    assert told.count == 0


def test_the_folders_that_a_run_makes_are_durable(tmp_path, monkeypatch):
    run, synced = small_run(tmp_path / "a" / "out"), set()
    monkeypatch.setattr("os.fsync", lambda file: synced.add(os.fstat(file).st_ino))
    execute(run, "test")
    path = run_folder(run).path
    assert {folder.stat().st_ino for folder in (path, *list(path.parents)[:4])} <= synced


def test_a_recorder_may_not_name_a_file_elsewhere(tmp_path, monkeypatch):
    for name in ("../x", "status.json", ""):
        monkeypatch.setattr("gapath.recorders.mcap.log.Recorder.close", lambda self, n=name: [n])
        with pytest.raises(InputError, match="recorder, file"):
            execute(small_run(tmp_path), "test")
    assert not is_whole(RunFolder(run_folder(small_run(tmp_path)).path), {})
