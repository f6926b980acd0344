"""YAML to dataclasses; with `cli` the only place that knows Hydra and OmegaConf."""

import dataclasses
import importlib
import pkgutil
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any, get_type_hints

from omegaconf import DictConfig, ListConfig, OmegaConf
from omegaconf.errors import ConfigKeyError, OmegaConfBaseException

from gapath.errors import InputError, require
from gapath.events import Recorder
from gapath.grid import GridMap
from gapath.problem import CornerCutting, Planner, Problem

PACKAGES = {"map": "gapath.mapio", "planner": "gapath.planners", "recorder": "gapath.recorders"}
"""Configuration group -> the package whose modules its ``kind`` names."""

TARGETS = {"map": "Reader", "planner": "Planner", "recorder": "Recorder"}


@dataclass
class Settings:
    """The root of the configuration, ``conf/config.yaml``.

    Parameters
    ----------
    name : str
        The experiment: run folders lie in ``<output>/<name>``.
    map, planner, recorder : dict
        The chosen components.
    seed, trials : int
        Trials 0 to trials - 1 use the random streams (seed, trial).
    corner_cutting : str
        Name of a `CornerCutting` rule, in lower case.
    output : str
        Folder of the run folders.
    force : bool
        Run again what is there already.
    """

    name: str
    map: dict[str, Any]
    planner: dict[str, Any]
    recorder: dict[str, Any]
    seed: int
    trials: int
    corner_cutting: str
    output: str
    force: bool


@dataclass(frozen=True, eq=False)
class Run:
    """One job: a setting and a batch of trials, checked and ready.

    Parameters
    ----------
    experiment : str
        Name of the experiment.
    planner_name : str
        Name of the planner's YAML, with the values that were overridden.
    problem : Problem
        Map, start, target, corner-cutting rule.
    planner : Planner
        The planner.
    recorders : list of Recorder
        The recorders.
    seed, trials : int
        Trials 0 to trials - 1 use the random streams (seed, trial).
    settings : str
        The resolved configuration as YAML, without the two values below.
    output : str
        Folder of the run folders.
    force : bool
        Run again what is there already.
    """

    experiment: str
    planner_name: str
    problem: Problem
    planner: Planner
    recorders: list[Recorder] = field(repr=False)
    seed: int
    trials: int
    settings: str = field(repr=False)
    output: str
    force: bool


def conf_folder() -> str:
    """Give the folder of the configuration, in a checkout or an installed package."""
    return str(files("gapath.conf"))


def kinds(group: str) -> list[str]:
    """List the modules that a group's ``kind`` can name.

    Parameters
    ----------
    group : str
        "map", "planner" or "recorder".

    Returns
    -------
    list of str
        Module names; those with a leading underscore are no components.
    """
    package = importlib.import_module(PACKAGES[group])
    names = [module.name for module in pkgutil.iter_modules(package.__path__)]
    return sorted(name for name in names if not name.startswith("_"))


def build(group: str, values: dict[str, Any], where: str) -> Any:
    """Make a component from its settings.

    Parameters
    ----------
    group : str
        "map", "planner" or "recorder".
    values : dict
        ``kind`` and the settings of that kind.
    where : str
        Where the values stand, for messages.

    Returns
    -------
    Reader, Planner or Recorder
        An instance of the class in the module that ``kind`` names.

    Raises
    ------
    InputError
        For an unknown kind, an unknown, missing or mistyped setting, or one out of range.
    """
    values = dict(values)
    kind = values.pop("kind", None)
    require(kind in kinds(group), f"{where}.kind", kind, f"one of {', '.join(kinds(group))}")
    module = importlib.import_module(f"{PACKAGES[group]}.{kind}")
    return typed(getattr(module, TARGETS[group]), values, where)


def typed(target: type[Any], values: object, where: str) -> Any:
    """Make a dataclass from loose values, checking names and types.

    Parameters
    ----------
    target : type
        A dataclass without defaults.
    values : mapping
        Its fields.
    where : str
        Where the values stand, for messages; "" for the root.

    Returns
    -------
    object
        An instance of the dataclass.

    Raises
    ------
    InputError
        For an unknown, missing or mistyped field.
    """
    prefix = f"{where}." if where else ""
    names = [f.name for f in dataclasses.fields(target) if f.init]
    if not names:
        loose = values if isinstance(values, dict) else {}
        require(not loose, f"{prefix}{next(iter(loose), '')}", "an unknown name", "no settings")
        return target()
    try:
        hints = get_type_hints(target)
        schema = dataclasses.make_dataclass(target.__name__, [(n, hints[n]) for n in names])
        merged = OmegaConf.merge(OmegaConf.structured(schema), values)
        for name in names:
            require(not OmegaConf.is_missing(merged, name), prefix + name, "nothing", "a value")
        checked = OmegaConf.to_container(merged, resolve=True)
    except ConfigKeyError as error:
        raise InputError(
            f"{prefix}{error.key}", "an unknown name", f"one of {', '.join(names)}"
        ) from error
    except OmegaConfBaseException as error:
        name = error.full_key or str(error.key or "")
        raise InputError(prefix + name, _raw(values, name), _type_name(target, name)) from error
    assert isinstance(checked, dict)
    return target(**{name: checked[name] for name in names})


def _raw(values: object, name: str) -> object:
    value = values.get(name.split(".")[0].split("[")[0]) if isinstance(values, dict) else values
    if isinstance(value, DictConfig | ListConfig):
        value = OmegaConf.to_container(value)
    return repr(value)


def _type_name(target: type[Any], name: str) -> str:
    types = {f.name: f.type for f in dataclasses.fields(target)}
    wanted = types.get(name.split(".")[0].split("[")[0], "another value")
    text = wanted.__name__ if isinstance(wanted, type) else str(wanted)
    return f"a value of type {text.replace('typing.', '')}"


def make_run(config: DictConfig, planner_name: str) -> Run:
    """Check a composed configuration and make everything that a run needs.

    Parameters
    ----------
    config : DictConfig
        As composed from ``conf``.
    planner_name : str
        Name of the planner's YAML, with the values that were overridden.

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
    require(1 <= settings.trials <= 10**7, "trials", settings.trials, "an integer from 1 to 10^7")
    require(0 <= settings.seed < 2**64, "seed", settings.seed, "an integer in [0, 2^64)")
    require(
        settings.name.replace("_", "").replace("-", "").isalnum(),
        "name",
        repr(settings.name),
        "letters, digits, - and _",
    )
    planner: Planner = build("planner", settings.planner, "planner")
    recorders: list[Recorder] = [
        build("recorder", values, f"recorder.{name}") for name, values in settings.recorder.items()
    ]
    problem = read_problem(settings)
    kept = {
        key: value
        for key, value in dataclasses.asdict(settings).items()
        if key not in ("output", "force")
    }
    return Run(
        settings.name,
        planner_name,
        problem,
        planner,
        recorders,
        settings.seed,
        settings.trials,
        OmegaConf.to_yaml(OmegaConf.create(kept)),
        settings.output,
        settings.force,
    )


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
    for name in ("start", "target"):
        require(getattr(grid, name) is not None, f"map.{name}", "null", "a field [x, y]")
    assert grid.start is not None and grid.target is not None
    rule = CornerCutting[settings.corner_cutting.upper()]
    return Problem(grid, grid.start, grid.target, rule)


def planner_from_settings(settings: str) -> Planner:
    """Make the planner that a log's settings describe.

    Parameters
    ----------
    settings : str
        `Run.settings`.

    Returns
    -------
    Planner
        The planner.

    Raises
    ------
    InputError
        If the settings are not those of this version.
    """
    loose = OmegaConf.to_container(OmegaConf.create(settings))
    require(
        isinstance(loose, dict) and isinstance(loose.get("planner"), dict),
        "settings of the log",
        "no planner",
        "the settings of a run",
    )
    assert isinstance(loose, dict)
    planner: Planner = build("planner", loose["planner"], "planner")
    return planner
