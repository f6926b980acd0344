"""A sweep under way as a file: which jobs it has, which are being done, and how they ended.

It lies beside the run folders, ``<output>/<experiment>/sweep-<jobs>-<process>.jsonl``, a line of
JSON for each thing that happened, and whoever does a job adds to it. The sweep's process holds its
lock as long as it lives. It goes when all runs are whole, and stays where some are left to do.
It is for those who look on only: no result, no state and no exit code comes from it.
"""

import fcntl
import hashlib
import json
import os
import platform
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gapath.store.durable import make_folder, named, open_regular
from gapath.store.runfolder import is_held, is_locked

_PATTERN = "sweep-*.jsonl"

_MOST, _MOST_LINES, _LONGEST = 1 << 26, 4 * 10**5, 1 << 23
"""Bytes and lines that are read of one, and bytes of a line."""

_OTHERS = (AttributeError, RecursionError)

BUSY = 75
"""Exit code of a job that another process is doing."""


def sweep_name(folders: Iterable[str]) -> str:
    """Name a sweep by its run folders: the same jobs, the same name."""
    digest = hashlib.sha256("\0".join(sorted(folders)).encode())
    return f"sweep-{digest.hexdigest()[:12]}"


def sweep_files(outputs: Path) -> list[Path]:
    """Find the files of sweeps below a folder of outputs, sorted by name."""
    return sorted(outputs.glob(f"*/{_PATTERN}"))


class SweepFile:
    """The file of a sweep of this process, which holds its lock until it is closed.

    Parameters
    ----------
    place : Path
        The experiment's folder.
    head : mapping
        Its first line: ``command``, ``jobs``, ``whole`` (so many of them were whole already) and
        ``folders``, those of all jobs.

    Raises
    ------
    InputError
        If it cannot be made.
    """

    def __init__(self, place: Path, head: Mapping[str, Any]) -> None:
        name = sweep_name(head["folders"])
        for earlier in place.glob(f"{name}-*.jsonl"):
            if not is_locked(earlier):
                earlier.unlink(missing_ok=True)
        self.path = place / f"{name}-{os.getpid()}.jsonl"
        with named(self.path):
            make_folder(place)
            self.path.unlink(missing_ok=True)
            flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
            self._file = os.open(self.path, flags, 0o666)
            with suppress(OSError):  # where nothing can be locked, each run says so itself
                fcntl.flock(self._file, fcntl.LOCK_EX)
            os.write(self._file, _line(dict(head)))

    def close(self, done: bool) -> None:
        """Let go of it; `done`: all runs are whole, and nobody needs it any more."""
        if done:
            self.path.unlink(missing_ok=True)
        os.close(self._file)


def tell(path: Path, **content: object) -> None:
    """Add a line to the file of a sweep; one that cannot be written is left out."""
    with suppress(OSError):
        file = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_NOFOLLOW)
        try:
            os.write(file, _line(content))
        finally:
            os.close(file)


def _line(content: dict[str, object]) -> bytes:
    return json.dumps({"at": time.time(), **content}).encode() + b"\n"


def _bounded(value: object) -> float:
    """Read a number of jobs or trials, an exit code or a time in seconds."""
    if not isinstance(value, int | float) or not 0 <= value <= 1 << 53:
        raise ValueError(value)
    return value


def host() -> str:
    """Name this machine, for who must know whether a process is one of it."""
    return platform.node()


@dataclass
class Standing:
    """Where a sweep stands, as its file tells it.

    The file is opened once, before any run looks which files are read (`gapath.store.inputs`).

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    OSError
        If it cannot be read.
    """

    path: Path
    command: str = ""
    jobs: int = 0
    whole: int = 0
    folders: list[str] = field(default_factory=list)
    began: float = 0.0
    running: dict[int, str] = field(default_factory=dict)
    """Jobs under way: number -> words."""
    codes: dict[int, int] = field(default_factory=dict)
    """Jobs that ended: number -> exit code."""
    trials: int = 0
    """Trials of the jobs that ended."""
    _rest: bytes = b""
    _bytes: int = _MOST
    _lines: int = _MOST_LINES

    def __post_init__(self) -> None:
        self._file = open_regular(self.path)

    def read(self) -> list[tuple[str, str]]:
        """Read what came since it was read last; gives what jobs said there, and their errors.

        The file may be anybody's: lines that are none are left out, and what is beyond `_MOST`
        bytes, `_MOST_LINES` or a line of `_LONGEST` bytes is not read.
        """
        said: list[tuple[str, str]] = []
        with suppress(OSError):
            while self._lines and (part := self._file.read(min(self._bytes, 1 << 20))):
                self._bytes -= len(part)
                *lines, self._rest = (self._rest + part).split(b"\n")
                for line in lines[: self._lines]:
                    with suppress(ValueError, TypeError, LookupError, ArithmeticError, *_OTHERS):
                        self._take(json.loads(line), said)
                self._lines -= min(len(lines), self._lines)
                if len(self._rest) > _LONGEST:
                    self._lines, self._rest = 0, b""
        return said

    def _take(self, line: dict[str, Any], said: list[tuple[str, str]]) -> None:
        if "command" in line:
            jobs, whole, began = (_bounded(line[name]) for name in ("jobs", "whole", "at"))
            folders = [str(name) for name in line["folders"]]
            self.command, self.folders = str(line["command"]), folders
            self.began = self.began or began  # more jobs may be told later
            self.jobs, self.whole = int(jobs), int(min(whole, jobs))
        elif "begun" in line:
            self.running[int(_bounded(line["begun"]))] = " ".join(map(str, line["words"]))
        elif "ended" in line:
            number, code, trials = (int(_bounded(line[n])) for n in ("ended", "code", "trials"))
            self.running.pop(number, None)
            self.codes[number] = code
            self.trials += trials
            out, err = line.get("said") or ("", "")
            said.append((str(out), str(err)))

    @property
    def alive(self) -> bool:
        """Whether the process of the sweep lives."""
        return is_held(self._file.fileno())

    @property
    def ended(self) -> int:
        """How many jobs need nothing more in this sweep."""
        return self.whole + len(self.codes)

    @property
    def failed(self) -> int:
        """How many jobs failed or were refused."""
        return sum(code not in (0, BUSY) for code in self.codes.values())

    @property
    def left(self) -> int:
        """How many runs are not whole, as far as this sweep knows."""
        return self.jobs - self.whole - sum(code == 0 for code in self.codes.values())

    def seconds_left(self) -> float | None:
        """Guess how long it takes from the jobs so far; None before the first ended."""
        if not self.codes:
            return None
        return (time.time() - self.began) / len(self.codes) * (self.jobs - self.ended)

    def counts(self) -> str:
        """Say how many jobs are how far."""
        busy = sum(code == BUSY for code in self.codes.values())
        parts = [f"{self.ended} of {self.jobs} jobs ended"]
        parts += [f"{self.whole} of them whole before"] if self.whole else []
        parts += [f"{self.failed} failed"] if self.failed else []
        parts += [f"{busy} done by another process"] if busy else []
        return ", ".join(parts)

    def unfinished(self) -> str:
        """Say of a sweep that has runs left that it is not finished, and how it goes on."""
        how = "it is under way" if self.alive else f"`{self.command}` goes on"
        return f"a sweep that is not finished: {self.counts()}, {self.left} runs are left; {how}"


def unfinished(outputs: Path) -> list[Standing]:
    """Read the sweeps below a folder of outputs that have runs left to do."""
    found = []
    for path in sweep_files(outputs):
        with suppress(OSError):
            found.append(Standing(path))
            found[-1].read()
    return [each for each in found if each.jobs and each.left]


def difference(earlier: str, now: str) -> str:
    """Say in which words one command differs from another; empty if in none."""
    was, is_now = earlier.split(), now.split()
    gone = " ".join(word for word in was if word not in is_now)
    new = " ".join(word for word in is_now if word not in was)
    return f"{gone or 'nothing'} where this has {new or 'nothing'}" if gone or new else ""
