"""The files that a run reads, whoever opens them."""

import hashlib
import importlib
import io
import os
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from gapath.store import inputs
from gapath.store.inputs import contents, unchanged, watched, without_paths

READ = [
    lambda path: open(path).close(),  # noqa: PTH123
    lambda path: Path(path).read_bytes(),
    lambda path: os.close(os.open(path, os.O_RDONLY)),
    lambda path: np.load(path),
    lambda path: Image.open(path).load(),
    lambda path: io.open_code(path).close(),
]


@pytest.mark.parametrize("read", READ)
def test_whoever_reads_a_file_it_is_noted(read, tmp_path):
    path = tmp_path / "a map"
    if read is READ[4]:
        Image.new("L", (2, 2)).save(path, "PNG")
    else:
        with path.open("wb") as file:
            np.save(file, np.zeros(3))
    with watched() as found:
        read(str(path))
    assert found == {str(path): hashlib.sha256(path.read_bytes()).hexdigest()}


def test_nothing_is_noted_but_what_is_read_meanwhile(tmp_path):
    before, within, after, written = (tmp_path / name for name in "abcd")
    for path in (before, within, after):
        path.write_text("1")
    before.read_text()
    with watched() as outer:
        with watched() as inner:
            within.read_text()
        written.write_text("2")
    after.read_text()
    assert list(inner) == list(outer) == [str(within)]


def test_a_failure_to_read_is_the_readers_own_affair(tmp_path):
    with pytest.raises(FileNotFoundError), watched():
        (tmp_path / "none").read_text()


def test_code_libraries_and_the_system_are_no_inputs(tmp_path, monkeypatch):
    (tmp_path / "a_module_of_ones_own.py").write_text("x = 1")
    monkeypatch.syspath_prepend(tmp_path)
    with watched() as found:
        importlib.import_module("a_module_of_ones_own")
        Path(pytest.__file__).read_text()
        Path(os.__file__).read_text()
        Path(sys.modules["gapath"].__file__).read_text()
        if Path("/proc/self/status").exists():
            Path("/proc/self/status").read_text()
    assert found == {}


@pytest.mark.parametrize("installed", [True, False])
def test_data_of_a_package_that_pip_put_into_any_folder_on_the_path_is_no_input(
    installed, tmp_path, monkeypatch
):
    (tmp_path / "package" / "data").mkdir(parents=True)
    paths = [tmp_path / name for name in ("package/__init__.py", "package/data/k.map", "k.map")]
    for path in paths:
        path.write_text("1")
    if installed:
        (tmp_path / "package-1.0.dist-info").mkdir()
    monkeypatch.syspath_prepend(tmp_path)
    inputs._no_inputs.cache_clear()
    with watched() as found:
        for path in paths:
            path.read_text()
    inputs._no_inputs.cache_clear()
    assert list(found) == [str(path) for path in (paths[2:] if installed else paths[1:])]


def test_for_a_key_it_does_not_matter_where_a_file_lies():
    assert contents({"a/k.map": "1"}) == contents({"b/k.map": "1"})
    assert contents({"k.map": "1"}) != contents({"k.map": "2"})
    assert contents({"k.map": "1", "l.map": "2"}) != contents({"k.map": "2", "l.map": "1"})


@pytest.mark.parametrize("folder", ["site-packages", "kernels", "etc", "run"])
def test_a_file_in_a_folder_of_any_name_is_an_input(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    (tmp_path / folder).mkdir()
    path = tmp_path / folder / "k.map"
    path.write_text("1")
    with watched() as found:
        path.read_text()
    assert list(found) == [str(path)]


def test_what_was_read_is_compared(tmp_path):
    path = tmp_path / "k.map"
    path.write_text("1")
    with watched() as found:
        path.read_text()
    assert unchanged(found) and unchanged({})
    path.write_text("2")
    assert not unchanged(found)
    path.unlink()
    assert not unchanged(found)


def test_a_setting_that_names_an_input_is_told_by_its_content():
    settings = {"drive.known_map": "a/k.map", "drive.step_limit": 5}
    assert without_paths(settings, {"a/k.map": "1"}) == {"drive.step_limit": 5}
