"""Places that lack something: a command works there, or says in one line why not, with code 2.

A home, Python's packages or a folder that cannot be written, no home at all, another user, no room
for temporary files, 100 kB for compiled kernels, a working directory that is gone. Root may write
everywhere: here it gives that up.
"""

import ctypes
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from installed import copy_sources, install
from scale import rounds

RUN = ["planner=astar", "map=field_rooms", "map.width=40", "map.height=30", "trials=1"]
START = "import sys; from gapath import __main__; sys.exit(__main__.{}())"
NO_TEMPORARY_FILES = "import tempfile; tempfile._candidate_tempdir_list = lambda: []"
STRANGER = 54321
LEFT = ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "NUMBA_CACHE_DIR", "MPLCONFIGDIR")
BOUNDING_SET_DROP, DAC_OVERRIDE, DAC_READ_SEARCH = 24, 1, 2


def command(name, *words, before=(), **changes):
    """Run one of gapath's commands in a place; its exit code and error output."""
    environment = {key: value for key, value in os.environ.items() if key not in LEFT}
    plain = {} if name == "main" and rounds(False, True) else {"NUMBA_DISABLE_JIT": "1"}
    changes["env"] = environment | plain | changes["env"]  # to compile once a place is enough
    done = subprocess.run(
        [*before, sys.executable, "-W", "ignore", "-c", START.format(name), *map(str, words)],
        capture_output=True,
        text=True,
        preexec_fn=as_anybody,
        **changes,
    )
    assert "Traceback" not in done.stderr
    assert done.returncode in (0, 2), done.stderr
    assert not done.returncode or done.stderr.count("\n") == 1, done.stderr
    return done.returncode, done.stderr


def as_anybody():
    """Give up what root may and no other: to write, and as a stranger to read, against the mode."""
    if os.geteuid() == 0:
        ctypes.CDLL(None).prctl(BOUNDING_SET_DROP, DAC_OVERRIDE, 0, 0, 0)


@pytest.fixture
def place(monkeypatch):
    """A folder that others may enter, with one that nobody may write."""
    with tempfile.TemporaryDirectory(prefix="gapath-places-") as name:
        folder = Path(name)
        folder.chmod(0o755)
        (folder / "closed").mkdir(mode=0o555)
        yield folder


def every_command(folder, **place):
    """Do a run, check and draw its log, report; which of them did not work, with what they say."""
    said = {"run": command("main", *RUN, "recorder=mcap", f"output={folder}/out", **place)}
    (log,) = (folder / "out").glob("*/*/run.mcap")
    said["verify"] = command("log", "verify", log, **place)
    if rounds(False, True):
        said["rerun"] = command("log", "rerun", log, **place)
        said["report"] = command("report", folder / "out", **place)
    return {name: error for name, (code, error) in said.items() if code}


def without_temporary_files(folder):
    (folder / "patch").mkdir()
    (folder / "patch" / "sitecustomize.py").write_text(NO_TEMPORARY_FILES)
    return {"HOME": str(folder / "closed"), "PYTHONPATH": str(folder / "patch")}


def test_without_home_nor_temporary_files(place):
    refused = every_command(place, env=without_temporary_files(place), cwd=place / "closed")
    assert list(refused) == rounds([], ["report"])
    assert all("MPLCONFIGDIR" in error for error in refused.values())
    code, error = command("main", *RUN, env={"HOME": "/"}, cwd=place / "closed")
    assert code == 2 and "outputs" in error


@pytest.mark.parametrize("name", ["main", "log", "report", "genotype"])
def test_a_working_directory_that_is_gone_is_one_line(name, place):
    (place / "gone").mkdir()
    gone = ["sh", "-c", 'rmdir "$PWD"; exec "$@"', "sh"]
    code, error = command(name, "--help", before=gone, env={"HOME": "/"}, cwd=place / "gone")
    assert code == 2 and "working directory" in error


@pytest.mark.skipif(rounds(True, False), reason="at length")
@pytest.mark.parametrize("home", ["closed", "none", "closed/none", "a file"])
def test_a_home_that_cannot_be_written(home, place):
    (place / "a file").touch()
    assert not every_command(place, env={"HOME": str(place / home)})
    assert not list((place / "closed").iterdir())


@pytest.mark.skipif(rounds(True, False), reason="at length")
def test_packages_that_cannot_be_written(place):
    site = install(copy_sources(place / "sources"), place / "site")
    for path in (site, *site.rglob("*")):
        path.chmod(0o555 if path.is_dir() else 0o444)
    environment = {"HOME": str(place / "closed"), "PYTHONPATH": str(site)}
    assert not every_command(place, env=environment)


@pytest.mark.skipif(rounds(True, False), reason="at length")
@pytest.mark.parametrize("home", [None, "closed"])
def test_another_user_whom_the_system_does_not_know(home, place):
    if os.geteuid():
        pytest.skip("only root becomes another")
    environment = {"HOME": str(place / home)} if home else {}
    stranger = {"user": STRANGER, "group": STRANGER, "extra_groups": [], "env": environment}
    if subprocess.run([sys.executable, "-c", "import gapath"], **stranger, cwd="/").returncode:
        pytest.skip("another user cannot start this Python")
    (place / "out").mkdir()
    os.chown(place / "out", STRANGER, STRANGER)
    assert not every_command(place, **stranger, cwd="/")


@pytest.mark.skipif(rounds(True, False), reason="at length")
def test_100_kB_for_a_home(place):
    (place / "home").mkdir()
    mounted = [
        *("unshare", "--mount", "sh", "-c"),
        *(f'mount -t tmpfs -o size=100k none "{place}/home" && exec "$@"', "sh"),
    ]
    if not shutil.which("unshare") or subprocess.run([*mounted, "true"]).returncode:
        pytest.skip("nothing can be mounted here")
    assert not every_command(place, before=mounted, env={"HOME": str(place / "home")})
