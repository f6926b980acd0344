"""The ``gapath-log`` command: look into a log, check it, save it, show it."""

import argparse
import dataclasses
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

import gapath
from gapath.errors import InputError, require
from gapath.events import (
    Event,
    Finished,
    RunFinished,
    RunStarted,
    Stepped,
)
from gapath.recorders import mcap
from gapath.recorders.mcap import FILE
from gapath.store.durable import part_of
from gapath.store.records import MANIFEST, read_record
from gapath.store.runfolder import WORK
from gapath.store.settings import text_of
from gapath.task import find_task

_LOCAL = "127.0.0.1"  # a viewer also serves; never to other machines


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the program's name; those of the process if not given.

    Returns
    -------
    int
        Exit code: 0 for success, 1 if a log is not reproduced or the viewer failed, 2 for
        bad input, also of one log among several.
    """
    arguments = _parser().parse_args(argv)
    try:
        code = int(arguments.run(arguments))
        sys.stdout.flush()  # here, where a closed pipe is no error
        return code
    except BrokenPipeError:  # the reader of a pipe, such as `head`, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except (InputError, OSError) as error:
        return _complain(error)


def _complain(error: Exception) -> int:
    print(f"gapath-log: {' '.join(str(error).split())}", file=sys.stderr)
    return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="gapath-log",
        description=f"Look into the log of a run ({FILE}) and work with it. Where a FILE is "
        "read, the folder of a run or its manifest will do, too.",
    )
    parser.add_argument("--version", action="version", version=f"gapath-log {gapath.__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def command(name: str, run: Any, text: str, many: bool = False) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=text, description=f"{text[0].upper()}{text[1:]}.")
        given = ("files", "+") if many else ("file", None)
        about = f"a log, such as {FILE}"
        sub.add_argument(given[0], nargs=given[1], type=Path, metavar="FILE", help=about)
        sub.set_defaults(run=run)
        return sub

    command("info", _info, "say what a log holds, and whether it is whole")
    compare = "run logs again and compare every event; exit code 1 if one differs"
    verify = command("verify", _verify, compare, many=True)
    verify.add_argument(
        "--kernels", default="auto", metavar="NAME",
        help="which kernels compute, such as scalar; the events are the same (default: auto)",
    )  # fmt: skip
    salvage = command("salvage", _salvage, f"save what a killed run left ({part_of(Path(FILE))})")
    salvage.add_argument(
        "-o", dest="output", type=Path, metavar="OUT",
        help="the log to write (default: FILE without .part, or with .salvaged before .mcap)",
    )  # fmt: skip
    rerun = command("rerun", _rerun, "make Rerun recordings (trial-<n>.rrd) from a log")
    rerun.add_argument(
        "--trials", type=_trials, default=[0], metavar="N,N", help="which trials (default: 0)"
    )
    rerun.add_argument(
        "-o", dest="folder", type=Path, metavar="DIR", help="where to (default: beside FILE)"
    )
    command("view", _view, "open a log's first trial, or a recording (.rrd), in the Rerun viewer")
    return parser


def _trials(text: str) -> list[int]:
    try:
        return [int(number) for number in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"got {text!r}, expected numbers such as 0,3") from None


def _log_of(path: Path) -> Path:
    """Give the log that a file is, or that a run has whose folder or manifest it is."""
    folder = path.parent if path.name == MANIFEST else path
    if not folder.is_dir():
        return path
    log, run = folder / FILE, read_record(folder)
    part = part_of(folder / WORK / FILE)
    rest = f"; what is left: gapath-log salvage {part}" if part.is_file() else ""
    require(not run.fault, path, run.fault, f"a log, or the folder of a run that is whole{rest}")
    require(FILE in run.known.files, path, "a run without a log", "one with recorder=mcap")
    return log


def _info(arguments: argparse.Namespace) -> int:
    path = _log_of(arguments.file)
    try:
        run, ended, finished = _summary(mcap.read_events(path))
        state = "whole" if ended else "whole, but the run was interrupted"
    except InputError as error:
        run, ended, finished = _summary(mcap.read_prefix(path))
        state = f"cut off or damaged ({error.value}); save the rest: gapath-log salvage {path}"
    task, problem, grid = find_task(run.task), run.problem, run.problem.map
    ends = ", ".join(f"{count} {end}" for end, count in finished.items())
    rows = {
        "file": f"{path}, {path.stat().st_size} bytes",
        "state": state,
        "experiment": run.experiment,
        "task": run.task,
        task.groups[0]: run.method,
        "map": f"{grid.name}, instance {grid.instance}, {grid.cols} x {grid.rows} fields of "
        f"{grid.resolution:g} m ({grid.source})",
        "problem": f"{problem.told}, corner cutting: {problem.corner_cutting.name.lower()}",
        **task.told_optimum(run),
        "seed": str(run.seed),
        "trials": f"{finished.total()} of {run.trials}" + (f": {ends}" if ends else ""),
        "versions": ", ".join(f"{name} {version}" for name, version in run.versions.items()),
    }
    for name, value in rows.items():
        print(f"{name + ':':14}{value}")
    print("messages:")
    for topic, count in sorted(mcap.count_messages(path).items()):
        print(f"  {topic:14}{count}")
    print("settings:")
    for line in text_of(run.settings).splitlines():
        print(f"  {line}")
    return 0


def _summary(events: Iterator[Event]) -> tuple[RunStarted, bool, Counter[str]]:
    """Give the first event, whether the run came to its end, and how its trials ended."""
    run, last = next(events), None
    assert isinstance(run, RunStarted), "the reader gives it first"
    finished: Counter[str] = Counter()
    for last in events:
        if isinstance(last, Finished):
            finished[last.ending] += 1
    return run, isinstance(last, RunFinished), finished


def _salvage(arguments: argparse.Namespace) -> int:
    path = arguments.file
    place = path.parent.parent if path.parent.name == WORK else path.parent  # the next run empties
    name = path.stem if path.suffix == ".part" else f"{path.stem}.salvaged.mcap"
    output = arguments.output or place / name
    count = mcap.salvage(path, output)
    print(f"{output}: {count} events saved and read back")
    return 0


def _verify(arguments: argparse.Namespace) -> int:
    return max([_verified(path, arguments.kernels) for path in arguments.files])


def _verified(path: Path, kernels: str) -> int:
    """Verify a log, say in a line what came of it, and give the exit code."""
    try:
        code, found = _compared(_log_of(path), kernels)
    except (InputError, OSError) as error:
        return _complain(error)
    print(f"{path}: {found}", flush=True)
    return code


def _compared(path: Path, kernels: str) -> tuple[int, str]:
    from gapath.running.experiment import replay_events  # compiles kernels: only where it is needed

    logged = mcap.read_events(path)
    run = next(logged)
    assert isinstance(run, RunStarted), "the reader gives it first"
    count, last = 0, None
    for old, new in zip_longest(logged, replay_events(run, kernels)):
        if old is None and not isinstance(last, RunFinished):
            return 0, f"reproduced, {count} events are equal; the run was interrupted after them"
        found = difference(old, new, _where(old or new))
        if found:
            return 1, f"differs after {count} equal events: {found}"
        count, last = count + 1, old
    return 0, f"reproduced, {count} events are equal"


def _where(event: Any) -> str:
    trial = f"trial {event.trial}, " if hasattr(event, "trial") else ""
    return f"{trial}step {event.step}, {type(event).__name__}"


def difference(logged: Any, again: Any, where: str) -> str | None:
    """Name the first thing in which two events differ.

    Parameters
    ----------
    logged, again : event, or part of one
        What is compared; NaN equals NaN. Wall time is not in a log, so it is left out.
    where : str
        Name of the part.

    Returns
    -------
    str or None
        Which part differs and its two values; None if nothing does.
    """
    if type(logged) is not type(again):
        return f"{where}: {_short(logged)} in the log, {_short(again)} now"
    if dataclasses.is_dataclass(logged):
        names: Iterable[str] = (field.name for field in dataclasses.fields(logged))
        names = (name for name in names if (type(logged), name) != (Stepped, "seconds"))
        return _first_difference(names, logged, again, where)
    if isinstance(logged, tuple) and hasattr(logged, "_fields"):
        return _first_difference(logged._fields, logged, again, where)
    if isinstance(logged, np.ndarray):
        if logged.shape != again.shape:
            return f"{where}: shape {logged.shape} in the log, {again.shape} now"
        differs = (logged != again) & ((logged == logged) | (again == again))
        if not differs.any():
            return None
        index = tuple(map(int, np.argwhere(differs)[0]))
        return f"{where}{list(index)}: {logged[index]} in the log, {again[index]} now"
    if logged == again or (logged != logged and again != again):
        return None
    return f"{where}: {_short(logged)} in the log, {_short(again)} now"


def _first_difference(names: Iterable[str], logged: Any, again: Any, where: str) -> str | None:
    found = (difference(getattr(logged, n), getattr(again, n), f"{where}.{n}") for n in names)
    return next(filter(None, found), None)


def _short(value: Any) -> str:
    if value is None:
        return "nothing"
    return type(value).__name__ if dataclasses.is_dataclass(value) else repr(value)


def _rerun(arguments: argparse.Namespace) -> int:
    path = _log_of(arguments.file)
    folder = arguments.folder or path.parent
    folder.mkdir(parents=True, exist_ok=True)
    for name in _record(path, arguments.trials, folder):
        print(folder / name)
    return 0


def _record(path: Path, trials: list[int], folder: Path) -> list[str]:
    """Make recordings of trials from a log; give their names within the folder."""
    from gapath.recorders.rerun import Recorder

    recorder = Recorder(trials=trials)
    recorder.open(str(folder))
    try:
        for event in mcap.read_events(path):
            recorder.record(event)
    except BaseException:
        recorder.abort()
        raise
    names = recorder.close()
    require(
        len(names) == len(set(trials)), path, f"{len(names)} of the trials", "a log of all of them"
    )
    return names


def _view(arguments: argparse.Namespace) -> int:
    path = _log_of(arguments.file)
    require(path.is_file(), path, "no such file", "a log or a recording (.rrd)")
    with tempfile.TemporaryDirectory() as folder:
        if path.suffix != ".rrd":
            path = Path(folder) / _record(path, [0], Path(folder))[0]
        code = subprocess.run(
            [sys.executable, "-m", "rerun_cli", "--bind", _LOCAL, str(path)], check=False
        ).returncode
    if code:
        print(
            f"gapath-log: the Rerun viewer ended with code {code}; it needs a display. "
            f"Make a recording with 'gapath-log rerun' and show it in a browser: "
            f"rerun --serve-web --bind {_LOCAL} trial-0.rrd",
            file=sys.stderr,
        )
    return 1 if code else 0


if __name__ == "__main__":
    sys.exit(main())
