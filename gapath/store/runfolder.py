"""A run folder: named by a key, held by a lock, and with a place for the run under way.

What a run writes lies in `WORK` within it until all of it is whole (`gapath.store.whole`).
"""

import contextlib
import fcntl
import hashlib
import os
import shutil
import stat
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from gapath.errors import InputError, require
from gapath.store.durable import make_folder, named, open_regular, sync_folder

LOCK = "run.lock"
"""The file whose lock (flock) a run holds."""

WORK = "run.part"
"""The folder of the run under way, or of one that was cut short, which the next run takes up."""

BEFORE = "run.before"
"""The folder of a run that was cut short, while another takes up what it did."""

PROGRESS = "trials.jsonl"
"""The file within `WORK` that says which trials were done."""

_PATIENCE = 10.0  # seconds for which looks at a lock may keep a run from it


class Busy(Exception):
    """Another process is working on the same run."""


@dataclass(frozen=True)
class RunFolder:
    """One run's folder, ``<output>/<experiment>/<key>``."""

    path: Path

    @property
    def work(self) -> "RunFolder":
        """The folder of the run under way."""
        return RunFolder(self.path / WORK)

    @property
    def before(self) -> "RunFolder":
        """The folder of a run that was cut short."""
        return RunFolder(self.path / BEFORE)

    def create(self) -> None:
        """Make the folder, durably.

        Raises
        ------
        InputError
            If it cannot be made, or a link has its name.
        """
        with self._named():
            make_folder(self.path)
        require(not self.path.is_symlink(), "output", self.path, "a folder of its own, not a link")

    def create_parent(self) -> None:
        """Make the folder that it is to be in; raises InputError as `create` does."""
        with self._named():
            make_folder(self.path.parent)

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
        InputError
            If it cannot be written, or its file system has no locks.
        """
        place = self.path / LOCK
        other = InputError(place, "a link, folder, pipe or device", "none, or a run's own file")
        with self._named():
            if os.path.lexists(place) and not stat.S_ISREG(os.lstat(place).st_mode):
                raise other
            flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK
            lock = os.open(place, flags, 0o666)
        try:
            if not stat.S_ISREG(os.fstat(lock).st_mode):
                raise other
            self._hold(lock)
            if not self._is_own(lock):
                raise Busy(str(self.path))
            yield
        finally:
            os.close(lock)

    def _is_own(self, lock: int) -> bool:
        """Tell whether a lock is still the folder's: who removes a run removes it, too."""
        with contextlib.suppress(OSError):
            return os.path.samestat(os.fstat(lock), (self.path / LOCK).lstat())
        return False

    def _hold(self, lock: int) -> None:
        """Take the lock; one that is only looked at (`is_locked`) is free in a moment."""
        end = time.monotonic() + _PATIENCE
        try:
            while not _taken(lock, fcntl.LOCK_EX):
                if time.monotonic() > end or not _taken(lock, fcntl.LOCK_SH):
                    raise Busy(str(self.path))
                fcntl.flock(lock, fcntl.LOCK_UN)
                time.sleep(0.001)
        except OSError as error:
            found = f"a file system that cannot lock a file ({error.strerror})"
            expected = "a folder on one with flock, such as a local disk"
            raise InputError("output", f"{self.path}, {found}", expected) from error

    def begin(self, kept: "RunFolder | None" = None) -> None:
        """Make the folder of the run under way anew; raises InputError if it cannot be.

        Parameters
        ----------
        kept : RunFolder or None
            `work` or `before`: stays, as `before`.
        """
        work = self.work.path
        self.clear(kept)
        with named(work):
            if kept == self.work:
                work.replace(self.before.path)
            work.mkdir()
            sync_folder(self.path)

    def clear(self, kept: "RunFolder | None" = None) -> None:
        """Remove `work` and `before` but `kept`; raises InputError if that cannot be done."""
        for folder in (self.before, self.work):
            with named(folder.path):
                if folder == kept:
                    continue
                if folder.path.is_dir() and not folder.path.is_symlink():
                    shutil.rmtree(folder.path)
                else:
                    folder.path.unlink(missing_ok=True)

    def sha256(self, name: str) -> str:
        """Hash a file: 64 hexadecimal digits; raises OSError unless it is regular and read."""
        with open_regular(self.path / name) as file:
            return hashlib.file_digest(file, "sha256").hexdigest()


def is_locked(path: Path) -> bool:
    """Tell whether a living process holds a lock.

    To look is to share it for a moment, which keeps no run from it: who finds a lock shared waits.
    To ask without that is only possible of other locks. Those of records (F_GETLK) a process loses
    as soon as it closes the file once more, as each look within it would; those of open files
    (F_OFD_GETLK) are Linux's own; /proc/locks lacks what other machines and containers hold.
    """
    with contextlib.suppress(OSError), open_regular(path) as lock:
        return is_held(lock.fileno())
    return False


def is_held(lock: int) -> bool:
    """Tell the same of a file that is open, and stays so; raises OSError if it has no locks."""
    if free := _taken(lock, fcntl.LOCK_SH):
        fcntl.flock(lock, fcntl.LOCK_UN)
    return not free


def _taken(lock: int, how: int) -> bool:
    try:
        fcntl.flock(lock, how | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
