"""A run folder: named by a key, held by a lock, whole or not there.

Files carry ``.part`` until they are complete and durable; the manifest lists every file
with its SHA-256, and ``status.json`` says "done" last of all.
"""

import contextlib
import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache
from importlib import metadata
from pathlib import Path
from typing import Any

import yaml

from gapath.errors import InputError
from gapath.problem import Problem
from gapath.store.durable import write_whole

VERSIONED = ("gapath", "numpy", "numba", "mcap", "rosbags", "rerun-sdk", "hydra-core", "pyarrow")

LOCK, STATUS, MANIFEST = "run.lock", "status.json", "manifest.json"


class Busy(Exception):
    """Another process is working on the same run."""


@lru_cache
def code_hash() -> str:
    """Hash the package's sources, so that other code means another run.

    Returns
    -------
    str
        Sixteen hexadecimal digits.
    """
    package = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py"), key=lambda path: path.as_posix()):
        if "pipelines" in path.parts:  # in a wheel; they change no run
            continue
        digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


@lru_cache
def versions() -> dict[str, str]:
    """Give the versions of gapath, of Python, and of what decides results and files.

    Returns
    -------
    dict of str to str
        Name -> version; "code" is `code_hash`.
    """
    import platform

    found = {name: metadata.version(name) for name in VERSIONED}
    return {"python": platform.python_version(), "code": code_hash(), **found}


def setting_hash(settings: str, method: str, problem: Problem) -> str:
    """Hash what two runs must share to try the same thing, with whatever code and however often.

    Parameters
    ----------
    settings : str
        The resolved configuration.
    method : str
        The planner's or navigator's name in tables.
    problem : Problem
        Map, start, target: files named by the settings may have changed.

    Returns
    -------
    str
        Sixteen hexadecimal digits.
    """
    kept = {k: v for k, v in yaml.safe_load(settings).items() if k not in ("trials", "recorder")}
    ends = f"{problem.start} {problem.target}"
    text = "\0".join([json.dumps(kept, sort_keys=True), method, problem.map.digest, ends])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def run_key(settings: str, method: str, problem: Problem) -> str:
    """Name a run by everything that its results depend on.

    Parameters
    ----------
    settings : str
        The resolved configuration.
    method : str
        The planner's or navigator's name in tables.
    problem : Problem
        Map, start, target: files named by the settings may have changed.

    Returns
    -------
    str
        Sixteen hexadecimal digits.
    """
    ends = f"{problem.start} {problem.target}"
    parts = [settings, method, problem.map.digest, ends, code_hash(), metadata.version("gapath")]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]


def sha256(path: Path) -> str:
    """Hash a file.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    str
        64 hexadecimal digits.
    """
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@dataclass(frozen=True)
class RunFolder:
    """One run's folder, ``<output>/<experiment>/<key>``."""

    path: Path

    def create(self) -> None:
        """Make the folder.

        Raises
        ------
        InputError
            If it cannot be written.
        """
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            (self.path / LOCK).touch()
        except OSError as error:
            raise InputError(
                "output", self.path, f"a folder that can be written ({error.strerror})"
            ) from error

    @contextlib.contextmanager
    def lock(self) -> Iterator[None]:
        """Hold the folder; the system lets go of it if the process dies.

        Raises
        ------
        Busy
            If another process holds it.
        """
        import fcntl

        with (self.path / LOCK).open("w") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                raise Busy(str(self.path)) from error
            yield

    def write_status(self, state: str, started: str, message: str = "") -> None:
        """Write ``status.json``.

        Parameters
        ----------
        state : str
            running, done, failed, interrupted or infeasible.
        started : str
            When the run began, as `now` gives it.
        message : str
            What went wrong, or a summary.
        """
        finished = None if state == "running" else now()
        self.write_json(
            STATUS,
            {"state": state, "started": started, "finished": finished, "message": message},
        )

    def write_json(self, name: str, content: dict[str, Any]) -> None:
        """Write a JSON file, whole."""
        write_whole(self.path / name, (json.dumps(content, indent=2) + "\n").encode())

    def keep_only(self, names: list[str]) -> None:
        """Remove what an earlier run left, once this one is whole."""
        for path in self.path.iterdir():
            if path.name not in (*names, LOCK, STATUS, MANIFEST) and path.is_file():
                path.unlink()

    def is_whole(self) -> bool:
        """Tell whether the run was finished and every file is as the manifest says."""
        try:
            state = json.loads((self.path / STATUS).read_bytes())["state"]
            listed = json.loads((self.path / MANIFEST).read_bytes())["files"]
            return state in ("done", "infeasible") and all(
                sha256(self.path / name) == entry["sha256"] for name, entry in listed.items()
            )
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return False


def now() -> str:
    """Give the time as ISO 8601 in UTC, to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")
