"""Commands in processes of their own, forked from one that has imported what takes long."""

import multiprocessing
import os
import sys
import tempfile
from importlib import import_module
from pathlib import Path

MODULES = {
    "gapath": "gapath.commands.run",
    "gapath-log": "gapath.commands.log",
    "gapath-report": "gapath.pipelines.report.cli",
}
LATE = [
    *(f"gapath.tasks.{name}" for name in ("plan", "drive", "scenario")),
    *(f"gapath.pipelines.compare.{name}" for name in ("answer", "command", "figures")),
    "gapath.pipelines.asking.command",
    "gapath.planners.bspline_ga",
    "duckdb",
    "numba.np.arrayobj",
    "matplotlib.figure",
    "scipy.stats",
]
"""What the commands import only when they need it."""

PROCESSES = multiprocessing.get_context("forkserver")
PROCESSES.set_forkserver_preload([*MODULES.values(), *LATE])


def run(words, folder, **environment):
    """Run a command in a folder; give its exit code, output and error output."""
    with tempfile.TemporaryDirectory() as place:
        files = [Path(place, name) for name in ("out", "errors")]
        words = tuple(map(str, words))
        given = (words, str(folder), environment, *map(str, files))
        process = PROCESSES.Process(target=_command, args=given)
        process.start()
        process.join(240)
        process.kill()  # if it still runs: then there is no exit code
        return process.exitcode, *(file.read_text("utf-8") for file in files)


def _command(words, folder, environment, *files):
    for number, file in enumerate(files, 1):
        os.dup2(os.open(file, os.O_WRONLY | os.O_CREAT), number)
    os.chdir(folder)
    os.environ.update(environment)
    sys.path[:0] = filter(None, environment.get("PYTHONPATH", "").split(os.pathsep))
    sys.argv = list(words)
    sys.exit(import_module(MODULES[words[0]]).main())
