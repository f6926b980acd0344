"""``gapath-log view``: one run, or two beside each other, in the Rerun viewer or in a browser."""

import argparse
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from urllib.parse import quote

from gapath.commands.viewing.told import told_trial
from gapath.errors import printable, require
from gapath.recorders import mcap
from gapath.store.durable import LAST, scratch

_LOCAL = "127.0.0.1"  # a viewer also serves; never to other machines

_VIEWER = "import sys; from rerun_cli.__main__ import main; sys.exit(main())"
"""Run as a module it would drop the viewer's exit code."""

_PATIENCE = 30.0
"""Seconds in which a viewer's servers are there, on a busy machine too."""


def view(given: list[Path], paths: list[Path], limits: mcap.Limits, web: bool) -> int:
    """Show the first trial of a log, a recording, or the first trials of two logs.

    Parameters
    ----------
    given : list of Path
        As they were typed.
    paths : list of Path
        The files that these are: a log or a recording, or two logs.
    limits : Limits
        What a log may take.
    web : bool
        In a browser.

    Returns
    -------
    int
        Exit code: 1 if there is no display, or the viewer failed.

    Raises
    ------
    InputError
        If a file cannot be shown.
    """
    require(len(paths) <= 2, "FILE", f"{len(paths)} files", "one, or two beside each other")
    for path in paths:
        require(path.is_file(), path, "no such file", "a log or a recording (.rrd)")
        good = path.suffix != ".rrd" or len(paths) == 1
        require(good, path, "a recording", "two logs, or runs with logs, to show two")
    if not web and not _has_display():
        return _complain(f"no display; see it in a browser: {_instead(given)}")
    with scratch() as folder:
        recording = paths[0] if paths[0].suffix == ".rrd" else _recorded(paths, limits, folder)
        code = _served(recording) if web else _shown(recording)
    if code:
        return _complain(
            f"the Rerun viewer failed with exit code {code}; see it in a browser: {_instead(given)}"
        )
    return 0


def add_web(parser: argparse.ArgumentParser) -> None:
    """Add the option that chooses a browser."""
    parser.add_argument(
        "--web", action="store_true", help=f"in a browser: serve it on {_LOCAL} until Control-C"
    )


def _complain(text: str) -> int:
    print(f"gapath-log: {printable(text)}", file=sys.stderr)
    return 1


def _instead(given: list[Path]) -> str:
    files = " ".join(map(str, given))
    picture = f", or make a picture: gapath-log picture {given[0]}"
    return f"gapath-log view --web {files}{picture if given[0].suffix != '.rrd' else ''}"


def _has_display() -> bool:
    return sys.platform != "linux" or any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY")))


def _recorded(paths: list[Path], limits: mcap.Limits, folder: Path) -> Path:
    from gapath.recorders.rerun.scenes import record_two, scene_of

    trials = [told_trial(path, 0, limits) for path in paths]
    if len(trials) == 2:
        return record_two((trials[0], trials[1]), folder)
    ((run, events),) = trials
    file = folder / "trial-0.rrd"
    file.write_bytes(scene_of(events).recording(run, events))
    return file


def _shown(recording: Path) -> int:
    """Open a recording in the viewer, and give its exit code."""
    with _viewer([str(recording)]) as viewer:
        return viewer.wait()


def _served(recording: Path) -> int:
    """Serve a recording to browsers on this machine until the command ends, or the server does."""
    data, page = _free_ports()
    options = ["--serve-web", "--port", str(data), "--web-viewer-port", str(page)]
    with _viewer([*options, str(recording)]) as server:
        until = time.monotonic() + _PATIENCE
        while not all(map(_listens, (data, page))):
            if server.poll() is not None or time.monotonic() > until:
                return server.poll() or 1
            time.sleep(0.1)
        source = quote(f"rerun+http://{_LOCAL}:{data}/proxy", safe="")
        print(f"http://{_LOCAL}:{page}/?url={source}", flush=True)
        print("open this address in a browser of this machine; Control-C ends it", flush=True)
        return server.wait()


def _free_ports() -> tuple[int, int]:
    with socket.socket() as one, socket.socket() as other:
        for each in (one, other):
            each.bind((_LOCAL, 0))
        return one.getsockname()[1], other.getsockname()[1]


def _listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex((_LOCAL, port)) == 0


@contextmanager
def _viewer(arguments: list[str]) -> Iterator["subprocess.Popen[bytes]"]:
    """Run Rerun's own command, which ends with this one."""
    command = [sys.executable, "-c", _VIEWER, "--bind", _LOCAL, *arguments]
    told = {"RUST_LOG": "error", **os.environ}  # it says much that is nobody's concern
    with subprocess.Popen(command, process_group=0, env=told) as viewer:

        def end() -> None:
            with suppress(ProcessLookupError):
                os.killpg(viewer.pid, signal.SIGTERM)  # also what that has started

        LAST.append(end)
        try:
            yield viewer
        finally:
            if viewer.poll() is None:
                end()
            LAST.remove(end)
