"""The Hydra application: compose, check, run, print."""

import os
import shlex
import sys
import traceback
from collections.abc import Mapping, Sequence
from typing import NoReturn

from hydra import compose
from hydra import main as hydra_main
from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.global_hydra import GlobalHydra
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.plugins import Plugins
from hydra.errors import HydraException, OverrideParseException
from hydra.experimental.callback import Callback
from hydra.plugins.search_path_plugin import SearchPathPlugin
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import ConfigAttributeError, ConfigKeyError, OmegaConfBaseException

from gapath.discovery import OFFERS, conf_packages, kinds, with_setting
from gapath.errors import InputError, require
from gapath.runs.config import Run, conf_folder, make_run
from gapath.runs.experiment import Execution, execute
from gapath.store.records import State
from gapath.task import find_task

BAD_INPUT, FAILED, INTERRUPTED = 2, 1, 130

BAD_CONFIGURATION = (InputError, HydraException, OmegaConfBaseException)


class JobFailed(Exception):
    """A job failed and has said why; carries the exit code."""


class OtherConfigurations(SearchPathPlugin):  # type: ignore[misc]
    """Lets Hydra find the YAMLs of installed packages (`gapath.discovery`)."""

    def manipulate_search_path(self, search_path: ConfigSearchPath) -> None:
        """Add their packages behind gapath's own folder."""
        for package in conf_packages()[1:]:
            search_path.append("gapath", f"pkg://{package}")


class SweepCheck(Callback):  # type: ignore[misc]
    """Checks every job of a sweep before the first one runs."""

    def on_multirun_start(self, config: DictConfig, **kwargs: object) -> None:
        """Compose and check all jobs; exit with code 2 if any job's settings are wrong.

        Hydra turns a callback's exceptions into warnings, but not an exit.
        """
        from hydra._internal.core_plugins.basic_sweeper import BasicSweeper

        given = [f"{key}={value}" for key, value in (config.hydra.sweeper.params or {}).items()]
        loader = GlobalHydra.instance().config_loader()
        try:
            parser = OverridesParser.create(config_loader=loader)
            parsed = parser.parse_overrides([*given, *config.hydra.overrides.task])
            for overrides in BasicSweeper.split_arguments(parsed, None)[0]:
                config = compose("config", overrides=overrides, return_hydra_config=True)
                choices = dict(config.hydra.runtime.choices)
                OmegaConf.set_struct(config, False)
                del config["hydra"]
                check_used(overrides, config.task)
                make_run(config, choices, settings_of(overrides))
        except Exception as error:
            sys.exit(complain(error))
        # Hydra would compose every job once more, only to see whether it can be composed.
        BasicSweeper.validate_batch_is_legal = lambda self, batch: None


def job(config: DictConfig) -> None:
    """Do one job: one setting and a batch of trials.

    Parameters
    ----------
    config : DictConfig
        As Hydra composed it.
    """
    hydra = HydraConfig.get()
    sweep = hydra.mode == RunMode.MULTIRUN
    overrides = list(hydra.overrides.task)
    try:
        check_used(overrides, config.task)
        run = make_run(config, hydra.runtime.choices, settings_of(overrides))
        execution = execute(run, command(overrides, hydra.runtime.config_sources))
    except BAD_CONFIGURATION as error:
        fail(complain(error), sweep)
    except Exception:
        traceback.print_exc()
        fail(FAILED, sweep)
    else:
        try:
            print(describe(run, execution, short=sweep), flush=True)
        except BrokenPipeError:  # gapath ... | head: the run is done, nobody reads on
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def check_used(overrides: list[str], task: str) -> None:
    """Raise InputError if something was set on the command line that the task does not use."""
    users: dict[str, list[str]] = {}
    for name in kinds("task"):
        for group in find_task(name).groups:
            users.setdefault(group, []).append(name)
    for override in overrides:
        (key,) = settings_of([override])
        able = users.get(key.partition(".")[0], [task])
        good = " or ".join(f"task={name}" for name in able)
        require(task in able, key, f"task={task}, which does not use it", good)


def settings_of(overrides: list[str]) -> list[str]:
    """Give the names that overrides set."""
    return [override.partition("=")[0].lstrip("+~") for override in overrides]


def command(overrides: list[str], sources: Sequence[Mapping[str, str]]) -> str:
    """Give the command that does the same job, wherever its folder lies."""
    kept = [o for o in overrides if not o.startswith(("output=", "force="))]
    own = [source["path"] for source in sources if source["provider"] == "command-line"]
    return shlex.join(["gapath", *(f"--config-dir={path}" for path in own), *kept])


def fail(code: int, sweep: bool) -> NoReturn:
    """End a job; in a sweep so that the other jobs go on.

    Raises
    ------
    JobFailed
        In a sweep; Hydra raises it again after the last job.
    SystemExit
        Otherwise.
    """
    if sweep:
        raise JobFailed(code)
    sys.exit(code)


def complain(error: Exception) -> int:
    """Print what is wrong with the input and give the exit code."""
    if isinstance(error, OSError) and not isinstance(error, HydraException):
        error = InputError(
            "output", error.filename, f"a folder that can be written ({error.strerror})"
        )
    if isinstance(error, OverrideParseException):
        name, equals, value = str(error.override).partition("=")
        quoted = shlex.quote(f'{name}="{value}"')
        right = f"quotes around what is no plain word, {quoted}"
        if value[:1] in ("[", "{", "(", '"', "'"):
            right = "a whole list [x, y], mapping {name: value} or quoted text"
        error = (
            InputError(name, value, right) if equals else InputError(name, "no value", "NAME=VALUE")
        )
    if isinstance(error.__cause__, ConfigKeyError | ConfigAttributeError):
        key = str(error.__cause__.full_key)
        group, _, name = key.partition(".")
        if group in OFFERS and (others := with_setting(group, name)):
            error = InputError(key, f"an unknown name with this {group}", f"{others}, which has it")
    reason = str(error).partition("\nConfig search path")[0] or type(error).__name__
    hidden = error.__cause__ if isinstance(error, HydraException) else None
    cause = str(hidden or "").partition("\n")[0]
    print(f"gapath: {reason}{f' ({cause})' if cause else ''}", file=sys.stderr, flush=True)
    return BAD_INPUT


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
    what = f"{grid.name}{instance} {run.method.name}"
    if execution.state is State.SKIPPED:
        return f"{what}: skipped, {execution.folder} is whole (force=true runs it again)"
    if execution.state is State.BUSY:
        return f"{what}: skipped, another process is working on {execution.folder}"
    rows = execution.rows
    if short:
        return f"{what}: {run.task.line(rows)}, {execution.folder}"
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
    table = "\n".join(f"{name:<14}{value}" for name, value in lines.items())
    files = "\n".join(f"  {execution.folder / name}" for name in execution.files)
    return f"{table}\n\nfiles\n{files}"


def main() -> None:
    """Run the command ``gapath``; exits with 0, 1 (a job failed) or 2 (bad input)."""
    Plugins.instance().register(OtherConfigurations)
    os.environ["HYDRA_FULL_ERROR"] = "1"  # errors come here instead of being printed
    try:
        hydra_main(version_base="1.3", config_path=conf_folder(), config_name="config")(job)()
    except JobFailed as failure:
        sys.exit(failure.args[0])
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except BrokenPipeError:  # gapath --help | head
        sys.stderr.close()
    except Exception as error:  # a job catches its own: this is a command line that is wrong
        sys.exit(complain(error))
