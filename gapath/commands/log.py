"""The ``gapath-log`` command: look into a log, check it, save it, show it."""

import argparse
import os
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import gapath
from gapath.commands import crate
from gapath.commands.viewing import drawing, viewer
from gapath.commands.viewing.told import path_rows
from gapath.errors import InputError, few, printable, require, require_extra
from gapath.events import Event, Finished, RunFinished, RunStarted
from gapath.recorders import mcap
from gapath.recorders.mcap import FILE
from gapath.store.durable import part_of
from gapath.store.records import MANIFEST, find_run, is_run, read_record
from gapath.store.runfolder import WORK
from gapath.store.settings import text_of
from gapath.task import find_task

SWEEP = "multirun.yaml"
"""What Hydra leaves beside the runs of a sweep."""


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
        bad input, 3 if a log is equal as far as it goes; of several logs the largest. Of a crate
        that is done again see `gapath.commands.crate`.
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
    print(f"gapath-log: {printable(' '.join(str(error).split()))}", file=sys.stderr)
    return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="gapath-log",
        description=f"Look into the log of a run ({FILE}) and work with it. Where a FILE is "
        "read, the run's key will do, too, its beginning, its folder or its manifest.",
    )
    parser.add_argument("--version", action="version", version=f"gapath-log {gapath.__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def command(name: str, run: Any, text: str, many: bool = False) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=text, description=f"{text[0].upper()}{text[1:]}.")
        given = ("files", "+") if many else ("file", None)
        about = f"a log, such as {FILE}, or a run"
        sub.add_argument(given[0], nargs=given[1], type=Path, metavar="FILE", help=about)
        crate.add_outputs(sub)
        sub.add_argument("--large", action="store_true", help="read one that is unusually large")
        sub.set_defaults(run=run)
        return sub

    command("info", _info, "say what a log holds, and whether it is whole")
    compare = "run logs again, write them anew and compare; exit code 1 if one differs"
    verify = command("verify", _verify, compare, many=True)
    verify.add_argument("--yes", action="store_true", help="also if it takes long")
    verify.add_argument(
        "--kernels", default="auto", metavar="NAME",
        help="which kernels compute, such as scalar; the log is the same (default: auto)",
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
    bag = command("bag", _bag, "make a bag of ROS 2 from a log in which epochs and the robot move")
    bag.add_argument("folder", type=Path, metavar="DIR", help="the bag, a new folder")
    bag.add_argument(
        "--trials", type=_trials, default=[0], metavar="N,N", help="which trials (default: 0)"
    )
    about = "seconds that a step or an epoch takes (default: 0.1)"
    bag.add_argument("--step-s", type=float, default=0.1, metavar="S", help=about)
    text = "write gapath_msgs, the definitions of a log's messages, as a package of ROS 2"
    messages = commands.add_parser("messages", help=text, description=f"{text.capitalize()}.")
    messages.add_argument("folder", type=Path, metavar="DIR", help="the package, a new folder")
    messages.set_defaults(run=_messages)
    crate.add(commands)
    opened = (
        "open a log's first trial, those of two logs, or a recording (.rrd), in the Rerun viewer"
    )
    viewer.add_web(command("view", _view, opened, many=True))
    path = command("path", _path, "print the path of a trial: a field a line, x,y in metres")
    drawing.add_trial(path)
    picture = command("picture", _picture, "draw a trial, or one step of it, from a log: a PNG")
    drawing.add_options(picture, "the PNG to write (default: beside FILE)")
    step = "a drive's step, a plan's epoch (default: how it ended)"
    picture.add_argument("--step", type=int, metavar="N", help=step)
    movie = command("movie", _movie, "draw a trial as a movie, from a log")
    drawing.add_options(
        movie, "a .webp, .gif or .mp4, that with ffmpeg (default: .webp beside FILE)"
    )
    return parser


def _limits(arguments: argparse.Namespace) -> mcap.Limits:
    return mcap.LARGE if arguments.large else mcap.USUAL


def _trials(text: str) -> list[int]:
    try:
        return [int(number) for number in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"got {text!r}, expected numbers such as 0,3") from None


def _log_of(path: Path, arguments: argparse.Namespace) -> Path:
    """Give the log that a file is, or that a run has which is named (`find_run`)."""
    for folder in (path, arguments.outputs / path):
        runs = folder.is_dir() and not is_run(folder) and any(map(is_run, folder.iterdir()))
        require(not runs, path, "an experiment", f"one of its runs, a folder in {folder}")
    is_named = path.is_dir() or path.name == MANIFEST or (_is_key(path) and not path.exists())
    if not is_named:
        return path
    folder = find_run(arguments.outputs, str(path))
    log, run = folder / FILE, read_record(folder)
    part = part_of(folder / WORK / FILE)
    rest = f"; what is left: gapath-log salvage {part}" if part.is_file() else ""
    require(not run.fault, path, run.fault, f"a log, or the folder of a run that is whole{rest}")
    require(FILE in run.known.files, path, "a run without a log", "one with recorder=mcap")
    return log


def _is_key(path: Path) -> bool:
    """Tell whether it reads like a run's key, alone or behind an experiment's name."""
    return re.fullmatch(r"([\w-]+/)?[0-9a-f]{1,16}", str(path)) is not None


def _info(arguments: argparse.Namespace) -> int:
    path = _log_of(arguments.file, arguments)
    messages: Counter[str] = Counter()
    run, ended, finished, fault = _summary(mcap.look(path, _limits(arguments), messages))
    state = "whole" if ended else "whole, but the run was interrupted"
    if fault is not None:
        state = f"cut off or damaged ({fault}); save the rest: gapath-log salvage {path}"
    task, problem, grid = find_task(run.task), run.problem, run.problem.map
    ends = ", ".join(f"{len(trials)} {end}" for end, trials in finished.items())
    done = sum(map(len, finished.values()))
    rare = [end for end, trials in finished.items() if 2 * len(trials) <= done]
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
        "trials": f"{done} of {run.trials}" + (f": {ends}" if ends else ""),
        **{end: f"trial {few(finished[end])}" for end in rare},
        "versions": ", ".join(f"{name} {version}" for name, version in run.versions.items()),
    }
    for name, value in rows.items():
        print(f"{name + ':':13} {printable(value)}")
    print("messages:")
    for topic, count in sorted(messages.items()):
        print(f"  {topic:14}{count}")
    print("settings:")
    for line in text_of(run.settings).splitlines():
        print(f"  {printable(line)}")
    return 0


def _summary(
    events: Iterator[Event],
) -> tuple[RunStarted, bool, dict[str, list[int]], InputError | None]:
    """Give the first event, whether the run came to its end, trials by their end, what is wrong.

    Raises InputError if nothing is whole.
    """
    run, last, finished = next(events), None, defaultdict[str, list[int]](list)
    assert isinstance(run, RunStarted), "the reader gives it first"
    try:
        for last in events:
            if isinstance(last, Finished):
                finished[last.ending].append(last.trial)
    except InputError as error:
        return run, False, finished, error
    return run, isinstance(last, RunFinished), finished, None


def _salvage(arguments: argparse.Namespace) -> int:
    path = arguments.file
    if path.is_dir() or (_is_key(path) and not path.exists()):
        path = part_of(find_run(arguments.outputs, str(path)) / WORK / FILE)
    place = path.parent.parent if path.parent.name == WORK else path.parent  # the next run empties
    name = path.stem if path.suffix == ".part" else f"{path.stem}.salvaged.mcap"
    output = arguments.output or place / name
    messages, lost = mcap.salvage(path, output, _limits(arguments))
    print(printable(f"{output}: {messages} messages saved and read back{_lacking(lost)}"))
    return 0


def _lacking(lost: mcap.Lost) -> str:
    """Say which messages are missing in a log that was saved, and which trials are not whole."""
    if not lost.messages:
        return ""
    parts = {"messages": [f"{first}-{last}" for first, last in lost.messages]}
    parts["not whole, so left out: trials"] = [str(trial) for trial in sorted(lost.trials)]
    told = [f"{name} {few(all_of)}" for name, all_of in parts.items() if all_of]
    return f"; lost: {'; '.join(told)}"


def _verify(arguments: argparse.Namespace) -> int:
    given = [path for path in arguments.files if path.name != SWEEP]  # it lies among a sweep's runs
    return max([_verified(path, arguments) for path in given or arguments.files])


def _verified(path: Path, arguments: argparse.Namespace) -> int:
    """Verify a log, say in a line what came of it, and give the exit code."""
    try:
        code, found = _compared(_log_of(path, arguments), arguments)
    except (InputError, OSError) as error:
        return _complain(error)
    print(printable(f"{path}: {found}"), flush=True)
    return code


def _compared(path: Path, arguments: argparse.Namespace) -> tuple[int, str]:
    from gapath.running.verify import made_with, verify  # compiles: only where it is needed

    found, others, remarks = verify(path, _limits(arguments), arguments.kernels, arguments.yes)
    count = f"{found.messages} messages"
    if found.difference:
        return 1, f"differs after {count} that are equal: {found.difference}"
    if found.byte is not None and not others:
        return 1, f"differs from byte {found.byte} on, though all of its {count} are equal"
    level = "byte for byte" if found.byte is None else "every message"
    rest = f"its last {found.torn} bytes are of no whole chunk" if found.torn else ""
    told = "; ".join(filter(None, [f"{level}, {count}", rest, made_with(others), *remarks]))
    if found.ended and not found.lost.messages:
        return 0, f"reproduced, {told}"
    until = "in its first trial" if found.trial is None else f"after trial {found.trial}"
    state = "saved in part" if found.ended else f"interrupted {until}"
    return 3, f"{state}, equal so far, {told}{_lacking(found.lost)}"


def _rerun(arguments: argparse.Namespace) -> int:
    require_extra("rerun", "view")
    path = _log_of(arguments.file, arguments)
    folder = arguments.folder or path.parent
    folder.mkdir(parents=True, exist_ok=True)
    for name in _record(path, arguments.trials, folder, _limits(arguments)):
        print(printable(folder / name))
    return 0


def _record(path: Path, trials: list[int], folder: Path, limits: mcap.Limits) -> list[str]:
    """Make recordings of trials from a log; give their names within the folder."""
    from gapath.recorders.rerun import Recorder

    recorder = Recorder(trials=trials)
    recorder.open(str(folder))
    try:
        for event in mcap.read_sound(path, limits):
            recorder.record(event)
    except BaseException:
        recorder.abort()
        raise
    names = recorder.close()
    require(
        len(names) == len(set(trials)), path, f"{len(names)} of the trials", "a log of all of them"
    )
    return names


def _bag(arguments: argparse.Namespace) -> int:
    from gapath.recorders.mcap.ros.animation import animate

    log, folder, limits = _log_of(arguments.file, arguments), arguments.folder, _limits(arguments)
    for path in animate(log, folder, arguments.trials, arguments.step_s, limits):
        print(printable(path))
    return 0


def _messages(arguments: argparse.Namespace) -> int:
    from gapath.recorders.mcap.ros.package import package_files

    folder = arguments.folder
    require(not os.path.lexists(folder), folder, "something that is there", "a new folder")
    for name, text in package_files(gapath.__version__).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    print(printable(folder))
    return 0


def _view(arguments: argparse.Namespace) -> int:
    require_extra("view", "view")
    paths = [_log_of(path, arguments) for path in arguments.files]
    return viewer.view(arguments.files, paths, _limits(arguments), arguments.web)


def _picture(arguments: argparse.Namespace) -> int:
    path = _log_of(arguments.file, arguments)
    print(printable(drawing.picture(path, _limits(arguments), arguments)))
    return 0


def _path(arguments: argparse.Namespace) -> int:
    path = _log_of(arguments.file, arguments)
    sys.stdout.writelines(path_rows(path, arguments.trial, _limits(arguments)))
    return 0


def _movie(arguments: argparse.Namespace) -> int:
    path = _log_of(arguments.file, arguments)
    print(printable(drawing.movie(path, _limits(arguments), arguments)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
