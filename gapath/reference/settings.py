"""What each setting means: its class says meaning and range, its YAML's comments unit and source.

A comment of a YAML is a remark on the setting in its line: "assumed; Sec. 3.3: change of a
coordinate [fields]". A unit in brackets ends it. The first comment of a YAML says what it is.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

from gapath.discovery import (
    OFFERS,
    PACKAGES,
    conf_packages,
    entry_points,
    kinds,
    parsed_yaml,
    yaml_names,
    yaml_values,
)
from gapath.reference.source import Field, SettingsClass, module, ranges_in

CHOSEN = ("map", "planner", "navigator", "recorder")
"""Groups of which a YAML is chosen."""

OF_HYDRA = ("experiment", "choice")
"""Groups whose YAMLs set what others hold."""

ROOT = "config"
"""The name of the YAML, and of the preset, that all runs begin with."""

_CLASS_OF_ROOT = ("gapath.running.config", "Root")
_CLASSES_OF_GROUPS = {"search": ("gapath.commands.search", "SearchSettings")}
_CHECKS_OF_ROOT = ("gapath.running.config", "gapath.running.shards")
"""Where the root's own settings are checked; the groups of its tasks check theirs."""


@dataclass(frozen=True)
class Setting:
    """A setting, with its value in some YAML.

    Parameters
    ----------
    name : str
        Its whole name, "planner.population".
    value : object
        What the YAML sets.
    type : str
        Of its field.
    meaning, range : str
        What it means, and what it may be.
    unit : str
        Of its number; empty for what is none.
    remark : str
        The comment in the YAML, or in the one that it stands on, without the unit.
    source : str
        "KG18 Sec. 3.3", "assumed", both, or "gapath" for what no paper has.
    """

    name: str
    value: Any
    type: str
    meaning: str
    range: str
    unit: str
    remark: str
    source: str


@dataclass(frozen=True)
class Preset:
    """A YAML of a group: what can be chosen.

    Parameters
    ----------
    group, name, kind : str
        ``group=name`` chooses it; its component.
    about : str
        What its first comment says.
    settings : tuple of Setting
        All of its settings.
    """

    group: str
    name: str
    kind: str
    about: str
    settings: tuple[Setting, ...]


@dataclass(frozen=True)
class Remarks:
    """Comments of a YAML: the first one, and those of settings by their dotted names."""

    about: str
    of: dict[str, str]


def text_of(group: str, name: str) -> str:
    """Give a YAML's text: "" and `ROOT` for the root's."""
    places = [files(package) / group / f"{name}.yaml" for package in conf_packages()]
    return next(place for place in places if place.is_file()).read_text("utf-8")


def remarks(text: str) -> Remarks:
    """Read the comments of a YAML.

    Parameters
    ----------
    text : str
        The YAML.

    Returns
    -------
    Remarks
        A comment that goes on in lines of its own is one.
    """
    title: list[str] = []
    found: dict[str, str] = {}
    stack: list[tuple[int, str]] = []
    for line in text.splitlines():
        before, mark, comment = line.partition("# ")
        key = re.match(r"( *)(\w+):(?: |$)", before)
        if key:
            indent = len(key[1])
            stack = [each for each in stack if each[0] < indent] + [(indent, key[2])]
        if mark and not comment.startswith("@"):
            name = ".".join(each[1] for each in stack)
            if key or (name and not before.strip()):
                found[name] = " ".join([found.get(name, ""), comment.strip()]).strip()
            elif not stack:
                title.append(comment.strip())
    return Remarks(" ".join(title), found)


def about(group: str, name: str) -> str:
    """Say what a YAML is: its first comment."""
    return remarks(text_of(group, name)).about


@lru_cache
def all_remarks(group: str, name: str) -> Remarks:
    """Give a YAML's comments, and those of the YAMLs that it stands on where it has none."""
    text = text_of(group, name)
    own = remarks(text)
    bases = [each for each in parsed_yaml(text).get("defaults", []) if each != "_self_"]
    found: dict[str, str] = {}
    for base in bases if group in CHOSEN else []:
        inner = all_remarks(group, str(base))
        found |= {key: _of_paper(text, inner.about) for key, text in inner.of.items()}
    return Remarks(own.about, found | own.of)


_PLACE = re.compile(
    r"(?:(KG18|S04|M22)(?:'s)? )?"
    r"(Secs?\. [IVX\d]+(?:\.[A-Z\d]+)*|Table [IVX\d]+|Figs?\.? \d+|eq\. \(\d+\))"
)


def _of_paper(remark: str, title: str) -> str:
    """Say of which paper the first place is that a remark names; the YAML tells."""
    place, paper = _PLACE.search(remark), re.search(r"KG18|S04|M22", title)
    if place is None or place[1] or paper is None:
        return remark
    return f"{remark[: place.start()]}{paper[0]} {remark[place.start() :]}"


def source_of(remark: str, title: str) -> str:
    """Say where a value comes from: a place in a paper, an assumption, or gapath itself."""
    place = _PLACE.search(_of_paper(remark, title)) or _PLACE.search(_of_paper(title, title))
    assumed = "assumed" if re.search(r"\bassumed\b", remark) else ""
    cited = f"{place[1] or ''} {place[2]}".strip() if place and place[1] else ""
    if remark and not _PLACE.search(remark):  # then the title's place is another setting's
        cited = ""
    return ", ".join(filter(None, [cited, assumed])) or "gapath"


def class_of(group: str, kind: str) -> SettingsClass:
    """Give the class of a component's settings; of a task's group of settings that of the group."""
    entry = entry_points(PACKAGES[group]).get(kind)
    place = entry.value if entry else f"{PACKAGES[group]}.{kind}"
    found = module(place).settings(OFFERS[group][0])
    assert found is not None, f"{place} has no dataclass {OFFERS[group][0]}"
    return found


@lru_cache
def preset(group: str, name: str) -> Preset:
    """Tell what a YAML of a group is, and what its settings mean."""
    values, said = yaml_values(group, name), all_remarks(group, name)
    kind = str(values.pop("kind"))
    prefix = f"{group}.{name}" if group == "recorder" else group
    settings = _settings(class_of(group, kind), prefix, "", values, said)
    return Preset(group, name, kind, said.about, tuple(settings))


def _settings(
    shape: SettingsClass, prefix: str, inner: str, values: dict[str, Any], said: Remarks
) -> Iterator[Setting]:
    for field in shape.fields.values():
        here = f"{inner}{field.name}"
        if field.inner is not None:
            below = values.get(field.name) or {}
            yield from _settings(field.inner, prefix, f"{here}.", below, said)
        elif field.name in values:
            remark = said.of.get(here, "")
            yield _setting(field, f"{prefix}.{here}", values[field.name], remark, said.about)


def _setting(field: Field, name: str, value: Any, remark: str, title: str) -> Setting:
    found = re.search(r" ?\[([a-z][a-z ]*)\]$", remark)
    unit, plain = (found[1], remark[: found.start()]) if found else ("", remark)
    return Setting(name, value, field.type, field.meaning, field.range, unit,
                   _of_paper(plain, title), source_of(plain, title))  # fmt: skip


@lru_cache
def root() -> Preset:
    """Tell what the settings of ``conf/config.yaml`` are: those of no group that is chosen."""
    values, said = parsed_yaml(text_of("", ROOT)), remarks(text_of("", ROOT))
    shape = module(_CLASS_OF_ROOT[0]).settings(_CLASS_OF_ROOT[1])
    assert shape is not None
    ranges = {key: right for place in _CHECKS_OF_ROOT
              for key, right in ranges_in(module(place), module(place).tree).items()}  # fmt: skip
    own = []
    for field in shape.fields.values():
        if field.name in values:
            right = ranges.get(field.name, field.range)
            known = Field(field.name, field.type, field.meaning, right, None)
            remark = said.of.get(field.name, "")
            own.append(_setting(known, field.name, values[field.name], remark, said.about))
    for group, inner in groups_of_tasks().items():
        own += _settings(inner, group, "", values[group], _within(group, said))
    return Preset("", ROOT, "", said.about, tuple(own))


def _within(group: str, said: Remarks) -> Remarks:
    begin = f"{group}."
    inner = {key[len(begin) :]: text for key, text in said.of.items() if key.startswith(begin)}
    return Remarks(said.about, inner)


def groups_of_tasks() -> dict[str, SettingsClass]:
    """Give the groups of settings of which none is chosen: those of tasks, and of a search."""
    found: dict[str, SettingsClass] = {}
    for task in kinds("task"):
        found |= class_of("task", task).mapping("shapes")
    for group, (place, name) in _CLASSES_OF_GROUPS.items():
        shape = module(place).settings(name)
        assert shape is not None
        found[group] = shape
    return found


def presets(group: str) -> list[Preset]:
    """Give all that can be chosen in a group."""
    return [preset(group, name) for name in yaml_names(group)]


def shown(value: Any) -> str:
    """Write a value as a YAML or a command line has it."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {shown(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(shown, value)) + "]"
    if value is None or isinstance(value, bool):
        return str(value).lower().replace("none", "null")
    return str(value)
