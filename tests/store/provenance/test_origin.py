"""Where a run comes from: what is said of it, and that it changes nothing else."""

import json
import re
import shutil
import time
from dataclasses import replace

import pytest

from gapath.store import keys
from gapath.store.provenance import git, machine, origin
from gapath.store.provenance.git import Tree
from gapath.store.provenance.origin import DIFF, GAPATH_DIFF, Origin, origin_of
from gapath.store.records import Manifest
from gapath.store.status import as_json


@pytest.fixture
def trees(monkeypatch, tmp_path):
    """Two repositories, of the working directory and of gapath, as a test says they are."""
    found = {tmp_path / "here": Tree({"clean": True}), tmp_path / "own": Tree({"clean": True})}
    monkeypatch.setattr(origin, "_here", lambda: tmp_path / "here")
    monkeypatch.setattr(origin, "_checkout", lambda: tmp_path / "own")
    monkeypatch.setattr(origin, "tree_of", found.__getitem__)
    return found


def test_both_repositories_are_told_and_each_has_its_diff(trees, tmp_path):
    assert not origin_of({}, "cpu").files
    trees[tmp_path / "here"] = Tree({"clean": False}, b"mine")
    trees[tmp_path / "own"] = Tree({"clean": False}, b"gapath's")
    found = origin_of({"command": "gapath seed=1"}, "cpu")
    assert found.files == {DIFF: b"mine", GAPATH_DIFF: b"gapath's"}
    assert found.said["directory"] == {"clean": False, "diff": DIFF}
    code = keys.code_hash()
    assert found.said["gapath"] == {
        "clean": False, "diff": GAPATH_DIFF, "code": code, "edited": False,
    }  # fmt: skip
    assert found.said["asker"] == {"command": "gapath seed=1"}


def test_one_repository_of_both_has_one_diff(trees, tmp_path, monkeypatch):
    monkeypatch.setattr(origin, "_checkout", lambda: tmp_path / "here")
    trees[tmp_path / "here"] = Tree({"clean": False}, b"both")
    found = origin_of({}, "cpu")
    assert found.files == {DIFF: b"both"}
    assert found.said["gapath"]["diff"] == found.said["directory"]["diff"] == DIFF


def test_a_package_that_is_no_checkout_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(origin, "_here", lambda: None)
    monkeypatch.setattr(origin, "_checkout", lambda: None)
    found = origin_of({}, "cpu")
    assert found.said["directory"] == {"told": "no repository"}
    assert found.said["gapath"]["told"] == "an installed package, no checkout"


def test_a_package_within_an_environment_is_not_the_project_around_it(tmp_path, monkeypatch):
    package = tmp_path / "project" / ".venv" / "site-packages" / "gapath"
    package.mkdir(parents=True)
    (tmp_path / "project" / ".git").mkdir()
    monkeypatch.setattr(origin, "_PACKAGE", package)
    monkeypatch.setattr(git, "_Questions", lambda top: Answers(b""))
    assert origin._checkout.__wrapped__() is None
    monkeypatch.setattr(git, "_Questions", lambda top: Answers(b"gapath/__init__.py\0"))
    assert origin._checkout.__wrapped__() == tmp_path / "project"


class Answers:
    def __init__(self, said):
        self.said = said

    def ask(self, *words):
        return self.said


def test_a_working_directory_that_is_gone_is_no_fault(tmp_path, monkeypatch):
    place = tmp_path / "gone"
    place.mkdir()
    monkeypatch.chdir(place)
    shutil.rmtree(place)
    assert origin_of({}, "cpu").said["directory"] == {"told": "no repository"}


def test_edited_sources_are_seen_and_sources_that_are_gone(monkeypatch, tmp_path):
    place = tmp_path / "gapath"
    (place / "store").mkdir(parents=True)
    (place / "conf").mkdir()
    (place / "store" / "a.py").write_text("a = 1\n")
    monkeypatch.setattr(keys, "_PACKAGE", str(place))
    code = keys.code_now()
    (place / "conf" / "b.py").write_text("")
    assert not keys.edited(code)
    (place / "store" / "a.py").write_text("a = 2\n")
    assert keys.edited(code)
    (place / "store" / "a.py").write_text("a = 1\n")
    assert not keys.edited(code)
    (place / "store" / "b.py").symlink_to("nowhere")
    assert keys.edited(code)


def test_a_clock_that_jumps_gives_no_time_below_nothing(trees, monkeypatch):
    found = origin_of({}, "cpu")
    monkeypatch.setattr(time, "time", lambda: 0.0)
    spent = found.ended(3)["spent"]
    assert spent["wall_s"] >= 0 and spent["cpu_s"] >= 0
    assert 1 << 20 < spent["peak_memory_bytes"] < 1 << 40
    assert spent["trials_taken_up"] == 3


def test_who_wants_nothing_said_gets_nothing():
    assert Origin({}, {}).ended(0) == {}


def test_the_machine_and_what_is_installed():
    told, installed = machine.machine(), machine.packages()
    assert {"host", "processor", "cpus", "cpus_usable", "system", "kernel", "python"} == set(told)
    assert 1 <= told["cpus_usable"] <= told["cpus"]
    assert list(installed) == sorted(installed) and {"numpy", "numba", "gapath"} <= set(installed)
    versions = keys.versions()
    same = {name: installed[name] for name in versions if name in installed}
    assert same == {name: versions[name] for name in same} and len(same) >= 5


def test_packages_are_those_that_an_import_finds_first(tmp_path, monkeypatch):
    for place, version in (("one", "1.0"), ("two", "2.0")):
        (tmp_path / place / f"Some_Package.x-{version}.dist-info").mkdir(parents=True)
    (tmp_path / "two" / "old-3.0-py3.11.egg-info").mkdir()
    (tmp_path / "two" / "strange-\x1b[31m.dist-info").mkdir()
    monkeypatch.setattr("sys.path", [str(tmp_path / p) for p in ("none", "one", "two")])
    assert machine.packages.__wrapped__() == {"old": "3.0", "some-package-x": "1.0"}


@pytest.mark.parametrize("given", [None, {}, {"machine": {"host": "a", "cpus": 2}, "asker": {}}])
def test_a_manifest_keeps_what_it_says_and_older_ones_say_nothing(given, tmp_path, manifest):
    content = json.loads(as_json(vars(replace(manifest, provenance=given))))
    if given is None:
        del content["provenance"]
    (tmp_path / "manifest.json").write_bytes(as_json(content))
    assert Manifest.read(tmp_path).provenance == given


@pytest.mark.parametrize("given", [[], "a", {"machine": 1}, {"machine": {"host": []}}])
def test_a_manifest_that_says_other_things_is_refused(given, tmp_path, manifest):
    content = json.loads(as_json(vars(manifest))) | {"provenance": given}
    (tmp_path / "manifest.json").write_bytes(as_json(content))
    with pytest.raises(ValueError, match=re.escape("manifest.json, provenance")):
        Manifest.read(tmp_path)


@pytest.fixture
def manifest():
    return Manifest(
        "k", "s", "e", "plan", "m", 0, "0", "(0, 0)", "(1, 1)", "astar", "astar", {}, 0, 1,
        "gapath", {}, {}, {}, {}, {},
    )  # fmt: skip
