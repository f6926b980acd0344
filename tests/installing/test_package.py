"""The sdist holds all that a checkout does, the wheel all that an installed gapath needs."""

import subprocess
import sys
import tarfile
import zipfile

import packages
import pytest
from packages import ROOT

LINKS = {"conf", "maps", "pipelines"}
"""Folders at the top that are part of the package: in an sdist, which has no links, copies."""


def ours(root, *tops):
    """Files of a checkout below some folders; links lead to other tops."""
    found = set()
    for top in tops:
        paths = [root / top] if (root / top).is_file() else sorted((root / top).rglob("*"))
        for path in paths:
            name = path.relative_to(root)
            hidden = {"__pycache__", "outputs"} & set(name.parts[:-1]) - {tops[0]}
            linked = len(name.parts) > 2 and name.parts[0] == "gapath" and name.parts[1] in LINKS
            if path.is_file() and not hidden and not linked and path.suffix != ".pyc":
                found.add(name.as_posix())
    return found


def tops():
    """What lies at the top of a checkout, by name."""
    left_out = {"outputs", "build", "dist", "gapath.egg-info"}
    hidden = (".ci", ".github", ".gitignore", ".pre-commit-config.yaml")
    return [
        path.name
        for path in sorted(ROOT.iterdir())
        if path.name not in left_out and (path.name[0] != "." or path.name in hidden)
    ]


def test_the_sdist_holds_what_the_checkout_does(sdist):
    with tarfile.open(sdist[0]) as archive:
        members = archive.getmembers()
    assert not [each.name for each in members if each.issym() or each.islnk()]
    held = {each.name.partition("/")[2] for each in members if each.isfile()}
    for top in tops():
        wanted = ours(ROOT, top)
        assert wanted, top
        assert wanted - held == set(), top
    assert "outputs/README.md" in held
    extra = {name for name in held if not name.startswith(("gapath.egg-info/", "gapath/"))}
    checkout = set().union(*(ours(ROOT, top) for top in tops()))
    assert extra - checkout == {"PKG-INFO", "setup.cfg", "outputs/README.md"}


def test_the_wheel_holds_the_package_and_nothing_else(wheel):
    with zipfile.ZipFile(wheel[0]) as archive:
        held = {name for name in archive.namelist() if ".dist-info/" not in name}
    in_package = {f"gapath/{name}" for top in sorted(LINKS) for name in ours(ROOT, top)}
    wanted = ours(ROOT, "gapath") | in_package
    assert held == wanted


@pytest.mark.parametrize("kind", ["sdist", "wheel"])
def test_a_build_says_nothing_that_needs_a_look(kind, request):
    file, lines = request.getfixturevalue(kind)
    assert file.name.startswith("gapath-")
    bad = ("warning", "deprecat", "error:", "no files found", "no directories found")
    assert len(lines) > 100
    assert [line for line in lines if any(word in line.lower() for word in bad)] == []


def test_the_wheel_says_what_pyproject_does(wheel):
    with zipfile.ZipFile(wheel[0]) as archive:
        (name,) = (each for each in archive.namelist() if each.endswith(".dist-info/METADATA"))
        text = archive.read(name).decode()
    extras = [line.partition(": ")[2] for line in text.splitlines() if "Provides-Extra" in line]
    assert sorted(extras) == sorted(packages.EXTRAS)
    assert "Requires-Python: <3.14,>=3.11" in text.splitlines()


def test_tests_run_from_the_sdist(unpacked):
    """Some that read the files around them; .github/workflows/tests.yml runs all."""
    some = ["tests/test_house.py", "tests/kernels/test_rng.py", "tests/mapio"]
    command = [sys.executable, "-m", "pytest", "-n", "0", "-p", "no:cacheprovider", *some]
    done = subprocess.run(command, cwd=unpacked, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-3000:]
