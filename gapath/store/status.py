"""How far a run is: ``status.json``, and how files of JSON are read."""

import json
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import Any

from gapath.errors import InputError, require
from gapath.store.runfolder import LOCK, RunFolder, is_locked

STATUS = "status.json"


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
            content = load(folder, STATUS)
        except InputError as error:
            return cls(RunState.UNKNOWN, "", message=str(error))
        given = content.get("state")
        state = _STATES.get(given, RunState.UNKNOWN) if isinstance(given, str) else RunState.UNKNOWN
        if state is RunState.RUNNING and not is_locked(folder / LOCK):
            state = RunState.INTERRUPTED
        texts = [str(content.get(name) or "") for name in ("started", "finished", "message")]
        return cls(state, texts[0], texts[1] or None, texts[2].strip())

    @property
    def date(self) -> str:
        """When it ended, else when it began."""
        return self.finished or self.started


def load(folder: Path, name: str) -> dict[str, Any]:
    """Read an object of JSON; raises InputError if it cannot be read or is another thing."""
    try:
        # As plain as can be, since a folder of runs has ten thousand of them.
        with open(f"{folder}/{name}", "rb", buffering=0) as file:  # noqa: PTH123
            content = json.loads(file.read().decode())
    except FileNotFoundError as error:
        raise InputError(name, "no file", "a file, as every finished run has one") from error
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(name, type(error).__name__, "readable JSON") from error
    require(isinstance(content, dict), name, type(content).__name__, "a JSON object")
    loaded: dict[str, Any] = content
    return loaded


def now() -> str:
    """Give the time as ISO 8601 in UTC, to the millisecond: short runs stand in their order."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")
