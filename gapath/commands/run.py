"""The Hydra application: compose, check, run, print."""

import os
import shlex
import sys
import traceback
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from hydra import main as hydra_main
from hydra._internal.sources_registry import SourcesRegistry
from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.hydra_config import HydraConfig
from hydra.core.plugins import Plugins
from hydra.plugins.search_path_plugin import SearchPathPlugin
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

import gapath
from gapath.commands.asker import asker, asker_of_job, edited_meanwhile
from gapath.commands.refusal import (
    BAD_CONFIGURATION,
    Bounded,
    arguments,
    check_once,
    check_own,
    check_used,
    explain,
)
from gapath.discovery import component_of, conf_packages
from gapath.errors import FAULTS, InputError, printable, require
from gapath.running.config import HOW, Run, conf_folder, make_run
from gapath.running.experiment import Execution, execute
from gapath.running.sweep import BUSY
from gapath.running.work import likely, told
from gapath.store.status import RunState

BAD_INPUT, FAILED = 2, 1

CODES: list[int] = []
"""Exit codes of jobs."""

ENDING = ExitStack()
"""What is to do when the command ends."""


# Hydra finds gapath's own YAMLs of engines before those in the packages of engines, whose types it
# then checks: it says so as if that were a mistake, in workers, too.
warnings.filterwarnings("ignore", r"\s*'hydra/launcher/\w+' is validated")


class OtherConfigurations(SearchPathPlugin):  # type: ignore[misc]
    """Lets Hydra find the YAMLs of installed packages (`gapath.discovery`)."""

    def manipulate_search_path(self, search_path: ConfigSearchPath) -> None:
        """Add their packages behind gapath's own folder."""
        for package in conf_packages()[1:]:
            search_path.append("gapath", f"pkg://{package}")


def job(config: DictConfig) -> int:
    """Do one job: one setting and a batch of trials.

    Parameters
    ----------
    config : DictConfig
        As Hydra composed it.

    Returns
    -------
    int
        Exit code; an error was told already, so that the other jobs of a sweep go on.
    """
    hydra = HydraConfig.get()
    sweep = hydra.mode == RunMode.MULTIRUN
    words = typed(hydra)
    os.chdir(hydra.runtime.cwd)  # where paths are typed, also with hydra.job.chdir=true
    try:
        run = run_of(config, hydra, words)
        warn(edited_meanwhile() if sweep else told([(run.trials, work_of(run))]))
        alone = ["hydra.mode=RUN"] if searches(hydra) else []
        again = command([*words, *alone], hydra.runtime.config_sources)
        launcher = hydra.runtime.choices["hydra/launcher"]
        asked = asker_of_job(hydra.job.num, launcher) if sweep else asker()
        # A sweep has a bar of its own.
        execution = execute(run, again, progress=not sweep, tell=warn, asker=asked)
    except FAULTS as error:
        return refuse(error, words, sweep)
    code = say(describe(run, execution, short=sweep))
    return code or (BUSY if execution.state is RunState.BUSY else 0)


def say(text: str) -> int:
    """Print a result; gives an exit code."""
    try:
        with _beside_bars():
            print(text, flush=True)
    except BrokenPipeError:  # gapath ... | head: the run is done, nobody reads on
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        error.filename = "standard output"
        return refuse(error, [], sweep=False)
    return 0


def run_of(config: DictConfig, hydra: DictConfig, words: Sequence[str]) -> Run:
    """Check one job's settings and make its run.

    Parameters
    ----------
    config : DictConfig
        As Hydra composed it.
    hydra : DictConfig
        Hydra's own configuration, which says how it did so.
    words : sequence of str
        What was set on the command line.

    Returns
    -------
    Run
        Ready to be executed.

    Raises
    ------
    InputError
        For anything that is wrong.
    """
    check_used(words, config.task)
    check_own(words, hydra.runtime)
    for name in settings_of(words):
        useful = not name.startswith("search.") or searches(hydra)
        require(useful, name, "no search", "hydra/sweeper=optuna, which does one")
    said = any(word.startswith("hydra.mode=") for word in sys.argv)  # Hydra adds its own
    good = hydra.mode == RunMode.MULTIRUN or said or not searches(hydra)
    right = "gapath -m, which searches; hydra.mode=RUN does one run"
    require(good, "hydra/sweeper", f"{hydra.runtime.choices['hydra/sweeper']} without -m", right)
    own = OmegaConf.masked_copy(config, [str(key) for key in config if key != "hydra"])
    return make_run(own, dict(hydra.runtime.choices), settings_of(words))


def searches(hydra: DictConfig) -> bool:
    """Tell whether the sweeper suggests settings, and wants to know what they come to."""
    return "direction" in hydra.sweeper


def typed(hydra: DictConfig) -> list[str]:
    """Give what was set on the command line, ``${name}`` as it was typed."""
    words: Any = OmegaConf.to_container(hydra.overrides.task)
    return list(map(str, words))


def work_of(run: Run) -> int:
    """Say what each trial of a run may come to."""
    return likely(run.task, run.settings, run.problem.map.weights.size)


def warn(line: str | None) -> None:
    """Tell something that is no error, if there is anything to tell."""
    if line is not None:
        with _beside_bars():
            print(f"gapath: {line}", file=sys.stderr, flush=True)


@contextmanager
def _beside_bars() -> Iterator[None]:
    """Write lines; a bar that stands there goes, and comes again below them."""
    bars: Any = sys.modules.get("tqdm")
    with ExitStack() as cleared:
        if bars is not None:
            cleared.enter_context(bars.tqdm.external_write_mode())
        yield


def settings_of(words: Sequence[str]) -> list[str]:
    """Give the names that are set."""
    return [word.partition("=")[0].lstrip("+~") for word in words]


def check_apart(folder: Path, words: list[str], before: dict[Path, list[str]]) -> None:
    """Raise InputError if an earlier job of a sweep has the same run folder; else note this one."""
    first = before.setdefault(folder, words)
    both = f"{shlex.join(first)} and {shlex.join(words)}, which are one run"
    require(first is words, "sweep", both, f"jobs that differ in more than {', '.join(HOW)}")


_OWN_WAY = ("output=", "force=", "provenance=", "search.")
"""Settings of who runs it or searches, which somebody else who does the same has no use for."""


def command(words: Sequence[str], sources: Sequence[Mapping[str, str]]) -> str:
    """Give the command that does the same job, wherever its folder lies."""
    kept = [word for word in words if not word.startswith(_OWN_WAY)]
    own = [source["path"] for source in sources if source["provider"] == "command-line"]
    return shlex.join(["gapath", *(f"--config-dir={path}" for path in own), *kept])


def refuse(error: BaseException, words: Sequence[str], sweep: bool) -> int:
    """Tell in one line why something cannot be done, and give the exit code.

    Parameters
    ----------
    error : BaseException
        What was raised. One that is no `BAD_CONFIGURATION` and not the system's is a fault of
        some component: once a run has begun, its traceback is in ``status.json``.
    words : sequence of str
        What was set on the command line.
    sweep : bool
        Whether it was called for one.

    Returns
    -------
    int
        `BAD_INPUT` or `FAILED`.
    """
    code, notes = BAD_INPUT, getattr(error, "__notes__", ())
    inside = bool(notes) and not isinstance(error, BAD_CONFIGURATION)  # of a run that had begun
    line = None if inside else explain(error, words, sweep)
    if line is None and isinstance(error, OSError) and not inside:
        expected = "a file or folder that can be read, or written"
        line = str(InputError(error.filename or "output", error.strerror or error, expected))
    if line is None:
        code = FAILED
        last = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(last.filename).name}, line {last.lineno}"
        what = " ".join(f"{type(error).__name__}: {error}".split())
        line = "; ".join([f"{component_of(error)}: {what} ({where})".lstrip(": "), *notes])
    warn(printable(line))
    return code


def describe(run: Run, execution: Execution, short: bool) -> str:
    """Tell how a run ended.

    Parameters
    ----------
    run : Run
        What was done.
    execution : Execution
        What came of it.
    short : bool
        One line instead of a table.

    Returns
    -------
    str
        Text for the terminal.
    """
    grid = run.problem.map
    instance = f"#{grid.instance}" if grid.instance else ""
    what = printable(f"{grid.name}{instance} {run.method.name}")
    folder = printable(execution.folder)
    skipped = f"{what}: skipped, {folder} is whole (force=true runs it again)"
    if execution.state is RunState.BUSY:
        return f"{what}: busy, another process is working on {folder}"
    rows = execution.rows
    if short:
        again = execution.state is RunState.SKIPPED
        begin, end = (skipped, "") if again else (what, f", {folder}")
        return f"{begin}: {printable(run.task.line(rows))}{end}"
    marked = f" ({grid.source})" if grid.source == "reconstructed" else ""
    lines: dict[str, object] = {
        "map": f"{grid.name}{instance}{marked}, {grid.cols} x {grid.rows} fields"
    }
    if grid.inverted is not None:
        obstacle, free = ("black", "white") if grid.inverted else ("white", "black")
        other = str(not grid.inverted).lower()
        lines["read as"] = (
            f"a picture: {obstacle} is an obstacle, {free} the cheapest floor, grey in between "
            f"(the other way round: map=image map.invert={other})"
        )
    lines[run.task.groups[0]] = run.method.name
    lines |= run.task.summary(rows)
    table = "\n".join(f"{name:<14}{printable(value)}" for name, value in lines.items())
    if execution.state is RunState.SKIPPED:
        return f"{table}\n\n{skipped}"
    files = [f"  {printable(execution.folder / name)}" for name in execution.files]
    without = [f"without {each}" for each in run.left_out]
    return "\n".join([table, "", "files", *files, *without, *_to_see(execution)])


def _to_see(execution: Execution) -> list[str]:
    """Say how to see a run that has a log or a recording."""
    shown = sorted(name for name in execution.files if name.endswith((".mcap", ".rrd")))
    if not shown:
        return []
    folder = execution.folder
    what = folder if shown[0].endswith(".mcap") else folder / shown[0]
    if what == folder and folder.parent.parent == Path("outputs"):  # where a key is looked for
        what = Path(folder.name)
    return ["", "to see it", f"  gapath-log view {printable(shlex.quote(str(what)))}"]


def main() -> None:
    """Run the command ``gapath``.

    Exits with 0, `FAILED`, `BAD_INPUT` (also what cannot be written), or `BUSY` if nothing is wrong
    but another process does a job. Of a sweep the first job that failed decides.
    """
    Plugins.instance().register(OtherConfigurations)
    SourcesRegistry.instance().types["file"] = Bounded
    os.environ["HYDRA_FULL_ERROR"] = "1"  # errors come here instead of being printed
    words: list[str] = []
    sweep = False
    CODES.clear()

    def task(config: DictConfig) -> None:
        CODES.append(job(config))

    try:
        if "--version" in sys.argv[1:]:  # Hydra would give its own
            print("gapath", gapath.__version__)
            return
        given = arguments()
        words, sweep = given.overrides, given.multirun
        check_once(words)
        with ENDING:
            hydra_main(version_base="1.3", config_path=conf_folder(), config_name="config")(task)()
    except BrokenPipeError:  # gapath --help | head
        sys.stderr.close()
    except Exception as error:  # a job catches its own: this is a command line that is wrong
        sys.exit(refuse(error, words, sweep))
    if any(CODES):
        sys.exit(next((code for code in CODES if code not in (0, BUSY)), BUSY))
