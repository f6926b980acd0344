"""A run of a few milliseconds, and system calls of its folder that fail or are the last."""

import errno
import io
import os
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from gapath.components import build
from gapath.discovery import yaml_values
from gapath.grid import GridMap
from gapath.problem import Problem
from gapath.running import config
from gapath.running.naming import Method
from gapath.store.settings import flatten
from gapath.tasks.plan import Task


def small_run(output, force=False, recorders=("mcap",), **changes):
    """A* on a map of 10 x 10 fields, three trials."""
    weights = np.zeros((10, 10))
    weights[2:8, 5] = 1.0
    grid = GridMap("small", weights, (0, 0), (9, 9))
    settings = yaml_values("planner", "astar")
    given = {"task": "plan", "planner": settings, "trials": 3, **changes}
    return config.Run(
        "small", Method("astar"), Problem(grid, (0, 0), (9, 9)),
        Task(build("planner", settings, "planner")),
        [build("recorder", yaml_values("recorder", name), name) for name in recorders],
        11, given["trials"], flatten(given), str(output), force,
    )  # fmt: skip


_NAMES = ("replace", "mkdir", "unlink", "rmdir")
_LEFT_OUT = {"late": ("open", "write", "unlink"), "short": (*_NAMES, "open", "fsync")}


class Calls:
    """Counts the system calls that change a folder; the n-th one has a fault."""

    def __init__(self, place, n, fault):
        self.place, self.n, self.fault = os.fspath(place), n, fault
        self.count = 0
        self.files = set()

    def happens(self, call, path=""):
        """Count a call; give whether it fails after it was done, or half of it."""
        if call in _LEFT_OUT.get(self.fault, ()):
            return False
        self.count += 1
        if self.count != self.n:
            return False
        self.what = f"{call} {path}"
        if self.fault in ("late", "short"):
            return True
        self.fail(self.fault)
        return False

    def fail(self, fault):
        if fault == "kill":
            os._exit(9)
        number = getattr(errno, fault, errno.EIO)
        raise OSError(number, os.strerror(number))

    def concerns(self, path, given):
        found = os.fspath(path) if isinstance(path, str | Path) else ""
        return found.startswith(self.place) or "dir_fd" in given

    def wrapped(self, name, system):
        def call(path, *others, **given):
            if not self.concerns(path, given):
                return system(path, *others, **given)
            late = self.happens(name, path)
            result = system(path, *others, **given)
            if late:
                self.fail("EIO")
            return result

        return call


class Raw(io.FileIO):
    """A file whose writes are counted."""

    calls: Calls

    def write(self, data):
        late = self.calls.happens("write")
        if late:  # half of it, then no more
            super().write(bytes(data[: len(data) // 2]))
            self.calls.fail("ENOSPC")
        return super().write(data)


@contextmanager
def calls(monkeypatch, place, n=0, fault="ENOSPC"):
    """Have the n-th system call that changes a folder fail.

    `fault`: an errno; "late", which fails with EIO although it was done; "short", which writes
    half; "kill", which ends the process before the call.
    """
    told = Calls(place, n, fault)
    opened, fdopen = os.open, os.fdopen

    def open_(path, flags, *others, **given):
        writes = flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
        if writes and told.concerns(path, given):
            told.happens("open", path)
        file = opened(path, flags, *others, **given)
        if told.concerns(path, given):
            told.files.add(file)
        return file

    def fdopen_(file, mode="r", *others, **given):
        if file not in told.files or "w" not in mode:
            return fdopen(file, mode, *others, **given)
        raw = Raw(file, "w")
        raw.calls = told
        return io.BufferedWriter(raw)

    def fsync(file):  # takes no time
        if told.happens("fsync"):
            told.fail("EIO")

    with monkeypatch.context() as patch:
        patch.setattr("os.open", open_)
        patch.setattr("os.fdopen", fdopen_)
        patch.setattr("os.fsync", fsync)
        for name in _NAMES:
            patch.setattr(f"os.{name}", told.wrapped(name, getattr(os, name)))
        yield told
