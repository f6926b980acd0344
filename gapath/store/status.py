"""How far a run is: ``status.json``, and how files of JSON are written and read."""

import hashlib
import json
import os
import threading
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import Any

from gapath.errors import InputError, require
from gapath.store.durable import LAST, open_regular, write_whole
from gapath.store.runfolder import LOCK, RunFolder, is_locked

STATUS = "status.json"

_EARLIER = {"state", "started", "finished", "message"}
"""All that a status of earlier versions says, which nothing vouches for."""

_CHECK = "sha256"

_MOST = 1 << 26  # bytes of a file of JSON


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


_STATES = {str(state): state for state in RunState}

WHOLE = (RunState.DONE, RunState.INFEASIBLE)
"""States of runs that were finished."""


@dataclass(frozen=True)
class Status:
    """How far a run is: ``status.json``, which vouches for itself and for the manifest.

    It holds a hash of itself, so that not a bit of it changes unnoticed.

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
    manifest : str
        SHA-256 of the manifest that it is of; empty of earlier versions.
    """

    state: RunState
    started: str
    finished: str | None = None
    message: str = ""
    manifest: str = ""

    def write(self, folder: RunFolder) -> None:
        """Write it, whole."""
        with TURN:
            write_whole(folder.path / STATUS, self.sealed())
            _under_way[:] = [(folder, self)] if self.state is RunState.RUNNING else []

    def sealed(self) -> bytes:
        """Give what stands in the file: the fields, and a hash of them."""
        return _sealed(asdict(self))

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
            data = contents(folder, STATUS)
            content = parsed(data, STATUS)
            earlier = content.pop(_CHECK, None) is None and set(content) <= _EARLIER
            whole = earlier or data == _sealed(content)
            require(whole, STATUS, "an altered file", "every byte as gapath wrote it")
        except InputError as error:
            return cls(RunState.UNKNOWN, "", message=str(error))
        given = content.get("state")
        state = _STATES.get(given, RunState.UNKNOWN) if isinstance(given, str) else RunState.UNKNOWN
        if state is RunState.RUNNING and not is_locked(folder / LOCK):
            state = RunState.INTERRUPTED
        names = ("started", "finished", "message", "manifest")
        started, finished, message, manifest = (str(content.get(name) or "") for name in names)
        return cls(state, started, finished or None, message.strip(), manifest)

    @property
    def date(self) -> str:
        """When it ended, else when it began."""
        return self.finished or self.started


TURN = threading.RLock()
"""Held by who says how a run ended: the run, or the signal that ends its process."""

_under_way: list[tuple[RunFolder, Status]] = []


def _interrupt() -> None:
    """Say that the run under way is interrupted; from now on it can say nothing else."""
    TURN.acquire()
    for folder, status in list(_under_way):
        with suppress(InputError):
            replace(status, state=RunState.INTERRUPTED, finished=now()).write(folder)


LAST.append(_interrupt)


def as_json(content: dict[str, Any]) -> bytes:
    """Give an object as it stands in a file of JSON."""
    return (json.dumps(content, indent=2) + "\n").encode()


def _sealed(content: dict[str, Any]) -> bytes:
    return as_json(content | {_CHECK: hashlib.sha256(as_json(content)).hexdigest()})


def contents(folder: Path, name: str, most: int = _MOST) -> bytes:
    """Read a small file of a folder; raises InputError if it cannot be read or is larger."""
    try:
        # As plain as can be, since a folder of runs has ten thousand of them.
        with open_regular(f"{folder}/{name}") as file:
            size = os.fstat(file.fileno()).st_size
            require(size <= most, name, f"{size} bytes", f"at most {most}, as gapath writes it")
            return file.read()
    except FileNotFoundError as error:
        raise InputError(name, "no file", "a file, as every finished run has one") from error
    except OSError as error:
        raise InputError(name, error.strerror, "a regular file that can be read") from error


def parsed(data: bytes, name: str) -> dict[str, Any]:
    """Take a file's content as an object of JSON; raises InputError if it is another thing."""
    try:
        content = json.loads(data.decode())
    except (ValueError, RecursionError) as error:
        raise InputError(name, type(error).__name__, "readable JSON") from error
    require(isinstance(content, dict), name, type(content).__name__, "a JSON object")
    found: dict[str, Any] = content
    return found


def now() -> str:
    """Give the time as ISO 8601 in UTC, to the millisecond: short runs stand in their order."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")
