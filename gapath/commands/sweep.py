"""A sweep: all jobs are checked before the first one runs, and an engine does those that are left.

Engines are Hydra's launchers, which do jobs in this process or in others.
"""

import os
import shlex
import sys
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import Any

from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra.core.global_hydra import GlobalHydra
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.plugins import Plugins
from hydra.core.utils import JobReturn, JobStatus
from hydra.experimental.callback import Callback
from hydra.plugins.launcher import Launcher
from omegaconf import DictConfig

from gapath.commands import run as command
from gapath.commands.asker import begin_sweep
from gapath.commands.composing import Composer
from gapath.commands.refusal import missing_engine
from gapath.commands.search import Search
from gapath.commands.signals import following
from gapath.commands.watching import Shown
from gapath.errors import FAULTS, InputError, printable, require
from gapath.running.config import Run
from gapath.running.experiment import run_folder
from gapath.running.sweep import Standing, SweepFile, difference, host, tell, unfinished
from gapath.running.work import told
from gapath.store.runfolder import RunFolder
from gapath.store.whole import is_whole

_launcher = Plugins.instantiate_launcher

MANY = 10**9


class SweepCheck(Callback):  # type: ignore[misc]
    """Checks every job of a sweep before the first one runs, and keeps none of those done."""

    def __init__(self) -> None:
        self._search: Search | None = None

    def on_multirun_start(self, config: DictConfig, **kwargs: object) -> None:
        """Compose and check all jobs; exit with code 2 if any job's settings are wrong.

        Hydra turns a callback's exceptions into warnings, but not an exit.
        """
        # Not above: Hydra's search for plugins makes this module anew.
        from hydra._internal.core_plugins.basic_sweeper import BasicSweeper

        words = command.typed(config.hydra)
        loader: Any = GlobalHydra.instance().config_loader()
        compose = Composer(loader, config)
        sweep = _Sweep()
        try:
            _check_engine(config)
            params = config.hydra.sweeper.params or {}  # items() resolves them, as the sweeper does
            words = every = [*(f"{key}={value}" for key, value in params.items()), *words]
            parser = OverridesParser.create(config_loader=loader)
            parsed = parser.parse_overrides(every)
            if command.searches(config.hydra):
                self._search = Search(config, compose, parsed, sweep)
                sweep.open(self._search.place, self._search.most)
            else:
                for words in BasicSweeper.split_arguments(parsed, None)[0]:
                    whole = compose(words)
                    sweep.add(command.run_of(whole, whole.hydra, words), words)
                words = every
                sweep.begin()
        except FAULTS as error:
            sys.exit(command.refuse(error, words, sweep=True))
        command.ENDING.callback(sweep.end)
        # Hydra would compose every job twice more: to see whether it can be composed, and to do it.
        BasicSweeper.validate_batch_is_legal = lambda self, batch: None
        ConfigLoaderImpl.load_sweep_config = lambda self, master_config, sweep_overrides: compose(
            sweep_overrides
        )
        search = self._search

        def launcher(self: Any, hydra_context: Any, task_function: Any, config: Any) -> Launcher:
            engine = _Engine(_launcher(self, hydra_context, sweep.job, config), sweep)
            return search.by(engine) if search else engine

        Plugins.instantiate_launcher = launcher

    def on_multirun_end(self, config: DictConfig, **kwargs: object) -> None:
        """Have a search say what it found; exit if something cannot be done.

        Hydra turns a callback's exceptions into warnings, but not an exit.
        """
        try:
            if self._search is not None:
                self._search.end()
        except FAULTS as error:
            sys.exit(command.refuse(error, [], sweep=True))

    def on_job_end(self, config: DictConfig, job_return: Any, **kwargs: object) -> None:
        """Let go of a job's configurations: Hydra keeps what it returned until a sweep ends."""
        job_return.cfg = job_return.hydra_cfg = None


def _check_engine(config: DictConfig) -> None:
    """Raise InputError if the chosen engine is not installed, or who asks for jobs is unknown."""
    sweeper = str(config.hydra.runtime.choices["hydra/sweeper"])
    usual = sweeper == "basic" or command.searches(config.hydra)
    require(usual, "hydra/sweeper", sweeper, "one of basic, optuna")
    name = str(config.hydra.runtime.choices["hydra/launcher"])
    if str(config.hydra.launcher._target_) not in Plugins.instance().class_name_to_class:
        other = InputError("hydra/launcher", f"{name}, which is not installed", "one that is")
        raise missing_engine("hydra/launcher", name) or other


@dataclass
class _Job:
    """What an engine calls for each job, in whichever process.

    Parameters
    ----------
    file : str
        The sweep's (`gapath.running.sweep`).
    pid : int
        The process of the sweep.
    host : str
        Its machine.
    """

    file: str
    pid: int
    host: str

    def __call__(self, config: DictConfig) -> int:
        """Do a job; gives its exit code."""
        hydra = HydraConfig.get()
        number, words = hydra.job.num, command.typed(hydra)
        path = Path(self.file)
        tell(path, begun=number, words=words)
        if (self.pid, self.host) == (os.getpid(), host()):
            return self._done(config, words, path, number)
        out, err = StringIO(), StringIO()
        sweep = Standing(path)
        # Of a process on another machine nobody here knows.
        here = self.host == host()
        over = (lambda: not sweep.alive) if here else (lambda: False)
        process = self.pid if here else None
        with redirect_stdout(out), redirect_stderr(err), following(over, process):
            return self._done(config, words, path, number, out, err)

    def _done(
        self, config: DictConfig, words: list[str], path: Path, number: int, *said: StringIO
    ) -> int:
        code = command.FAILED
        try:
            code = command.job(config)
        finally:
            texts = [each.getvalue() for each in said]
            trials = int(config.trials)
            tell(path, ended=number, code=code, trials=trials, words=words, said=texts)
        return code


@dataclass
class _Sweep:
    """The jobs of a sweep, and what came of them."""

    folders: dict[Path, list[str]] = field(default_factory=dict)
    whole: set[tuple[str, ...]] = field(default_factory=set)
    """Jobs whose runs need nothing more."""
    works: list[tuple[int, int]] = field(default_factory=list)
    without: dict[str, None] = field(default_factory=dict)
    """Usual recorders that are not installed."""
    codes: list[int] = field(default_factory=list)
    begun: int = 0
    """Jobs that engines got so far."""
    file: SweepFile | None = None
    most: int = 0
    """How many jobs it may come to."""

    def add(self, run: Run, words: list[str]) -> None:
        """Add a checked job; raises InputError if it is another one's run."""
        self.without.update(dict.fromkeys(run.left_out))
        folder = run_folder(run)
        command.check_apart(folder.path, words, self.folders)
        if not run.force and is_whole(folder, run.settings):
            self.whole.add(tuple(words))
        else:
            self.works.append((run.trials, command.work_of(run)))

    def begin(self) -> None:
        """Say what is to do, and make the file; raises InputError if that cannot be made."""
        if self.whole:
            place = next(iter(self.folders)).parent
            runs = f"{len(self.whole)} of {len(self.folders)} runs are whole, in {printable(place)}"
            command.say(f"skipped: {runs} (force=true runs them again)")
        if not self.works:
            return
        for folder in self.folders:
            RunFolder(folder).create_parent()
        place = next(iter(self.folders)).parent
        names = [folder.name for folder in self.folders]
        line = shlex.join(["gapath", *sys.argv[1:]])
        for other in unfinished(place.parent):
            if other.path.parent == place and not other.alive and {*other.folders} != {*names}:
                command.warn(_told_apart(other.path, other.left, difference(other.command, line)))
        self.open(place)
        for recorder in self.without:
            command.warn(f"without {recorder}")
        command.warn(told(self.works))

    def open(self, place: Path, most: int = 0) -> None:
        """Make the file in a folder, for so many jobs or those there are; raises InputError."""
        self.most = max(most, len(self.folders))
        self.file = SweepFile(place, self._head())
        begin_sweep(self.most - len(self.whole))

    def grow(self) -> None:
        """Note jobs that were added since."""
        assert self.file is not None
        tell(self.file.path, **self._head())

    def _head(self) -> dict[str, Any]:
        line = shlex.join(["gapath", *sys.argv[1:]])
        names = [folder.name for folder in self.folders]
        return {"command": line, "jobs": self.most, "whole": len(self.whole), "folders": names}

    @property
    def job(self) -> _Job:
        """What engines call."""
        path = "" if self.file is None else str(self.file.path.resolve())
        return _Job(path, os.getpid(), host())

    def end(self) -> None:
        """Count what came of it, and let go of the file."""
        command.CODES.extend(self.codes)
        if self.file is not None:
            self.file.close(done=len(self.codes) == len(self.works) and not any(self.codes))


def _told_apart(path: Path, left: int, difference: str) -> str:
    what = f"it had {difference}" if difference else "its code or a file that it read was another"
    said = f"another sweep here was not finished, {left} runs are left: {what}; nothing is mixed"
    return printable(f"{said} ({path})")


class _Engine(Launcher):  # type: ignore[misc]
    """Has an engine do the jobs that are left, and shows how far it is."""

    def __init__(self, engine: Any, sweep: _Sweep) -> None:
        self._engine, self._sweep = engine, sweep

    def setup(self, **given: object) -> None:
        """Nothing: the engine is set up already."""

    def launch(
        self, job_overrides: Sequence[Sequence[str]], initial_job_idx: int
    ) -> Sequence[JobReturn]:
        """Do jobs; of those that are whole nothing is asked."""
        sweep = self._sweep
        todo = [words for words in job_overrides if tuple(words) not in sweep.whole]
        # That of submitit for one machine starts all that it gets at once.
        most = (os.cpu_count() or 1) if type(self._engine).__name__ == "LocalLauncher" else MANY
        parts = (todo[i : i + most] for i in range(0, len(todo), most))
        returns = (each for part in parts for each in self._launched(part))
        done = JobReturn(status=JobStatus.COMPLETED, _return_value=0)
        return [done if tuple(words) in sweep.whole else next(returns) for words in job_overrides]

    def _launched(self, todo: list[Sequence[str]]) -> list[JobReturn]:
        sweep = self._sweep
        assert sweep.file is not None
        first, sweep.begun = sweep.begun, sweep.begun + len(todo)
        # Where a signal ends this process, what joblib leaves to another one is told as a mistake.
        os.environ["PYTHONWARNINGS"] = "ignore:resource_tracker:UserWarning"
        with Shown(sweep.file.path, command.say, command.warn) as shown:
            try:
                returns = list(self._engine.launch(todo, first))
            except FAULTS as error:  # of the engine itself, or of a process of its
                code = command.refuse(error, [], sweep=True)
                returns = [JobReturn(status=JobStatus.COMPLETED, _return_value=code) for _ in todo]
        for each in returns:
            if each.status is JobStatus.FAILED:  # what no job let through is an engine's
                each.return_value = command.refuse(each._return_value, [], sweep=True)
                each.status = JobStatus.COMPLETED
            sweep.codes.append(each.return_value)
        command.CODES.extend(shown.codes)
        return returns
