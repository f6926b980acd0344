"""From a composed configuration to a checked run."""

import dataclasses
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib.resources import files
from typing import Any

from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import InterpolationResolutionError

from gapath.components import build_recorders, checked, normalised, typed
from gapath.discovery import kinds
from gapath.errors import InputError, one_of, require
from gapath.events import Recorder, Settings
from gapath.planning.acceleration import with_kernels
from gapath.planning.device import CPU, on_device
from gapath.problem import Problem
from gapath.running.naming import Method, check_name, method_of
from gapath.running.posing import in_fields, read_problem
from gapath.running.shards import span, without_whole
from gapath.store.inputs import Inputs, watched
from gapath.store.settings import flatten
from gapath.task import Posing, Task, check_events, columns, find_task


@dataclass
class Root:
    """The root of the configuration, ``conf/config.yaml``, without the groups of tasks.

    Parameters
    ----------
    task : str
        "plan" on a known map, "drive" through an unknown one, or another of `gapath.tasks`.
    name : str
        The experiment: run folders lie in ``<output>/<name>``.
    map : dict
        The chosen map.
    recorder : dict
        The chosen recorders, by name.
    seed : int
        Trial t draws from the random stream (seed, t).
    trials : int
        How many, 0 to trials - 1; so many of each problem where the task poses several.
    shard : int
        Which part of the trials this run does (`gapath.running.shards`), from 0.
    shards : int
        Into how many parts the trials are divided.
    corner_cutting : str
        Name of a `CornerCutting` rule, in lower case.
    output : str
        Folder of the run folders.
    force : bool
        Run again what is there already.
    provenance : bool
        Say in the manifest where the run comes from: code, machine, who asked.
    threads : int
        Threads that do the trials of a run, if the task has any use for them.
    kernels : str
        Which kernels compute: "auto", or a name that one of the task's planners knows.
    device : str
        What plans: "cpu", or "cuda", a GPU, where task and planner can be computed there.
    """

    task: str
    name: str
    map: dict[str, Any]
    recorder: dict[str, Any]
    seed: int
    trials: int
    shard: int
    shards: int
    corner_cutting: str
    output: str
    force: bool
    threads: int
    kernels: str
    device: str
    provenance: bool


HOW = ("output", "force", "threads", "kernels", "device", "provenance")
"""Settings of how to run, which change no result: no part of a run's settings."""


SEARCH = "search"
"""The group of who searches for settings (`gapath.commands.search`), which no run knows of."""


@dataclass(frozen=True, eq=False)
class Run:
    """One job: a setting and a batch of trials, checked and ready.

    Parameters
    ----------
    experiment : str
        Name of the experiment.
    method : Method
        The planner or navigator: its YAML, and what differs from it.
    problem : Problem
        Map, start, target, corner-cutting rule.
    task : Task
        What its trials are, and with what.
    recorders : sequence of Recorder
        The recorders.
    seed, trials : int
        Trials `first` to trials - 1 use the random streams (seed, trial).
    settings : mapping
        The resolved configuration, flat, without `HOW`.
    output : str
        Folder of the run folders.
    force, provenance : bool
        Run again what is there already; say where it comes from.
    threads : int
        Threads that do the trials; they change no result.
    map_inputs, method_inputs : mapping
        The files that the map and the method were made from: path -> SHA-256.
    first : int
        The first trial: 0 but of a shard.
    left_out : sequence of str
        Usual recorders that are not installed: what is missing of each, and where it is.
    """

    experiment: str
    method: Method
    problem: Problem
    task: Task
    recorders: Sequence[Recorder] = field(repr=False)
    seed: int
    trials: int
    settings: Settings = field(repr=False)
    output: str
    force: bool
    threads: int = 1
    map_inputs: Inputs = field(default_factory=dict, repr=False)
    method_inputs: Inputs = field(default_factory=dict, repr=False)
    provenance: bool = False
    first: int = 0
    left_out: Sequence[str] = ()

    @property
    def count(self) -> int:
        """How many trials it does."""
        return self.trials - self.first

    @property
    def inputs(self) -> Inputs:
        """All files that it reads."""
        return {**self.map_inputs, **self.method_inputs}


def conf_folder() -> str:
    """Give the folder of the configuration, in a checkout or an installed package."""
    return str(files("gapath.conf"))


def make_run(
    config: DictConfig, choices: Mapping[str, str | None], overridden: Collection[str] = ()
) -> Run:
    """Check a composed configuration and make everything that a run needs.

    Parameters
    ----------
    config : DictConfig
        As composed from ``conf``.
    choices : mapping
        Configuration group -> name of the chosen YAML.
    overridden : collection of str
        Settings that the command line sets, for the run's name. One that sets no recorder gets
        those of the usual ones that are installed.

    Returns
    -------
    Run
        Ready to be executed.

    Raises
    ------
    InputError
        For anything that is wrong in it, or in the map that it names.
    """
    loose = _resolved(config)
    root, chosen = split(loose)
    task = find_task(root.task)
    require(1 <= root.trials <= 10**6, "trials", root.trials, "an integer from 1 to 10^6")
    require(1 <= root.threads <= 256, "threads", root.threads, "an integer from 1 to 256")
    require(0 <= root.seed < 2**64, "seed", root.seed, "an integer in [0, 2^64)")
    require(root.output.strip() != "", "output", repr(root.output), "a folder")
    check_name(root.name)
    alone = root.threads == 1
    require(alone or root.device == CPU, "threads", root.threads, f"1 with device={root.device}")
    useful = task.threaded or alone
    require(useful, "threads", root.threads, f"1 with task={task.name}, which they do not speed up")
    asked = any(name.partition(".")[0] == "recorder" for name in overridden)
    recorders, left_out = build_recorders(root.recorder, asked)
    root.recorder = {name: root.recorder[name] for name in recorders}
    settings = settings_of(root, chosen)
    with watched() as method_inputs:
        made = on_device(with_kernels(task.make(settings), root.kernels), root.device)
        maps = made.read()
    with watched() as map_inputs:
        problem = read_problem(root.map, root.corner_cutting, made, maps)
    trials = root.trials * (1 if problem.queries is None else len(problem.queries))
    require(trials <= 10**6, "trials", root.trials, f"fewer: {trials} in all, at most 10^6")
    part = span(root.trials, root.shard, root.shards, isinstance(made, Posing))
    with watched() as checked_with:
        made.check(problem)
    columns(task.row)  # a package's wrong metric, or event, is refused before anything is written
    check_events(task)
    for recorder in recorders.values():
        recorder.check(trials)
    return Run(
        root.name,
        method_of(task, _with_types_of(settings, loose), choices, overridden),
        problem,
        made,
        [recorder for recorder in recorders.values() if recorder.records],
        root.seed,
        part.stop if root.shards > 1 else trials,
        flatten(settings),
        root.output,
        root.force,
        root.threads,
        map_inputs,
        method_inputs | checked_with,
        root.provenance,
        part.start,
        left_out,
    )


def _with_types_of(settings: Any, loose: Any) -> Any:
    """Give loose settings, whose planners still name their YAML, the values that they came to."""
    if isinstance(loose, dict):
        known = settings if isinstance(settings, dict) else {}
        return {k: _with_types_of(known[k], v) if k in known else v for k, v in loose.items()}
    if isinstance(loose, list) and isinstance(settings, list):
        return [_with_types_of(*pair) for pair in zip(settings, loose, strict=True)]
    return settings


def _resolved(config: DictConfig) -> Any:
    """Replace what is written ${...}; what cannot be is one line, as OmegaConf's is not."""
    try:
        return OmegaConf.to_container(config, resolve=True)
    except InterpolationResolutionError as error:
        good = "environment variables that are set and settings that there are"
        raise InputError(error.full_key, str(error).partition("\n")[0], good) from error


def split(loose: Mapping[str, Any]) -> tuple[Root, dict[str, Any]]:
    """Split a composed configuration into its root and the groups that some task uses.

    Parameters
    ----------
    loose : mapping
        The configuration, resolved.

    Returns
    -------
    root : Root
        Typed, its components as `gapath.components.normalised`.
    chosen : dict
        Group -> its settings.

    Raises
    ------
    InputError
        If a setting of the root is unknown, missing or mistyped, or a group of the task is missing.
    """
    groups = {group for name in kinds("task") for group in find_task(name).groups}
    known = [*(each.name for each in dataclasses.fields(Root)), *sorted(groups), SEARCH]
    for name in loose:
        if name not in known:
            raise InputError(name, "an unknown name", one_of(name, known))
    root: Root = typed(Root, {k: v for k, v in loose.items() if k not in {*groups, SEARCH}}, "")
    root.map = normalised("map", dict(in_fields(root.map)), "map")
    root.recorder = {
        name: normalised("recorder", values, f"recorder.{name}")
        for name, values in root.recorder.items()
    }
    chosen = {group: loose.get(group) for group in groups}
    for group in find_task(root.task).groups:
        given = chosen[group]
        found = "nothing" if given is None else given
        require(isinstance(given, dict), group, found, f"settings, which task={root.task} uses")
    return root, chosen


def settings_of(root: Root, chosen: Mapping[str, Any]) -> dict[str, Any]:
    """Give a run's settings, nested: those of the root but `HOW`, and of its task's groups.

    Parameters
    ----------
    root : Root
        The root.
    chosen : mapping
        Group -> its settings, as `split` gives them.

    Returns
    -------
    dict
        In one order and with one type each: what means the same is equal.

    Raises
    ------
    InputError
        If a setting is unknown, missing or mistyped.
    """
    task = find_task(root.task)
    common = {key: value for key, value in asdict(root).items() if key not in HOW}
    return without_whole(common) | {
        group: checked(task.shapes[group], chosen[group], group)
        if group in task.shapes
        else normalised(group, chosen[group], group)
        for group in task.groups
    }
