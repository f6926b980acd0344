"""gapath as others get it: the sdist, the wheel, and installed without any extra."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from importlib import metadata
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]

NOT_OURS = (".git", ".venv", "outputs", "build", "dist", "*.egg-info", ".hypothesis", ".*_cache")
"""What lies in a checkout and is no part of it."""

SAFELY = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}
"""How a tar file is unpacked; Python before 3.11.4 knows no filters."""


def plain(name):
    """A package's name, of which there are several ways to write it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def names_in(requirements):
    """The packages that requirements name."""
    return [plain(re.match(r"[\w.-]+", each)[0]) for each in requirements]


def copy_of_checkout(place):
    """Copy all that is ours."""
    ignore = shutil.ignore_patterns(*NOT_OURS, "__pycache__")
    shutil.copytree(ROOT, place, symlinks=True, ignore=ignore)
    (place / "outputs").mkdir()
    shutil.copy(ROOT / "outputs" / "README.md", place / "outputs")
    return place


def build(kind, sources, target):
    """Build the sdist or the wheel; give the file, and every line that the build says."""
    target.mkdir()
    code = f"import sys; from setuptools import build_meta; build_meta.build_{kind}(sys.argv[1])"
    command = [sys.executable, "-c", code, str(target)]
    around = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    done = subprocess.run(command, cwd=sources, env=around, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    (file,) = target.iterdir()
    return file, (done.stdout + done.stderr).splitlines()


def unpacked(file, place):
    """Unpack an sdist, which holds one folder; give that."""
    with tarfile.open(file) as archive:
        archive.extractall(place, **SAFELY)
    (folder,) = place.iterdir()
    return folder


def needed_by(names):
    """All packages that these need, themselves among them, as an installer finds them."""
    from packaging.requirements import Requirement

    found, left = set(), [plain(name) for name in names]
    while left:
        name = left.pop()
        if name not in found:
            found.add(name)
            needs = map(Requirement, metadata.requires(name) or [])
            left += [
                plain(each.name)
                for each in needs
                if each.marker is None or each.marker.evaluate({"extra": ""})
            ]
    return found


def linked(names, site):
    """Have a folder hold the files of installed packages."""
    for name in names:
        package = metadata.distribution(name)
        for file in package.files:
            if ".." not in file.parts and file.suffix != ".pth":
                place = site / file
                place.parent.mkdir(parents=True, exist_ok=True)
                if not place.exists() and Path(package.locate_file(file)).exists():
                    place.symlink_to(package.locate_file(file))


def light(wheel, site):
    """Install a wheel and what it needs, but no extra, into a folder."""
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    linked(needed_by(names_in(PROJECT["dependencies"])), site)
    return site


def python(site, folder, code, *words):
    """Run code in a process that has nothing but what is in a folder."""
    return subprocess.run(
        [sys.executable, "-S", "-c", code, *map(str, words)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
    )


def run(site, folder, name, *words):
    """Run a command of gapath in such a process: exit code, output and error output."""
    code = f"import sys; from gapath.__main__ import {name} as run; sys.exit(run())"
    done = python(site, folder, code, *words)
    return done.returncode, done.stdout, done.stderr
