"""What a run's map and method are called in tables: by name, and what differs from the YAML."""

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml

from gapath.components import yaml_names, yaml_values

_SHOWN_APART = ("path", "start", "target", "scenario", "problem", "map_class", "drawing", "number",
                "instance")  # fmt: skip
"""Settings of maps that are their name, or what tables have columns for."""


def method_name(config: Mapping[str, Any], choices: Mapping[str, str]) -> str:
    """Name what a run tries: its planner's or navigator's YAML, and what differs from it.

    Parameters
    ----------
    config : mapping
        As composed from ``conf``.
    choices : mapping
        Configuration group -> name of the chosen YAML.

    Returns
    -------
    str
        For example "ga3", "ga3[population=60]" or "kg18[corner_cutting=forbid,sensor.range=8]".
    """
    group = "navigator" if config.get("task") == "drive" else "planner"
    plain = yaml.safe_load((files("gapath.conf") / "config.yaml").read_text("utf-8"))
    given = _leaves(config.get(group)) | {"corner_cutting": config.get("corner_cutting")}
    usual = {"corner_cutting": plain["corner_cutting"]}
    if choices[group] in yaml_names(group):
        usual |= _leaves(yaml_values(group, choices[group]))
    else:  # a YAML of the user's own
        usual |= _leaves(config.get(group))
    if group == "navigator":
        given |= _leaves(config.get("drive"))
        given["known_map"] = given["known_map"] and _title(str(given["known_map"]))
        usual |= _leaves(plain["drive"])
    return _with_changes(choices[group], given, usual)


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
    return _with_changes(title, given, _usual(settings["kind"]))


def _usual(kind: str) -> dict[str, Any]:
    """Give the values of a kind's YAML; of drawn maps, which have one each, those of any."""
    names = yaml_names("map")
    every = (yaml_values("map", name) for name in ([kind] if kind in names else names))
    return next(values for values in every if values["kind"] == kind)


def _title(path: str) -> str:
    """Name a file without its ending; most maps of ROS are called map, in a folder of their own."""
    file = Path(path)
    folder = file.parent.name
    return folder if file.stem == "map" and folder not in ("", "..") else file.stem


def _with_changes(name: str, given: Mapping[str, object], usual: Mapping[str, object]) -> str:
    changed = [f"{key}={value}" for key, value in given.items() if usual.get(key) != value]
    gone = [key for key in usual if key not in given and "[" in key]  # of a list that is shorter
    changed += [f"{key}=none" for key in gone]
    return f"{name}[{','.join(sorted(changed))}]" if changed else name


def _leaves(value: object, name: str = "") -> dict[str, object]:
    """Flatten nested settings: dotted name -> value."""
    if isinstance(value, dict):
        items = [(f"{name}.{key}".lstrip("."), item) for key, item in value.items()]
    elif isinstance(value, list):
        items = [(f"{name}[{i}]", item) for i, item in enumerate(value)]
    else:
        return {name: value}
    return {leaf: item for key, part in items for leaf, item in _leaves(part, key).items()}
