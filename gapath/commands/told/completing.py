"""What a Tab completes: names of groups and settings, and what they may be.

Hydra, which is asked for this by the script that ``-sc install=...`` prints, composes a whole
configuration for it, which takes more than a second. This looks into the YAMLs.
"""

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from gapath.discovery import kinds, parsed_yaml, yaml_names
from gapath.reference.settings import (
    CHOSEN,
    OF_HYDRA,
    ROOT,
    Setting,
    preset,
    presets,
    root,
    text_of,
)

OTHER = {
    "log": "info verify salvage rerun bag messages crate repeat view path picture movie",
    "report": "runs compare watch tag note prune archive",
    "genotype": "",
}
"""Commands that are words of this one, and their own first words."""

_LISTS = {"maps": "map", "planners": "planner", "navigators": "navigator"}

_ENGINES = ("hydra/launcher",)

_FILES = ("path", "scenario", "known_map")
"""Last parts of settings that name files."""


def complete(query: str) -> int:
    """Print what completes the line that a shell has, in ``COMP_LINE``.

    Parameters
    ----------
    query : str
        "query=bash", and other shells' names.

    Returns
    -------
    int
        Exit code 0.
    """
    line = os.environ.get("COMP_LINE", "")
    found = completions(line[: int(os.environ.get("COMP_POINT", len(line)))])
    print(("\n" if query.endswith("fish") else " ").join(found))
    return 0


def completions(line: str) -> list[str]:
    """Give the words that the last one of a command line may become.

    Parameters
    ----------
    line : str
        From its beginning to where the cursor is.

    Returns
    -------
    list of str
        Sorted; those that begin as the word does.
    """
    before, _, word = line.rpartition(" ")
    words = before.split()[1:]
    first = next(iter(words), "")
    if first in OTHER:
        found: Iterable[str] = OTHER[first].split() if len(words) == 1 else ()
    elif first == "help":
        found = [*CHOSEN, *OF_HYDRA, *(each.name for each in root().settings), *_of_help(word)]
    elif first in _LISTS:
        found = yaml_names(_LISTS[first])
    else:
        commands = [] if words else ["help", "run", *_LISTS, *OTHER]
        found = [*commands, *_overrides(word, words)]
    return sorted({each for each in found if each.startswith(word)})


def _of_help(word: str) -> list[str]:
    """Give names of all groups, and behind a group's point its settings."""
    group, point, _ = word.partition(".")
    if point and group in CHOSEN:
        return [setting.name for each in presets(group) for setting in each.settings]
    return [name for group in CHOSEN for name in yaml_names(group)]


def _overrides(word: str, words: list[str]) -> Iterator[str]:
    """Give words that choose and set, behind the marks +, ++ and ~ if there are any."""
    mark = word[: len(word) - len(word.lstrip("+~"))]
    key, equals, value = word.lstrip("+~").partition("=")
    settings = list(_settings(words))
    if equals:
        begin = value.rpartition(",")[0]
        begin += "," if begin else ""
        for each in _values(key, value, settings):
            yield f"{mark}{key}={begin}{each}"
        return
    for group in (*CHOSEN, *OF_HYDRA, *_ENGINES):
        yield f"{mark}{group}="
    for setting in settings:
        if "." in key or "." not in setting.name:
            yield f"{mark}{setting.name}="
        else:
            yield f"{mark}{setting.name.partition('.')[0]}."


def _settings(words: list[str]) -> Iterator[Setting]:
    """Give the root's settings, and those of what is chosen, by the other words or as it is."""
    yield from root().settings
    chosen: dict[str, list[str]] = {}
    for default in parsed_yaml(text_of("", ROOT))["defaults"]:
        if isinstance(default, dict):
            chosen |= {group: [name] if isinstance(name, str) else name or []
                       for group, name in default.items()}  # fmt: skip
    for word in words:
        group, _, value = word.lstrip("+").partition("=")
        chosen[group] = [name.strip() for name in value.strip("[]").split(",")]
    for group in CHOSEN:
        for name in chosen[group]:
            if name in yaml_names(group):
                yield from preset(group, name).settings


def _values(key: str, value: str, settings: list[Setting]) -> Iterator[str]:
    """Give what a group or a setting may be."""
    if key in (*CHOSEN, *OF_HYDRA, *_ENGINES):
        yield from yaml_names(key)
    elif key == "task":
        yield from kinds("task")
    for setting in settings:
        if setting.name != key:
            continue
        if key.rpartition(".")[2] in _FILES:
            yield from _files(value)
        elif setting.type == "bool":
            yield from ("true", "false")
        elif "str" in setting.type:
            yield from _words_of(setting)


def _words_of(setting: Setting) -> Iterator[str]:
    """Give the words that a range names: "one of left, right, both", '"curve" or "span"'."""
    listed = re.match(r"one of ([\w, ]+)$", setting.range)
    yield from listed[1].split(", ") if listed else re.findall(r'"(\w+)"', setting.range)


def _files(begin: str) -> Iterator[str]:
    folder, slash, name = begin.rpartition("/")
    place = Path(folder + slash)
    for path in place.iterdir() if place.is_dir() else ():
        if path.name.startswith(name):
            yield f"{folder}{slash}{path.name}" + "/" * path.is_dir()
