"""What a run folder says of its run: manifest, status, settings; and which folders there are."""

import contextlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from enum import StrEnum
from functools import cached_property
from pathlib import Path
from typing import Any

from gapath.discovery import kinds
from gapath.errors import InputError, require
from gapath.events import Settings
from gapath.store.runfolder import LOCK, RunFolder, is_locked
from gapath.store.settings import Value, read_settings
from gapath.store.shape import shaped

STATUS, MANIFEST, CONFIG, TRIALS = "status.json", "manifest.json", "config.yaml", "trials.parquet"
"""Names of the files that every run folder has."""


class RunState(StrEnum):
    """How far a run is; SKIPPED (it is whole) and BUSY (another works on it) only of executions."""

    RUNNING = "running"
    DONE = "done"
    INFEASIBLE = "infeasible"
    FAILED = "failed"
    INTERRUPTED = "interrupted"
    UNKNOWN = "unknown"
    SKIPPED = "skipped"
    BUSY = "busy"


WHOLE = (RunState.DONE, RunState.INFEASIBLE)
"""States of runs that were finished."""


@dataclass(frozen=True)
class FileEntry:
    """A file of a run folder, as it was when the run was finished."""

    sha256: str
    bytes: int


@dataclass(frozen=True)
class Manifest:
    """What was run, and which files came of it: ``manifest.json``.

    Parameters
    ----------
    key : str
        Name of the folder: a hash of everything that the results depend on.
    setting : str
        A hash of what is tried, with whatever code and however often: of several runs that share
        it only the newest counts.
    experiment, task : str
        Their names.
    map : str
        Name of the map.
    map_instance : int
        Its number within a generated class.
    map_digest : str
        `gapath.grid.GridMap.digest`.
    start, target : str
        The fields "(x, y)" from which and to which.
    method : str
        Name of the planner or navigator for people: `preset`, and what differs from it.
    preset : str
        Name of its YAML.
    changes : mapping of str to str, int, float, bool or None
        Settings that differed from that YAML and from ``conf/config.yaml`` when it was run.
    seed, trials : int
        Trials 0 to trials - 1 use the random streams (seed, trial).
    command : str
        What does the same again.
    versions : mapping of str to str
        Versions of gapath and of what it stands on.
    map_inputs, method_inputs : mapping of str to str
        The files that the map and the method were made from: path -> SHA-256.
    late_inputs : mapping of str to str
        Those that were read only while trials ran: no part of what was tried, since a library may
        read them once a process, but the run is done anew where one has changed.
    files : mapping of str to FileEntry
        All files but the manifest and the status.
    """

    key: str
    setting: str
    experiment: str
    task: str
    map: str
    map_instance: int
    map_digest: str
    start: str
    target: str
    method: str
    preset: str
    changes: Mapping[str, Value]
    seed: int
    trials: int
    command: str
    versions: Mapping[str, str]
    map_inputs: Mapping[str, str]
    method_inputs: Mapping[str, str]
    late_inputs: Mapping[str, str]
    files: Mapping[str, FileEntry]

    def write(self, folder: RunFolder) -> None:
        """Write it, whole."""
        folder.write_json(MANIFEST, asdict(self))

    @classmethod
    def read(cls, folder: Path) -> "Manifest":
        """Read a folder's manifest.

        Parameters
        ----------
        folder : Path
            A run folder.

        Returns
        -------
        Manifest
            What it says.

        Raises
        ------
        InputError
            If it cannot be read, or something is missing, of another type or out of range.
        """
        found: Manifest = shaped(cls, _load(folder / MANIFEST), MANIFEST)
        known, task, trials, seed = kinds("task"), found.task, found.trials, found.seed
        require(task in known, f"{MANIFEST}, task", task, f"one of {', '.join(known)}")
        good = 1 <= trials <= 10**6
        require(good, f"{MANIFEST}, trials", trials, "an integer from 1 to 10^6")
        require(0 <= seed < 2**64, f"{MANIFEST}, seed", seed, "an integer in [0, 2^64)")
        where = f"{MANIFEST}, files"
        for name in found.files:
            require(Path(name).name == name, where, name, "a name within the folder")
        require(TRIALS in found.files, where, sorted(found.files), TRIALS)
        return found


@dataclass(frozen=True)
class Status:
    """How far a run is: ``status.json``, written last of all.

    Parameters
    ----------
    state : RunState
        running, done, failed, interrupted or infeasible; unknown where none can be read.
    started : str
        When it began, as `now` gives it.
    finished : str or None
        When it ended.
    message : str
        What went wrong.
    """

    state: RunState
    started: str
    finished: str | None = None
    message: str = ""

    def write(self, folder: RunFolder) -> None:
        """Write it, whole."""
        folder.write_json(STATUS, asdict(self))

    @classmethod
    def read(cls, folder: Path) -> "Status":
        """Read a folder's status.

        Parameters
        ----------
        folder : Path
            A run folder.

        Returns
        -------
        Status
            What it says; INTERRUPTED where a run says that it is running, but nobody holds its
            lock; UNKNOWN without one that can be read.
        """
        try:
            content = _load(folder / STATUS)
        except InputError as error:
            return cls(RunState.UNKNOWN, "", message=str(error))
        given = content.get("state")
        state = RunState(given) if given in list(RunState) else RunState.UNKNOWN
        if state is RunState.RUNNING and not is_locked(folder / LOCK):
            state = RunState.INTERRUPTED
        texts = [str(content.get(name) or "") for name in ("started", "finished", "message")]
        return cls(state, texts[0], texts[1] or None, texts[2].strip())

    @property
    def date(self) -> str:
        """When it ended, else when it began."""
        return self.finished or self.started


@dataclass(frozen=True)
class RunRecord:
    """A run folder, ``<outputs>/<experiment>/<key>/``, as it is found.

    Parameters
    ----------
    folder : Path
        The folder.
    status : Status
        How far it is.
    manifest : Manifest or None
        What was run; None if that cannot be read.
    fault : str
        Why the run cannot be used, empty if it can.
    """

    folder: Path
    status: Status
    manifest: Manifest | None
    fault: str

    @property
    def name(self) -> str:
        """The folder within the outputs: ``<experiment>/<key>``."""
        return f"{self.folder.parent.name}/{self.folder.name}"

    @property
    def state(self) -> RunState:
        """How far it is."""
        return self.status.state

    @property
    def date(self) -> str:
        """When it ended, else when it began."""
        return self.status.date

    @property
    def known(self) -> Manifest:
        """The manifest of a run that can be used."""
        assert self.manifest is not None, self.fault
        return self.manifest

    @cached_property
    def settings(self) -> Settings:
        """Its settings, flat; raises InputError if they cannot be read."""
        return read_settings(self.folder / CONFIG)

    @property
    def bytes(self) -> int:
        """Size of all its files."""
        total = 0
        for path in self.folder.iterdir():
            with contextlib.suppress(FileNotFoundError):  # a run at work renames its files
                total += path.stat().st_size
        return total


def read_record(folder: Path) -> RunRecord:
    """Read what a run folder says.

    Parameters
    ----------
    folder : Path
        A run folder.

    Returns
    -------
    RunRecord
        Its sizes of files are compared; hashing every log would take longer than reading it.
    """
    status = Status.read(folder)
    manifest, fault = None, ""
    try:
        manifest = Manifest.read(folder)
        for name, entry in sorted(manifest.files.items()):
            path = folder / name
            size = path.stat().st_size if path.is_file() else "no file"
            require(size == entry.bytes, name, size, f"{entry.bytes} bytes, as the manifest says")
    except InputError as error:
        fault = str(error)
    if status.state not in WHOLE:
        reason = status.message.splitlines()[-1] if status.message else ""
        fault = status.state + (f": {reason}" if reason else "")
    return RunRecord(folder, status, manifest, fault)


def is_run(folder: Path) -> bool:
    """Tell whether a folder is that of a run, whole or not."""
    return any((folder / mark).exists() for mark in (STATUS, MANIFEST, CONFIG, TRIALS))


def find_runs(outputs: Path) -> list[RunRecord]:
    """Find the run folders below a folder, sorted by experiment and key.

    Parameters
    ----------
    outputs : Path
        The folder that holds ``<experiment>/<key>/``.

    Returns
    -------
    list of RunRecord
        All of them, also those that cannot be used.

    Raises
    ------
    InputError
        If there is no such folder, or no run in it.
    """
    require(outputs.is_dir(), outputs, "no such folder", "a folder with run folders")
    try:
        folders = sorted(path for path in outputs.glob("*/*") if is_run(path))
        runs = [read_record(path) for path in folders]
    except OSError as error:
        raise InputError(error.filename or outputs, error.strerror, "readable folders") from error
    require(bool(runs), outputs, "no runs", "run folders <experiment>/<key>/; `gapath` makes them")
    return runs


def _load(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise InputError(path.name, "no file", "a file, as every finished run has one") from error
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(path.name, type(error).__name__, "readable JSON") from error
    require(isinstance(content, dict), path.name, type(content).__name__, "a JSON object")
    loaded: dict[str, Any] = content
    return loaded


def now() -> str:
    """Give the time as ISO 8601 in UTC, to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")
