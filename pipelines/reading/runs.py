"""Run folders: what each holds, and whether it can be trusted."""

import contextlib
import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gapath.errors import InputError, require
from gapath.store.runfolder import LOCK, MANIFEST, STATUS

_MARKS = (STATUS, MANIFEST, "config.yaml", "trials.parquet")
_MANIFEST = {
    "key": str,
    "experiment": str,
    "map": str,
    "map_instance": int,
    "planner": str,
    "seed": int,
    "trials": int,
    "versions": dict,
    "command": str,
    "files": dict,
}


@dataclass(frozen=True)
class Run:
    """One run folder, ``<outputs>/<experiment>/<key>/``.

    Parameters
    ----------
    folder : Path
        The folder.
    state : str
        From ``status.json``: queued, running, done, failed, interrupted or infeasible; a run that
        says running but whose lock nobody holds is interrupted; unknown without a status.
    date : str
        When it finished, else when it started, ISO 8601.
    manifest : dict
        The content of ``manifest.json``; empty if there is none that can be read.
    fault : str
        Why the run cannot be used, empty if it can.
    """

    folder: Path
    state: str
    date: str
    manifest: dict[str, Any]
    fault: str

    @property
    def name(self) -> str:
        """The folder within the outputs: ``<experiment>/<key>``."""
        return f"{self.folder.parent.name}/{self.folder.name}"

    @property
    def task(self) -> str:
        """What its trials are: "plan" or "drive"; runs of before there were drives do not say."""
        return str(self.manifest.get("task", "plan"))

    @property
    def setting(self) -> str:
        """What it shares with runs of which only the newest counts; older ones give no hash."""
        names = ("experiment", "map", "map_instance", "planner", "seed")
        return str(self.manifest.get("setting", [self.manifest[name] for name in names]))

    @property
    def bytes(self) -> int:
        """Size of all its files."""
        total = 0
        for path in self.folder.iterdir():
            with contextlib.suppress(FileNotFoundError):  # a run at work renames its files
                total += path.stat().st_size
        return total


def find_runs(outputs: Path) -> list[Run]:
    """Find the run folders below a folder, sorted by experiment and key.

    Parameters
    ----------
    outputs : Path
        The folder that holds ``<experiment>/<key>/``.

    Returns
    -------
    list of Run
        All of them, also those that cannot be used.

    Raises
    ------
    InputError
        If there is no such folder, or no run in it.
    """
    require(outputs.is_dir(), outputs, "no such folder", "a folder with run folders")
    folders = sorted(path for path in outputs.glob("*/*") if path.is_dir())
    runs = [_read(path) for path in folders if any((path / mark).exists() for mark in _MARKS)]
    require(bool(runs), outputs, "no runs", "run folders <experiment>/<key>/; `gapath` makes them")
    return runs


def summary(runs: Iterable[Run]) -> list[dict[str, str]]:
    """Describe run folders for people.

    Parameters
    ----------
    runs : iterable of Run
        The runs.

    Returns
    -------
    list of dict
        One a run: key, experiment, map, planner (or navigator), trials, state, date and size;
        "?" where no manifest says it.
    """
    rows = []
    for run in runs:
        known = run.manifest
        instance = known.get("map_instance", 0)
        rows.append(
            {
                "key": run.folder.name,
                "experiment": run.folder.parent.name,
                "map": known.get("map", "?") + (f" #{instance}" if instance else ""),
                "planner": known.get("planner", "?"),
                "trials": str(known.get("trials", "?")),
                "state": run.state,
                "date": run.date[:16].replace("T", " "),
                "size": _size(run.bytes),
            }
        )
    return rows


def _read(folder: Path) -> Run:
    state, date, message = _status(folder)
    manifest: dict[str, Any] = {}
    fault = ""
    try:
        manifest = _manifest(folder)
        _check_files(folder, manifest["files"])
    except InputError as error:
        fault = str(error)
    if state not in ("done", "infeasible"):
        fault = state + (f": {message}" if message else "")
    return Run(folder, state, date, manifest, fault)


def _load(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise InputError(path.name, "no file", "a file, as every finished run has one") from error
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(path.name, type(error).__name__, "readable JSON") from error
    if not isinstance(content, dict):
        raise InputError(path.name, type(content).__name__, "a JSON object")
    return content


def _status(folder: Path) -> tuple[str, str, str]:
    """Read state, date and message."""
    try:
        status = _load(folder / STATUS)
    except InputError as error:
        return "unknown", "", str(error)
    state = str(status.get("state", "unknown"))
    if state == "running" and not _locked(folder / LOCK):
        state = "interrupted"
    date = str(status.get("finished") or status.get("started") or "")
    message = str(status.get("message") or "").strip()
    return state, date, message.splitlines()[-1] if message else ""


def _locked(path: Path) -> bool:
    """Tell whether a living process holds the lock of a run."""
    with contextlib.suppress(ImportError, OSError):
        import fcntl  # not on Windows, where no lock can be asked for

        with path.open("rb") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
            except BlockingIOError:
                return True
    return False


def _manifest(folder: Path) -> dict[str, Any]:
    manifest = _load(folder / MANIFEST)
    for name, kind in _MANIFEST.items():
        value = manifest.get(name)
        require(isinstance(value, kind), f"{MANIFEST}, {name}", value, kind.__name__)
    task = manifest.get("task", "plan")
    require(task in ("plan", "drive"), f"{MANIFEST}, task", task, "plan or drive")
    return manifest


def _check_files(folder: Path, files: dict[str, Any]) -> None:
    """Compare the sizes; hashing every log at every report would take longer than reading it."""
    require("trials.parquet" in files, f"{MANIFEST}, files", sorted(files), "trials.parquet")
    for name, entry in sorted(files.items()):
        require(Path(name).name == name, f"{MANIFEST}, files", name, "a name within the folder")
        expected = entry.get("bytes") if isinstance(entry, dict) else None
        path = folder / name
        size = path.stat().st_size if path.is_file() else "no file"
        require(size == expected, name, size, f"{expected} bytes, as the manifest says")


def _size(count: float) -> str:
    for unit in ("B", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} {unit}"
        count /= 1000
    return f"{count:.1f} GB"
