"""What there is: components by kind and YAMLs by name, of gapath and of installed packages.

A package of one's own adds components by entry points. Their group is the name of gapath's own
package of such modules, for example ``gapath.planners``; their name is the kind, their value a
module. An entry point of the group ``gapath.conf`` names a package that holds YAMLs as ``conf``
does: ``planner/NAME.yaml``.
"""

import copy
import importlib
import importlib.util
import pkgutil
import traceback
from dataclasses import is_dataclass
from functools import lru_cache
from importlib import metadata
from importlib.resources import files
from pathlib import Path
from types import ModuleType
from typing import Any

import yaml

from gapath.errors import FAULTS, InputError, one_of, require, require_all

PACKAGES = {
    "map": "gapath.mapio",
    "planner": "gapath.planners",
    "navigator": "gapath.navigators",
    "recorder": "gapath.recorders",
    "task": "gapath.tasks",
    "metric": "gapath.metrics",
}
"""What is found -> the package that holds a module for each kind of it."""

OFFERS = {
    "map": ("Reader", "read"),
    "planner": ("Planner", "exact minimises plan"),
    "navigator": ("Navigator", "complete begin step"),
    "recorder": ("Recorder", "records check open record close abort"),
    "task": ("Task", "name groups shapes row success threaded events make read told_optimum check"
                     " optimum trials summary line"),
}  # fmt: skip
"""The class that such a module offers, and what that must have; a metric is a module by itself."""


@lru_cache
def entry_points(group: str) -> dict[str, metadata.EntryPoint]:
    """Give the entry points of installed packages in a group, by name.

    Parameters
    ----------
    group : str
        For example "gapath.planners".

    Returns
    -------
    dict of str to EntryPoint
        In the order of their names.

    Raises
    ------
    InputError
        If two packages use the same name.
    """
    found: dict[str, metadata.EntryPoint] = {}
    for entry in sorted(metadata.entry_points(group=group), key=lambda entry: entry.name):
        other = found.setdefault(entry.name, entry)
        one = other.value == entry.value  # an installed package may be seen twice
        both = f"{other.value} and {entry.value}"
        require(one, f"entry point {group}: {entry.name}", both, "one package with that name")
    return found


@lru_cache
def kinds(group: str) -> list[str]:
    """List what a group's ``kind`` can name.

    Parameters
    ----------
    group : str
        A key of `PACKAGES`.

    Returns
    -------
    list of str
        Modules of gapath's own package, those with a leading underscore left out, and entry
        points.

    Raises
    ------
    InputError
        If an installed package uses a name of gapath's own.
    """
    package = importlib.import_module(PACKAGES[group])
    own = [module.name for module in pkgutil.iter_modules(package.__path__)]
    own = [name for name in own if not name.startswith("_")]
    others = entry_points(PACKAGES[group])
    for name in own:
        require(
            name not in others,
            f"entry point {PACKAGES[group]}: {name}",
            others[name].value if name in others else "",
            "a name that gapath does not use itself",
        )
    return sorted([*own, *others])


def load(group: str, kind: str) -> Any:
    """Import a component.

    Parameters
    ----------
    group : str
        A key of `PACKAGES`.
    kind : str
        One of `kinds`.

    Returns
    -------
    type or module
        The class of `OFFERS`; the module itself where a group has none.

    Raises
    ------
    InputError
        If an installed package's module cannot be imported or does not offer it whole.
    """
    other = entry_points(PACKAGES[group]).get(kind)
    if other is None:
        module = importlib.import_module(f"{PACKAGES[group]}.{kind}")
    else:
        module = imported(other)
    if group not in OFFERS:
        return module
    name, needed = OFFERS[group]
    require_all(module, module.__name__, {name: type})
    offered, where = getattr(module, name), f"{module.__name__}.{name}"
    require_all(offered, where, dict.fromkeys(needed.split(), object))
    good = group == "task" or is_dataclass(offered)
    require(good, where, "a class that is none", "a dataclass of its settings")
    return offered


def component_of(error: BaseException) -> str:
    """Name the component that raised an error: the innermost one, "planner astar"; "" if none."""
    own = [(group, kind) for group in PACKAGES for kind in kinds(group)]
    homes = {
        entry.value if (entry := entry_points(PACKAGES[group]).get(kind))
        else f"{PACKAGES[group]}.{kind}": f"{group} {kind}"
        for group, kind in own
    }  # fmt: skip
    found = ""
    for frame, _ in traceback.walk_tb(error.__traceback__):
        module = str(frame.f_globals.get("__name__"))
        found = next((homes[m] for m in (module, module.rpartition(".")[0]) if m in homes), found)
    return found


def imported(entry: metadata.EntryPoint) -> ModuleType:
    """Import the module that an entry point of an installed package names.

    Raises
    ------
    InputError
        If it cannot be imported.
    """
    try:
        return importlib.import_module(entry.value)
    except FAULTS as error:  # what it does when imported is its own
        where = f"entry point {entry.group}: {entry.name} = {entry.value}"
        raise InputError(where, repr(error), "a module that can be imported") from error


@lru_cache
def readers() -> dict[str, str]:
    """Tell which map reader reads which files: kinds by the ending of a file name."""
    found: dict[str, str] = {}
    for kind in kinds("map"):
        found |= dict.fromkeys(getattr(_module_of(kind), "SUFFIXES", ()), kind)
    return found


def reader_of(path: str, where: str) -> str:
    """Tell which reader reads a file.

    Parameters
    ----------
    path : str
        The file.
    where : str
        The setting that names it, for messages.

    Returns
    -------
    str
        A kind of map reader.

    Raises
    ------
    InputError
        If no reader knows the file's ending; one may say why (``UNCLEAR``).
    """
    for suffix, kind in readers().items():
        if path.lower().endswith(suffix):
            return kind
    right = f"a file name ending in {', '.join(readers())}"
    for kind in kinds("map"):
        unclear = getattr(_module_of(kind), "UNCLEAR", {})
        right = next((unclear[end] for end in unclear if path.lower().endswith(end)), right)
    raise InputError(where, path, right)


def _module_of(kind: str) -> ModuleType:
    """Give the module of a map reader."""
    return importlib.import_module(load("map", kind).__module__)


def with_setting(group: str, setting: str) -> str:
    """Say which choices of a group have a setting.

    Parameters
    ----------
    group : str
        A folder of ``conf``.
    setting : str
        Name of a setting in its YAMLs.

    Returns
    -------
    str
        For example "map=rosmap or map=image"; empty if none has it.
    """
    names = [f"{group}={name}" for name in yaml_names(group) if setting in yaml_values(group, name)]
    return " or ".join(names)


@lru_cache
def conf_packages() -> list[str]:
    """Give the packages that hold YAMLs: gapath's own first, whose names win."""
    return ["gapath.conf", *(entry.value for entry in entry_points("gapath.conf").values())]


def yaml_names(group: str) -> list[str]:
    """List the YAMLs of a group.

    Parameters
    ----------
    group : str
        A folder of ``conf``.

    Returns
    -------
    list of str
        File names without their ending.
    """
    folders = [files(package) / group for package in conf_packages()]
    paths = [path for folder in folders if folder.is_dir() for path in folder.iterdir()]
    return sorted({path.name[:-5] for path in paths if path.name.endswith(".yaml")})


def yaml_values(group: str, name: str) -> dict[str, Any]:
    """Read a YAML of ``conf`` and those that its defaults list names.

    Parameters
    ----------
    group : str
        A folder of ``conf``, for example "planner".
    name : str
        For example "kg18_test3" or "ga3".

    Returns
    -------
    dict
        ``kind`` and the settings.

    Raises
    ------
    InputError
        If there is no such YAML.
    """
    candidates = [files(package) / group / f"{name}.yaml" for package in conf_packages()]
    file = next((path for path in candidates if path.is_file()), None)
    if file is None:
        raise InputError(group, name, one_of(name, yaml_names(group)))
    own = parsed_yaml(file.read_text("utf-8"))
    bases = [base for base in own.pop("defaults", []) if base != "_self_"]
    values: dict[str, Any] = {}
    for base in bases:
        values |= yaml_values(group, base)
    return values | own


def parsed_yaml(text: str) -> dict[str, Any]:
    """Parse a YAML of gapath's own, whose text a sweep reads again for each job, once."""
    return copy.deepcopy(_parsed(text))


@lru_cache
def _parsed(text: str) -> dict[str, Any]:
    values: dict[str, Any] = yaml.safe_load(text)
    return values


def _all_entry_points() -> list[metadata.EntryPoint]:
    groups = (*PACKAGES.values(), "gapath.conf", "gapath.pipelines")
    return [entry for group in groups for entry in entry_points(group).values()]


def other_packages() -> dict[str, str]:
    """Give the installed packages that add components: name -> version."""
    found = {e.dist.name: e.dist.version for e in _all_entry_points() if e.dist is not None}
    return dict(sorted(found.items()))


@lru_cache
def other_folders() -> dict[str, Path]:
    """Give the places of installed packages that add components: name -> folder, or one module."""
    modules = {entry.value.partition(".")[0] for entry in _all_entry_points()}
    found = {}
    for module in sorted(modules):
        spec = importlib.util.find_spec(module)
        if spec and spec.origin:
            file = Path(spec.origin)
            found[module] = file.parent if spec.submodule_search_locations else file
    return found


@lru_cache
def other_files() -> list[tuple[str, Path]]:
    """List the files of installed packages that add components: what they hold changes results.

    Returns
    -------
    list of (str, Path)
        Each file's name, with its package's folder as the first part, and where it is; what is
        hidden or compiled is left out.
    """
    found = []
    for module, top in other_folders().items():
        if top.is_file():
            found.append((top.name, top))
            continue
        for path in sorted(top.rglob("*")):
            name = path.relative_to(top)
            hidden = any(part.startswith((".", "__pycache__")) for part in name.parts)
            if path.is_file() and not hidden:
                found.append((f"{module}/{name.as_posix()}", path))
    return found
