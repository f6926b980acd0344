"""A run folder: named by a key, held by a lock, whole or not there.

Files carry ``.part`` until they are complete and durable; the manifest lists every file
with its SHA-256, and ``status.json`` says "done" last of all (`gapath.store.records`).
"""

import contextlib
import fcntl
import hashlib
import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gapath.errors import InputError
from gapath.store.durable import write_whole

LOCK = "run.lock"


class Busy(Exception):
    """Another process is working on the same run."""


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
        with self._named():
            self.path.mkdir(parents=True, exist_ok=True)
            (self.path / LOCK).touch()

    def create_parent(self) -> None:
        """Make the folder that it is to be in; raises InputError as `create` does."""
        with self._named():
            self.path.parent.mkdir(parents=True, exist_ok=True)

    @contextlib.contextmanager
    def _named(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            expected = f"a folder that can be written ({error.strerror})"
            raise InputError("output", self.path.parents[1], expected) from error

    @contextlib.contextmanager
    def lock(self) -> Iterator[None]:
        """Hold the folder; the system lets go of it if the process dies.

        Raises
        ------
        Busy
            If another process holds it.
        """
        with (self.path / LOCK).open("w") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                raise Busy(str(self.path)) from error
            yield

    def write_json(self, name: str, content: dict[str, Any]) -> None:
        """Write a JSON file, whole."""
        write_whole(self.path / name, (json.dumps(content, indent=2) + "\n").encode())

    def keep_only(self, names: Iterable[str]) -> None:
        """Remove all other files, which an earlier run left, once this one is whole."""
        kept = {LOCK, *names}
        for path in self.path.iterdir():
            if path.name not in kept and path.is_file():
                path.unlink()

    def sha256(self, name: str) -> str:
        """Hash a file: 64 hexadecimal digits."""
        with (self.path / name).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()


def is_locked(path: Path) -> bool:
    """Tell whether a living process holds a lock."""
    with contextlib.suppress(OSError), path.open("rb") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False
