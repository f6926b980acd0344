"""The package as pip installs it, beside the checkout."""

import shutil
import subprocess
import sys
from pathlib import Path

import gapath

ROOT = Path(gapath.__file__).parents[1]


def copy_sources(place):
    """Copy what a wheel is made of; give the folder."""
    place.mkdir(parents=True)
    for name in ("gapath", "pipelines", "conf", "maps"):
        ignore = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, place / name, symlinks=True, ignore=ignore)
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, place)
    return place


def install(sources, site):
    """Install a copy of the sources, and nothing else, into a folder; a build writes beside it."""
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    options = ["--no-index", "--no-deps", "--no-build-isolation", "--target", str(site)]
    done = subprocess.run([*pip, *options, str(sources)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return site
