"""What an experiment may be called, and what a run's map and method are called in tables.

These have the name of a YAML, and what differs from it.
"""

from collections.abc import Collection, Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from gapath.discovery import parsed_yaml, yaml_names, yaml_values
from gapath.errors import require
from gapath.store.settings import Value, flatten, written

if TYPE_CHECKING:
    from gapath.task import Task  # which takes long, and is not needed to write names

_SHOWN_APART = ("path", "start", "target", "scenario", "problem", "map_class", "drawing", "number",
                "instance")  # fmt: skip
"""Settings of maps that are their name, or what tables have columns for."""


RESERVED = ("bench", "compare", "report")
"""Folders of outputs that hold no runs."""


def check_name(name: str) -> None:
    """Raise InputError for what no experiment may be called."""
    plain = name.replace("_", "").replace("-", "").isalnum()
    require(plain, "name", repr(name), "letters, digits, - and _")
    require(name not in RESERVED, "name", name, "another: the report's files lie there")


class Method(NamedTuple):
    """What a run tries: a YAML of a planner or navigator, and what differs from it."""

    preset: str
    """Name of the YAML."""
    changes: Mapping[str, Value] = MappingProxyType({})
    """Settings that differ: flat name -> value; "none" for what a shorter list lacks."""

    @property
    def name(self) -> str:
        """The name in tables: "ga3[population=60]", "kg18[sensor.range=8]"."""
        shown = ((key.partition(".")[2] or key, value) for key, value in self.changes.items())
        return with_changes(self.preset, shown)


def method_of(
    task: "type[Task]",
    config: Mapping[str, Any],
    choices: Mapping[str, str | None],
    overridden: Collection[str] = (),
) -> Method:
    """Tell what a run tries.

    Parameters
    ----------
    task : type
        Its task.
    config : mapping
        As composed from ``conf``.
    choices : mapping
        Configuration group -> name of the chosen YAML.
    overridden : collection of str
        Settings that the command line sets: what differs from a YAML of the user's own, which is
        not read again.

    Returns
    -------
    Method
        The YAML of the task's first group, and what differs from it and from the usual values of
        the other groups.
    """
    plain = usual_values()
    given: dict[str, Value] = {"corner_cutting": config.get("corner_cutting")}
    usual: dict[str, Value] = {"corner_cutting": plain["corner_cutting"]}
    for group in task.groups:
        name, flat = choices.get(group), flatten(config.get(group), group)
        given |= flat
        if name in yaml_names(group):
            usual |= flatten(yaml_values(group, str(name)), group)
        elif group in plain:
            usual |= flatten(plain[group], group)
        else:
            changed = [name for name in overridden if name != group]  # that chose the YAML
            usual |= {key: value for key, value in flat.items() if not _within(key, changed)}
    return Method(str(choices[task.groups[0]]), changes_of(given, usual))


def usual_values() -> dict[str, Any]:
    """Read ``conf/config.yaml``: what is set where nobody says otherwise."""
    return parsed_yaml((files("gapath.conf") / "config.yaml").read_text("utf-8"))


def _within(key: str, settings: Collection[str]) -> bool:
    return any(key == name or key.startswith((f"{name}.", f"{name}[")) for name in settings)


def map_name(name: str, settings: Mapping[str, Any]) -> str:
    """Name a map so that other maps of the same file are called otherwise.

    Parameters
    ----------
    name : str
        As its reader calls it.
    settings : mapping
        ``map`` of the configuration.

    Returns
    -------
    str
        For example "barn_000" or "barn_000[inflation=1]".
    """
    path = str(settings.get("path") or "")
    title = _title(path) if Path(path).stem == name else name
    given = {key: value for key, value in settings.items() if key not in _SHOWN_APART}
    changes = changes_of(flatten(given), flatten(_usual(name, settings["kind"])))
    return with_changes(title, changes.items())


def _usual(name: str, kind: str) -> dict[str, Any]:
    """Give the values of a map's own YAML, else of its kind's, else of any map of that kind."""
    names = yaml_names("map")
    every = (yaml_values("map", n) for n in (name, kind, *names) if n in names)
    return next((values for values in every if values["kind"] == kind), {})


def _title(path: str) -> str:
    """Name a file without its ending; most maps of ROS are called map, in a folder of their own."""
    file = Path(path)
    folder = file.parent.name
    return folder if file.stem == "map" and folder not in ("", "..") else file.stem


def changes_of(given: Mapping[str, Value], usual: Mapping[str, Value]) -> dict[str, Value]:
    """Give the settings that differ from usual ones, "none" for what a shorter list lacks."""
    if given.get("drive.known_map"):
        given = {**given, "drive.known_map": _title(str(given["drive.known_map"]))}
    changed = {key: value for key, value in given.items() if usual.get(key) != value}
    gone = [key for key in usual if key not in given and "[" in key]  # of a list that is shorter
    return changed | dict.fromkeys(gone, "none")


def with_changes(name: str, changes: Iterable[tuple[str, Value]]) -> str:
    """Write a name and, in brackets behind it, what differs: for people, nobody reads it back."""
    shown = sorted(f"{key}={written(value)}" for key, value in changes)
    return f"{name}[{','.join(shown)}]" if shown else name
