"""An experiment in one file: the same bytes each time, and runs that are whole when unpacked."""

import hashlib
import os
import shutil
import tarfile

import pytest

from gapath.pipelines.reading.tags import Said, read_said, say
from gapath.pipelines.report import cli
from gapath.store.records import Manifest, find_runs, read_record
from gapath.store.runfolder import RunFolder
from gapath.store.whole import is_whole

from ..conftest import summed, write_status


@pytest.fixture
def outputs(tmp_path, make_run):
    place = tmp_path / "outputs"
    for key in ("b", "a", "c"):
        summed(make_run(place, "mine", "kg18_test1", "ga1", key=key, log=key == "a", n=4))
    make_run(place, "other", "kg18_test1", "ga1", n=4, log=False)
    write_status(place / "mine" / "c", "failed", "2020-01-01", "of itself")
    (place / "mine" / "a" / "remarks.txt").write_text("of the user's")
    say(place / "mine" / "a", lambda said: Said({"paper": "now"}))
    say(place / "mine" / "c", lambda said: Said({"bad": "now"}))
    return place


@pytest.fixture
def archive(capsys, outputs):
    def call(*words, place=outputs):
        code = cli.main(["archive", *map(str, words), "--outputs", str(place)])
        return code, *capsys.readouterr()

    return call


def test_runs_are_whole_where_they_are_unpacked(archive, outputs, tmp_path):
    code, text, errors = archive("mine", tmp_path / "mine.tar.gz")
    assert (code, errors) == (0, "left out mine/c: failed: of itself\n") and ": 2 runs, " in text
    with tarfile.open(tmp_path / "mine.tar.gz") as tar:
        tar.extractall(tmp_path / "unpacked")
    there, before = find_runs(tmp_path / "unpacked"), find_runs(outputs)
    assert [run.name for run in there] == ["mine/a", "mine/b"]
    for run in there:
        assert not run.fault and is_whole(RunFolder(run.folder), run.settings)
    assert [run.known for run in there] == [run.known for run in before[:2]]
    assert not (tmp_path / "unpacked" / "mine" / "a" / "remarks.txt").exists()
    assert read_said(tmp_path / "unpacked" / "mine") == {"a": Said({"paper": "now"})}


def test_the_bytes_depend_on_the_runs_alone(archive, outputs, tmp_path):
    archive("mine", tmp_path / "1.tar.gz")
    copy = tmp_path / "elsewhere" / "copied"
    shutil.copytree(outputs, copy)
    for path in copy.rglob("*"):
        path.chmod(0o700)
        os.utime(path, (1, 1))
    archive("mine", tmp_path / "2.tar.gz", place=copy)
    first, second = ((tmp_path / f"{i}.tar.gz").read_bytes() for i in (1, 2))
    assert hashlib.sha256(first).hexdigest() == hashlib.sha256(second).hexdigest()
    with tarfile.open(tmp_path / "1.tar.gz") as tar:
        entries = tar.getmembers()
    assert {(e.mtime, e.uid, e.gid, e.uname, e.gname, e.mode) for e in entries} == {
        (0, 0, 0, "", "", 0o644)
    }
    names = [entry.name for entry in entries]
    assert names[-1] == "mine/tags.json" and all(name.startswith("mine/") for name in names)


BAD = {
    "an unknown experiment": (("mien", "a.tar.gz"), "EXPERIMENT: got mien, .* did you mean mine"),
    "a folder above": (("..", "a.tar.gz"), r"EXPERIMENT: got \.\."),
    "another ending": (("mine", "a.zip"), r"FILE: got .*a\.zip, expected a name that ends in"),
    "no folder": (("mine", "none/a.tar.gz"), r"none/a\.tar\.gz.*No such file or directory"),
    "a file that is there": (("mine", "there.tar.gz"), "expected a file that is not there yet"),
    "a link": (("mine", "link.tar.gz"), "expected a file that is not there yet"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_packed_is_one_line(archive, tmp_path, name):
    (tmp_path / "there.tar.gz").write_text("of the user's")
    (tmp_path / "link.tar.gz").symlink_to(tmp_path / "nowhere")
    (experiment, file), error = BAD[name]
    before = sorted(tmp_path.iterdir())
    code, text, errors = archive(experiment, tmp_path / file)
    assert (code, text, errors.count("\n")) == (2, "", 1)
    assert_matches(error, errors)
    assert sorted(tmp_path.iterdir()) == before
    assert (tmp_path / "there.tar.gz").read_text() == "of the user's"


def assert_matches(pattern, text):
    with pytest.raises(ValueError, match=pattern):
        raise ValueError(text)


def change(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def test_a_run_that_was_altered_is_not_packed(archive, outputs, tmp_path):
    change(outputs / "mine" / "b" / "trials.parquet")
    code, _, errors = archive("mine", tmp_path / "mine.tar.gz")
    assert code == 2 and "mine/b/trials.parquet: got SHA-256" in errors
    assert [path.name for path in tmp_path.iterdir()] == ["outputs"]


def test_a_disk_that_is_full_leaves_nothing(archive, tmp_path, monkeypatch):
    def full(file):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    code, _, errors = archive("mine", tmp_path / "mine.tar.gz")
    assert code == 2 and "No space left" in errors
    assert [path.name for path in tmp_path.iterdir()] == ["outputs"]


def test_an_experiment_without_a_run_that_can_be_used_is_refused(archive, outputs, tmp_path):
    for key in ("a", "b"):
        write_status(outputs / "mine" / key, "failed")
    code, _, errors = archive("mine", tmp_path / "mine.tar.gz")
    assert code == 2 and "no run that can be used" in errors


def test_the_files_of_a_run_are_all_that_its_manifest_names(archive, outputs, tmp_path):
    archive("mine", tmp_path / "mine.tar.gz")
    with tarfile.open(tmp_path / "mine.tar.gz") as tar:
        names = {name for name in tar.getnames() if name.startswith("mine/a/")}
    known = Manifest.read(read_record(outputs / "mine" / "a").folder)
    expected = {*known.files, "manifest.json", "status.json"}
    assert names == {f"mine/a/{name}" for name in expected}
