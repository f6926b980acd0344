"""A search: a sweeper that suggests settings is told what each of them comes to.

Each setting is a sweep of its own, over `SearchSettings.over`, of ordinary runs, and what it comes
to is read from their files. So runs that are whole are not done again, and the same command goes on
with a search that was cut short, as long as the sweeper suggests the same again.
"""

import logging
import math
import shlex
import sys
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import IntervalSweep, Override, RangeSweep
from hydra.core.utils import JobReturn, JobStatus
from hydra.plugins.launcher import Launcher
from omegaconf import DictConfig, OmegaConf, flag_override

from gapath.commands import run as command
from gapath.commands.refusal import check_once
from gapath.components import typed
from gapath.errors import FAULTS, Checks, InputError, one_of, printable, require
from gapath.running.config import Run
from gapath.running.experiment import run_folder
from gapath.running.sweep import BUSY
from gapath.store.records import read_record
from gapath.store.results import Results

OBJECTIVES = {
    "expected_evaluations": "minimize",
    "expected_seconds": "minimize",
    "cost": "minimize",
    "success": "maximize",
}
"""Figures of `Results.figures` -> which way is better."""

_WORST = {"minimize": math.inf, "maximize": 0.0}
"""What a setting comes to that cannot be tried, or of which a run failed."""

_MANY = "an integer from 1 to 10^6"

Words = list[str]
"""What is set, ``key=value`` each."""


@dataclass
class SearchSettings:
    """What a search is for: the root's group ``search``.

    Parameters
    ----------
    objective : str
        A key of `OBJECTIVES`: what the trials of a setting come to, all of its runs together.
    over : list of str
        What each setting is tried on: the words of a sweep.
    unseen : list of str
        What the best setting and the one that was there before are tried on at the end. No
        problem of these may be one of `over`. Empty: nothing.
    """

    objective: str
    over: list[str]
    unseen: list[str]

    def __post_init__(self) -> None:
        check = Checks(self, "search")
        check("objective", self.objective in OBJECTIVES, one_of(self.objective, [*OBJECTIVES]))


class Sweep(Protocol):
    """The jobs of a sweep that grows."""

    folders: dict[Path, Words]

    def add(self, run: Run, words: Words) -> None:
        """Add a checked job."""

    def grow(self) -> None:
        """Note that jobs were added."""


class _Tried(NamedTuple):
    """A setting, and what it came to."""

    words: Words
    value: float


class Search(Launcher):  # type: ignore[misc]
    """Has an engine do the runs of each setting that is suggested, and tells what they come to.

    Parameters
    ----------
    config : DictConfig
        As composed for the sweep.
    compose : callable
        Composes a job of such words.
    parsed : sequence of Override
        All words of the sweep; of two for one setting the last counts.
    sweep : Sweep
        Has no jobs yet.

    Raises
    ------
    InputError
        If the group ``search`` is wrong, nothing is searched, a setting at an end of its range is
        refused, or a problem of `SearchSettings.unseen` is one of `SearchSettings.over`.
    """

    def __init__(
        self,
        config: DictConfig,
        compose: Callable[[Words], DictConfig],
        parsed: Sequence[Override],
        sweep: Sweep,
    ) -> None:
        given: Any = OmegaConf.to_container(config.search, resolve=True)
        settings: SearchSettings = typed(SearchSettings, given, "search")
        self._objective, self._way = settings.objective, OBJECTIVES[settings.objective]
        self._over, self._unseen = _jobs(settings.over), _jobs(settings.unseen)
        self._tries_unseen = bool(settings.unseen)
        self._compose, self._sweep = compose, sweep
        last = {each.get_key_element(): each for each in parsed}.values()
        self._searched = [each.get_key_element() for each in last if each.is_sweep_override()]
        self._before = [str(each.input_line) for each in last if not each.is_sweep_override()]
        self._name, self._output = str(config.name), str(config.output)
        self._tried: list[_Tried] = []
        self._engine: Any = None
        sweeper = config.hydra.sweeper
        chosen = getattr(sweeper.direction, "name", sweeper.direction)
        right = f"{self._way}, with search.objective={self._objective}"
        require(chosen == self._way, "hydra.sweeper.direction", chosen, right)
        for name in ("n_trials", "n_jobs"):
            given = sweeper[name]
            require(1 <= given <= 10**6, f"hydra.sweeper.{name}", given, _MANY)
        right = "null: runs hold what was tried, and the same command goes on"
        require(sweeper.storage is None, "hydra.sweeper.storage", sweeper.storage, right)
        if sweeper.sampler.get("seed", 0) is None:
            with flag_override(sweeper, "readonly", False):
                sweeper.sampler.seed = 0  # else it would never suggest the same again
        right = "a setting with several values, such as planner.population=range(20,200)"
        require(bool(self._searched), "hydra.sweeper.params", "nothing to search", right)
        ends = [[_end(each, which) for each in last] for which in (0, -1)]
        self.place = run_folder(self._run([*ends[1], *self._over[0]])).path.parent
        """The folder of its runs."""
        seen = {_problem(self._run([*ends[0], *more])) for more in self._over}
        for more in self._unseen if self._tries_unseen else []:
            new = _problem(self._run([*ends[0], *more])) not in seen
            require(new, "search.unseen", " ".join(more), "nothing that search.over has")
        self.most = sweeper.n_trials * len(self._over)
        """How many runs it may do."""
        self.most += 2 * len(self._unseen) if self._tries_unseen else 0

    def by(self, engine: Any) -> "Search":
        """Have an engine do the runs."""
        self._engine = engine
        logging.getLogger("optuna").setLevel(logging.WARNING)  # it says what no setting changes
        return self

    def setup(self, **given: object) -> None:
        """Nothing: the engine is set up already."""

    def launch(
        self, job_overrides: Sequence[Sequence[str]], initial_job_idx: int
    ) -> Sequence[JobReturn]:
        """Try settings; gives what each of them comes to, which is what a sweeper wants to know.

        Raises
        ------
        InputError
            If a method has no such figure.
        """
        settings = [[*words] for words in job_overrides]
        values = []
        for words, folders in zip(settings, self._do(settings, self._over), strict=True):
            value, told = self._value(folders)
            self._tried.append(_Tried(words, value))
            command.say(f"setting {len(self._tried)}: {self._shown(words)}: {told}")
            values.append(value)
        return [JobReturn(status=JobStatus.COMPLETED, _return_value=value) for value in values]

    def end(self) -> None:
        """Say which setting is best, and try it where none was tried; raises as `launch` does."""
        pick = min if self._way == "minimize" else max
        best = pick(self._tried, key=lambda each: each.value)
        if best.value == _WORST[self._way]:
            command.say(f"best of {len(self._tried)}: none, as none came to {self._objective}")
            return
        shown = f"{self._shown(best.words)}: {self._objective} {best.value:.6g}"
        command.say(f"best of {len(self._tried)}: {shown}")
        if not self._tries_unseen:
            return
        name = f"{self._name}_unseen"
        settings = [
            [*(word for word in words if not word.startswith("name=")), f"name={name}"]
            for words in (self._before, best.words)
        ]
        tried = zip(("before", "tuned"), self._do(settings, self._unseen), strict=True)
        for what, folders in tried:
            command.say(f"unseen, {what}: {self._value(folders)[1]}")
        asked = f"{shlex.quote(self._output)} --by method --where \"experiment = '{name}'\""
        command.say(f"gapath-report compare {asked}")

    def _do(self, settings: Sequence[Words], over: Sequence[Words]) -> list[list[Path]]:
        """Do all runs of settings that were not done yet; gives the folders of each.

        None of a setting that was refused.
        """
        todo: list[Words] = []
        found: list[list[Path]] = []
        for words in settings:
            try:
                jobs = [[*words, *more] for more in over]
                runs = [self._run(each) for each in jobs]
            except FAULTS as error:
                command.CODES.append(command.refuse(error, words, sweep=True))
                found.append([])
                continue
            folders = [run_folder(run).path for run in runs]
            for run, job, folder in zip(runs, jobs, folders, strict=True):
                if folder not in self._sweep.folders:
                    self._sweep.add(run, job)
                    todo.append(job)
            found.append(folders)
        self._sweep.grow()
        with redirect_stdout(StringIO()):  # a line for each setting tells enough
            returns = self._engine.launch(todo, 0)
        if any(each.return_value == BUSY for each in returns):
            command.warn("another process does runs of this search; the same command goes on")
            sys.exit(BUSY)
        return found

    def _run(self, words: Words) -> Run:
        check_once(words)
        whole = self._compose(words)
        return command.run_of(whole, whole.hydra, words)

    def _value(self, folders: Sequence[Path]) -> tuple[float, str]:
        """Give what the runs of a setting come to, and say it."""
        runs = [read_record(folder) for folder in folders]
        failed = sum(bool(run.fault) for run in runs)
        if failed or not runs:
            said = f"{failed} of {len(runs)} runs failed" if runs else "refused"
            return _WORST[self._way], said
        pooled = Results.pooled([run.known.results for run in runs if run.known.results])
        figures = pooled.figures()
        value = figures.get(self._objective)
        if self._objective == "cost" and pooled.succeeded < pooled.trials:
            value = math.inf  # what is cheap because it fails where paths are dear is not better
        known = ", ".join(name for name in OBJECTIVES if name in figures)
        right = f"one of {known}, which its method has"
        if value is None:
            raise InputError("search.objective", self._objective, right)
        found = f"{pooled.succeeded} of {pooled.trials} trials in {len(runs)} runs"
        return value, f"{self._objective} {value:.6g}, {found} succeeded"

    def _shown(self, words: Words) -> str:
        return printable(" ".join(w for w in words if w.partition("=")[0] in self._searched))


def _jobs(words: Words) -> list[Words]:
    """Give the jobs of a sweep; of no words one that sets nothing."""
    # Not above: Hydra's search for plugins makes this module anew.
    from hydra._internal.core_plugins.basic_sweeper import BasicSweeper

    jobs: list[Words] = BasicSweeper.split_arguments(
        OverridesParser.create().parse_overrides(words), None
    )[0]
    return jobs


def _problem(run: Run) -> tuple[object, ...]:
    """Give what tells one problem from another, whatever it is called."""
    posed = run.problem
    queries = "" if posed.queries is None else posed.queries.digest
    return posed.map.digest, posed.start, posed.target, queries


def _end(each: Override, which: int) -> str:
    """Give the word for the first or the last value of what is searched, or the only one."""
    value = each.value()
    if not each.is_sweep_override():
        return str(each.input_line)
    key = str(each.get_key_element())
    if isinstance(value, IntervalSweep | RangeSweep):
        end = value.start, value.end if isinstance(value, IntervalSweep) else value.stop
        return f"{key}={end[which]}"
    return f"{key}={[*each.sweep_string_iterator()][which]}"
