"""Real disks that are full: what libraries write by themselves has no room either."""

import ctypes
import json
import os
import shutil
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest
from scale import rounds

_USER, _MOUNTS, _REMOUNT = 0x1000_0000, 0x2_0000, 32  # of <sched.h> and <sys/mount.h>
ROOM = 64 << 10  # kB
RUN = [
    "gapath",
    "map=kg18_test1",
    "planner=ga1",
    "planner.max_epochs=60",
    "trials=4",
    "output=DISK",
]
COMMANDS = {
    "rows": [*RUN, "recorder=none"],
    "log": [*RUN, "recorder=mcap"],
    "recordings": [*RUN, "recorder=rerun", "recorder.rerun.trials=[0,3]"],
    "both": [*RUN, "recorder=[mcap,rerun]"],
    "report": ["gapath-report", "OUTPUTS", "-o", "DISK/report"],
    "recording of a log": ["gapath-log", "rerun", "LOG", "-o", "DISK"],
    "log saved": ["gapath-log", "salvage", "LOG", "-o", "DISK/saved.mcap"],
}


class Disk:
    """A disk in memory of so many kB, that this process alone has, which may have one thread only.

    So nothing may be imported before that starts threads, as NumPy does.
    """

    def __init__(self, path):
        self.path, self._libc = path, ctypes.CDLL(None, use_errno=True)
        ids = os.getuid(), os.getgid()
        self._call("unshare", _USER | _MOUNTS)
        Path("/proc/self/setgroups").write_text("deny")
        for name, number in zip(("uid_map", "gid_map"), ids, strict=True):
            Path(f"/proc/self/{name}").write_text(f"0 {number} 1")
        self._mount(ROOM, 0)

    def _call(self, name, *given):
        if getattr(self._libc, name)(*given):
            raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))

    def _mount(self, room, flags):
        path, size = os.fsencode(self.path), f"size={room}k".encode()
        self._call("mount", b"none", path, b"tmpfs", flags, size)

    def resize(self, room):
        self._mount(room, _REMOUNT)

    def clear(self):
        for path in self.path.iterdir():
            shutil.rmtree(path) if path.is_dir() else path.unlink()

    @property
    def used(self):
        found = os.statvfs(self.path)
        return (found.f_blocks - found.f_bfree) * found.f_bsize >> 10


@contextmanager
def told(place):
    """Have all that is written to standard output and error, by libraries also, in files."""
    kept = [os.dup(number) for number in (1, 2)]
    files = place / "output", place / "errors"
    try:
        for number, path in enumerate(files, 1):
            os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
        yield files
    finally:
        sys.stdout.flush()
        for number, file in enumerate(kept, 1):
            os.dup2(file, number)


def called(words, place):
    """Run a command in this process; give its exit code and what it said."""
    from gapath.commands import log, run
    from gapath.pipelines.report import cli

    script, *arguments = words
    with told(place) as files:
        try:
            if script == "gapath":
                sys.argv = words
                code = run.main() or 0
            else:
                code = (log if script == "gapath-log" else cli).main(arguments)
        except SystemExit as stop:
            code = stop.code or 0
    return code, *(path.read_text() for path in files)


def main(place, parts, *names):
    """Do commands on disks of several sizes; print a line of JSON for each."""
    outputs, place = place / "outputs", place / "disk"
    place.mkdir()
    try:
        disk = Disk(place)
    except OSError as error:
        print(json.dumps(str(error)))
        return
    called([word.replace("DISK", str(outputs)) for word in COMMANDS["log"]], place.parent)
    known = {"DISK": place, "OUTPUTS": outputs, "LOG": next(outputs.rglob("run.mcap"))}
    for name in names:
        words = COMMANDS[name]
        for short, path in known.items():
            words = [word.replace(short, str(path)) for word in words]
        first = called(words, place.parent)
        need = disk.used
        for room in sorted({max(4, need * part // parts // 4 * 4) for part in range(parts)}):
            disk.clear()
            disk.resize(room)
            full = called(words, place.parent)
            disk.resize(ROOM)
            print(json.dumps([name, room, first, full, called(words, place.parent)]), flush=True)
        disk.clear()


def test_a_full_disk_is_a_line_and_with_room_all_goes_on(tmp_path):
    names = rounds(["both", "log saved"], [*COMMANDS])
    words = (tmp_path, rounds(2, 1000), *names)
    done = subprocess.run(
        [sys.executable, __file__, *map(str, words)], capture_output=True, text=True, check=True
    )
    told = [json.loads(line) for line in done.stdout.splitlines()]
    if isinstance(told[0], str):
        pytest.skip(f"no disk of its own for a process: {told[0]}")
    for name, room, first, (code, out, line), again in told:
        assert (code, out, line.count("\n")) == (2, "", 1), (name, room, line)
        assert f"{tmp_path}/disk" in line and "No space left on device" in line, (name, room, line)
        assert (again[0], again[1].splitlines()[-1:]) == (0, first[1].splitlines()[-1:]), name
    print(f"{len(told)} disks too small for {len(names)} commands: a line each, all went on")
    assert {name for name, *_ in told} == {*names}


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:])
