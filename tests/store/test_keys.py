"""A run's key: the same wherever the same code lies, another for other code."""

import os
import shutil
import subprocess
import sys

import pytest
from installed import ROOT, copy_sources, install

HASH = "from gapath.store.keys import code_hash; print(code_hash())"


def code_hash(place):
    """Hash the package that lies in a folder, in a process of its own."""
    env = os.environ | {"PYTHONPATH": str(place), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, "-c", HASH], env=env, cwd=place, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """Copy a checkout to where a folder above it has a name that the package uses itself."""
    return copy_sources(tmp_path_factory.mktemp("pipelines") / "conf" / "checkout")


@pytest.fixture(scope="module")
def unedited(sources):
    return code_hash(sources)


def test_a_wheel_and_a_checkout_have_the_same_hash_wherever_they_lie(sources, unedited, tmp_path):
    install(shutil.copytree(sources, tmp_path / "copy", symlinks=True), tmp_path / "site")
    assert not (tmp_path / "site" / "gapath" / "pipelines").is_symlink()
    assert code_hash(tmp_path / "site") == unedited == code_hash(ROOT)


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("planners/bspline_ga.py", True),
        ("kernels/units.py", True),
        ("pipelines/papers/kg18.py", False),
    ],
)
def test_edited_code_is_other_code_below_any_folder(sources, unedited, name, changes):
    file = sources / "gapath" / name
    text = file.read_text()
    file.write_text(text + "# edited\n")
    assert (code_hash(sources) != unedited) == changes
    file.write_text(text)
