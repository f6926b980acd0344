"""From a composed configuration to a checked run."""

import dataclasses
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any

from omegaconf import DictConfig, OmegaConf

from gapath.components import build, typed, yaml_values
from gapath.driving.drive import Sensor
from gapath.driving.world import Changes
from gapath.errors import require
from gapath.events import Recorder
from gapath.grid import GridMap
from gapath.mapio import file
from gapath.problem import CornerCutting, Problem
from gapath.recorders import none
from gapath.runs.naming import map_name
from gapath.task import Task
from gapath.tasks.drive import DriveTask
from gapath.tasks.plan import PlanTask


@dataclass
class Settings:
    """The root of the configuration, ``conf/config.yaml``.

    Parameters
    ----------
    task : str
        "plan" on a known map, or "drive" through an unknown one.
    name : str
        The experiment: run folders lie in ``<output>/<name>``.
    map, planner, navigator, recorder : dict
        The chosen components; a task uses the planner or the navigator.
    drive : dict
        `DriveSettings`.
    seed, trials : int
        Trials 0 to trials - 1 use the random streams (seed, trial).
    corner_cutting : str
        Name of a `CornerCutting` rule, in lower case.
    output : str
        Folder of the run folders.
    force : bool
        Run again what is there already.
    threads : int
        Threads that plan the trials of a run; drives have one.
    """

    task: str
    name: str
    map: dict[str, Any]
    planner: dict[str, Any]
    navigator: dict[str, Any]
    drive: dict[str, Any]
    recorder: dict[str, Any]
    seed: int
    trials: int
    corner_cutting: str
    output: str
    force: bool
    threads: int


@dataclass
class DriveSettings:
    """What a drive needs besides a map and a navigator.

    Parameters
    ----------
    sensor : dict
        `gapath.driving.drive.Sensor`.
    changes : dict
        `gapath.driving.world.Changes`.
    step_limit : int
        Steps after which a drive has overrun.
    unknown_weight : float
        What an unknown field counts.
    known_map : str or None
        A map file: what the robot knows before it starts.
    """

    sensor: dict[str, Any]
    changes: dict[str, Any]
    step_limit: int
    unknown_weight: float
    known_map: str | None

    def __post_init__(self) -> None:
        require(
            1 <= self.step_limit <= 10**6,
            "drive.step_limit",
            self.step_limit,
            "an integer from 1 to 1000000",
        )
        require(
            0 <= self.unknown_weight < 1,
            "drive.unknown_weight",
            self.unknown_weight,
            "a number in [0, 1)",
        )


@dataclass(frozen=True, eq=False)
class Run:
    """One job: a setting and a batch of trials, checked and ready.

    Parameters
    ----------
    experiment : str
        Name of the experiment.
    method : str
        Name of the planner's or navigator's YAML, with the values that were overridden.
    problem : Problem
        Map, start, target, corner-cutting rule.
    task : Task
        To plan or to drive, and with what.
    recorders : list of Recorder
        The recorders.
    seed, trials : int
        Trials 0 to trials - 1 use the random streams (seed, trial).
    settings : str
        The resolved configuration as YAML, without the three values below.
    output : str
        Folder of the run folders.
    force : bool
        Run again what is there already.
    threads : int
        Threads that plan the trials; they change no result.
    """

    experiment: str
    method: str
    problem: Problem
    task: Task
    recorders: list[Recorder] = field(repr=False)
    seed: int
    trials: int
    settings: str = field(repr=False)
    output: str
    force: bool
    threads: int = 1


def conf_folder() -> str:
    """Give the folder of the configuration, in a checkout or an installed package."""
    return str(files("gapath.conf"))


def make_run(config: DictConfig, method: str) -> Run:
    """Check a composed configuration and make everything that a run needs.

    Parameters
    ----------
    config : DictConfig
        As composed from ``conf``.
    method : str
        Name of the planner's or navigator's YAML, with the values that were overridden.

    Returns
    -------
    Run
        Ready to be executed.

    Raises
    ------
    InputError
        For anything that is wrong in it, or in the map that it names.
    """
    loose = OmegaConf.to_container(config, resolve=True)
    settings: Settings = typed(Settings, loose, "")
    require(1 <= settings.trials <= 10**6, "trials", settings.trials, "an integer from 1 to 10^6")
    require(1 <= settings.threads <= 256, "threads", settings.threads, "an integer from 1 to 256")
    require(0 <= settings.seed < 2**64, "seed", settings.seed, "an integer in [0, 2^64)")
    require(settings.output.strip() != "", "output", repr(settings.output), "a folder")
    require(
        settings.name.replace("_", "").replace("-", "").isalnum(),
        "name",
        repr(settings.name),
        "letters, digits, - and _",
    )
    used = {"plan": ("planner",), "drive": ("navigator", "drive")}
    require(settings.task in used, "task", settings.task, f"one of {', '.join(used)}")
    # A drive's steps are Python, so drives on threads would only wait for one another.
    alone = settings.task != "drive" or settings.threads == 1
    require(alone, "threads", settings.threads, "1 with task=drive; more speed up task=plan only")
    kept = {
        key: value
        for key, value in dataclasses.asdict(settings).items()
        if key not in ("output", "force", "threads", "planner", "navigator", "drive")
        or key in used[settings.task]
    }
    recorders: list[Recorder] = [
        build("recorder", values, f"recorder.{name}") for name, values in settings.recorder.items()
    ]
    problem, task = read_problem(settings), make_task(kept)
    task.check(problem)
    for recorder in recorders:
        recorder.check(settings.trials)
    return Run(
        settings.name,
        method,
        problem,
        task,
        # where nobody records, trials need not be told as events
        [recorder for recorder in recorders if not isinstance(recorder, none.Recorder)],
        settings.seed,
        settings.trials,
        OmegaConf.to_yaml(OmegaConf.create(kept)),
        settings.output,
        settings.force,
        settings.threads,
    )


def make_task(settings: dict[str, Any]) -> Task:
    """Make the task that settings describe.

    Parameters
    ----------
    settings : dict
        With ``task``, and ``planner`` or ``navigator`` and ``drive``.

    Returns
    -------
    Task
        To plan or to drive.

    Raises
    ------
    InputError
        If a setting is unknown, missing, mistyped or out of range.
    """
    if settings["task"] == "plan":
        return PlanTask(build("planner", settings["planner"], "planner"))
    drive: DriveSettings = typed(DriveSettings, settings["drive"], "drive")
    before = None if drive.known_map is None else read_known_map(drive.known_map)
    return DriveTask(
        build("navigator", settings["navigator"], "navigator"),
        typed(Sensor, drive.sensor, "drive.sensor"),
        typed(Changes, drive.changes, "drive.changes"),
        drive.step_limit,
        drive.unknown_weight,
        before,
    )


def read_known_map(path: str) -> GridMap:
    """Read what a robot knows before it starts: what that map calls unknown stays unknown.

    Parameters
    ----------
    path : str
        A map file.

    Returns
    -------
    GridMap
        Its obstacles are known, everything else is not.

    Raises
    ------
    InputError
        If the file cannot be used.
    """
    kind = file.kind_of(path, "drive.known_map")
    values = yaml_values("map", kind) | {"path": path}
    if "unknown" in values:
        values["unknown"] = "free"
    grid: GridMap = build("map", values, "drive.known_map").read()
    return grid


def read_problem(settings: Settings) -> Problem:
    """Read the map and pose the problem that its start and target define."""
    rules = [rule.name.lower() for rule in CornerCutting]
    require(
        settings.corner_cutting in rules,
        "corner_cutting",
        settings.corner_cutting,
        f"one of {', '.join(rules)}",
    )
    grid: GridMap = build("map", settings.map, "map").read()
    named = map_name(grid.name, settings.map)
    if named != grid.name:  # to replace a name takes a copy of the map
        grid = dataclasses.replace(grid, name=named)
    for name in ("start", "target"):
        require(getattr(grid, name) is not None, f"map.{name}", "null", "a field [x, y]")
    assert grid.start is not None and grid.target is not None
    rule = CornerCutting[settings.corner_cutting.upper()]
    return Problem(grid, grid.start, grid.target, rule)


def task_from_settings(settings: str) -> Task:
    """Make the task that a log's settings describe.

    Parameters
    ----------
    settings : str
        `Run.settings`.

    Returns
    -------
    Task
        To plan or to drive.

    Raises
    ------
    InputError
        If the settings are not those of this version.
    """
    loose = OmegaConf.to_container(OmegaConf.create(settings))
    known = isinstance(loose, dict) and loose.get("task") in ("plan", "drive")
    require(known, "settings of the log", "no known task", "the settings of a run")
    assert isinstance(loose, dict)
    return make_task({str(key): value for key, value in loose.items()})
