"""Two small runs on a map of somebody's own, and logs that say something else than they did."""

from dataclasses import replace
from pathlib import Path

from gapath.commands import log as log_cli
from gapath.events import RunStarted
from gapath.recorders import mcap
from gapath.store.records import FileEntry, Manifest
from gapath.store.runfolder import RunFolder
from gapath.store.status import Status

MAP = "type octile\nheight 4\nwidth 6\nmap\n......\n.@@@..\n......\n......\n"


_made: dict[str, bytes] = {}


def make_runs(gapath):
    """A* and Dijkstra, two trials each, done once; gives the experiment's folder."""
    Path("office.map").write_text(MAP)
    if not _made:
        code, _, err = gapath(
            "-m", "name=office", "map=file", "map.path=office.map", "map.start=[0,0]",
            "map.target=[5,3]", "planner=astar,dijkstra", "trials=2", "recorder=mcap",
        )  # fmt: skip
        assert code == 0, err
        _made.update((str(each), each.read_bytes()) for each in Path("out").glob("*/*/*"))
    for name, data in _made.items():
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_bytes(data)
    return Path("out/office")


def run_with(folder, planner):
    """The folder of the run with a planner."""
    (found,) = (each for each in folder.glob("*/") if Manifest.read(each).preset == planner)
    return found


def rewritten(run, change=lambda event: event, versions=None):
    """Write a run's log anew, with a change, as if it had come to that."""
    events = list(mcap.read_events(run / mcap.FILE))
    recorder = mcap.Recorder(step_s=0.1)
    recorder.open(str(run))
    for event in events:
        event = change(event)
        if isinstance(event, RunStarted) and versions:
            event = replace(event, versions={**event.versions, **versions})
        recorder.record(event)
    recorder.close()
    resealed(run)


def resealed(run, **changes):
    """Have a run's manifest and status say what its files are now, and something else."""
    folder, known = RunFolder(run), Manifest.read(run)
    files = {name: FileEntry.of(folder, name) for name in known.files if (run / name).is_file()}
    digest = replace(known, files=files, **changes).write(folder)
    replace(Status.read(run), manifest=digest).write(folder)


def called(capfd, *arguments):
    """Exit code, output and error output of gapath-log."""
    code = log_cli.main([str(each) for each in arguments])
    return code, *capfd.readouterr()
