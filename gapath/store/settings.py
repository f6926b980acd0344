"""A run's settings as data: flat, and as the text that a log keeps; and data of other YAMLs.

A flat mapping has a value for each dotted name, lists are indexed: ``planner.population``,
``map.start[0]``, ``navigator.replan[1].control_points``. Empty lists and mappings have names
that end in ``[]`` and ``.``, and no value.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias, cast

import yaml

from gapath.errors import InputError, require

Value: TypeAlias = str | int | float | bool | None
Flat: TypeAlias = Mapping[str, Value]

_OF_LIST = re.compile(r"([^[]+)\[")
_UNEVEN = re.compile(r"\[|\.$", re.MULTILINE)
"""In names of settings that are no columns' names: of lists, or of an empty mapping."""

MAX_YAML_BYTES = 1 << 16
"""Bytes of the largest YAML that is read; so many characters, too."""

MAX_TEXT = 1 << 20
"""Characters of the longest settings that a log may have: recorders' lists of trials are long."""

MOST_NODES, DEEPEST = 10_000, 32
"""Values of a YAML, each as often as it stands for, and mappings and lists within one another."""

LONGEST_WHOLE = 400
"""Characters of a whole number; Python refuses to show one of 4300 digits."""

_WHOLE = re.compile(r"[-+]?[0-9][0-9a-fA-FxobXOB_:]*")
"""Whatever YAML takes for a whole number, and words that begin like one."""
_INT = "tag:yaml.org,2002:int"

_STEP = re.compile(r"\[(\d{0,9})\]|\.?([^.\[\]]+)|\.$")


def flatten(value: object, name: str = "") -> dict[str, Value]:
    """Make nested settings flat.

    Parameters
    ----------
    value : object
        Mappings and lists of mappings, lists and values.
    name : str
        What stands before all names.

    Returns
    -------
    dict of str to str, int, float, bool or None
        In the order of the settings.
    """
    if isinstance(value, Mapping):
        items = [(f"{name}.{key}".lstrip("."), item) for key, item in value.items()]
        empty = f"{name}."
    elif isinstance(value, list | tuple):
        items = [(f"{name}[{i}]", item) for i, item in enumerate(value)]
        empty = f"{name}[]"
    else:
        plain = value is None or isinstance(value, str | int | float | bool)
        require(plain, f"setting {name}", value, "text, a number, true, false or null")
        return {name: cast(Value, value)}
    if not items:
        return {empty: None} if name else {}
    return {leaf: item for key, part in items for leaf, item in flatten(part, key).items()}


def nested(settings: Flat) -> dict[str, Any]:
    """Undo `flatten`.

    Parameters
    ----------
    settings : mapping
        Flat settings.

    Returns
    -------
    dict
        Nested settings.

    Raises
    ------
    InputError
        If a name is none, or does not fit the others.
    """
    root: dict[str, Any] = {}
    for name, value in settings.items():
        steps = list(_STEP.finditer(name))
        good = steps and "".join(step.group() for step in steps) == name
        require(bool(good), f"setting {name}", repr(value), "a name such as planner.population")
        _put(root, [_key(step) for step in steps], name, value)
    return root


def _key(step: re.Match[str]) -> str | int | None:
    """Give a key of a mapping, an index of a list, or None for the end of something empty."""
    if step.group(1):
        return int(step.group(1))
    return step.group(2)


def _put(root: dict[str, Any], keys: list[str | int | None], name: str, value: Value) -> None:
    place: Any = root
    for i, key in enumerate(keys):
        last = i == len(keys) - 1
        ends_empty = i == len(keys) - 2 and keys[-1] is None
        inner: Any = value
        if ends_empty:
            inner = [] if name.endswith("[]") else {}
        elif not last:
            inner = [] if isinstance(keys[i + 1], int) else {}
        if isinstance(place, list) and key == len(place):
            place.append(inner)
        elif isinstance(place, dict) and isinstance(key, str):
            inner = place.setdefault(key, inner)
        elif not (isinstance(place, list) and isinstance(key, int) and key == len(place) - 1):
            raise InputError(f"setting {name}", repr(value), "a name that fits the others")
        if ends_empty:
            return
        place = place[key]


def tabular(settings: Flat) -> dict[str, Value]:
    """Give settings as columns of a table have them: a value each, lists as JSON.

    Parameters
    ----------
    settings : mapping
        Flat settings.

    Returns
    -------
    dict of str to str, int, float, bool or None
        For example ``map.start``: "[0, 0]" instead of ``map.start[0]`` and ``map.start[1]``.
    """
    if not _UNEVEN.search("\n".join(settings)):
        return dict(settings)
    found: dict[str, Value] = {}
    lists: dict[str, dict[str, Value]] = {}
    for name, value in settings.items():
        of_list = _OF_LIST.match(name)
        if of_list:
            found[of_list.group(1)] = None  # its place
            lists.setdefault(of_list.group(1), {})[name] = value
        elif name.endswith("."):
            found[name[:-1]] = "{}"
        else:
            found[name] = value
    for stem, items in lists.items():
        part: Any = nested(items)
        for key in stem.split("."):
            part = part[key]
        found[stem] = json.dumps(part)
    return found


def text_of(settings: Flat) -> str:
    """Write flat settings as text, a line each, which is YAML too.

    Parameters
    ----------
    settings : mapping
        Flat settings.

    Returns
    -------
    str
        Lines ``name: value``, the values as JSON.
    """
    return "".join(f"{name}: {json.dumps(value)}\n" for name, value in settings.items())


def of_text(text: str) -> dict[str, Value]:
    """Read what `text_of` wrote: plain values only, whoever wrote it.

    Parameters
    ----------
    text : str
        Lines ``name: value``.

    Returns
    -------
    dict of str to str, int, float, bool or None
        Flat settings.

    Raises
    ------
    InputError
        If it is not just as `text_of` writes it, is longer than `MAX_TEXT`, has more than
        `MOST_NODES` settings, asks for what stands elsewhere (``${...}``), or has a name of more
        parts than `DEEPEST`.
    """
    settings: dict[str, Value] = {}
    size = len(text)
    require(size <= MAX_TEXT, "settings", f"{size} characters", f"at most {MAX_TEXT}")
    for line in text.removesuffix("\n").split("\n") if text else ():
        name, colon, shown = line.partition(": ")
        try:
            value = json.loads(shown)
            str(value).encode()  # half a character, as JSON may have it, is no text
        except (ValueError, RecursionError) as error:
            raise InputError("settings", line, "name: value") from error
        plain = value is None or isinstance(value, str | int | float | bool)
        require(bool(colon) and plain and name not in settings, "settings", line, "name: value")
        require("${" not in line, "settings", line, "plain values, nothing to be filled in")
        require(len(_STEP.findall(name)) <= DEEPEST, "settings", line, "a shorter name")
        settings[name] = value
        require(len(settings) <= MOST_NODES, "settings", "too many", f"at most {MOST_NODES}")
    require(text == text_of(settings), "settings", "other text", "lines as gapath writes them")
    return settings


def written(value: Value) -> str:
    """Write a setting's value for people, as YAML has it: null, true, text without quotes."""
    return json.dumps(value) if value is None or isinstance(value, bool) else str(value)


def read_settings(path: Path) -> dict[str, Value]:
    """Read a run folder's ``config.yaml``.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    dict of str to str, int, float, bool or None
        Flat settings.

    Raises
    ------
    InputError
        If it cannot be read, or holds something else.
    """
    content = plain_yaml(path, path.name, "readable YAML")
    require(isinstance(content, dict), path.name, type(content).__name__, "a mapping of settings")
    return flatten(content)


def plain_yaml(given: str | Path, where: str, expected: str) -> Any:
    """Read YAML from whoever wrote it as plain data, and no more of it than stands there.

    Parameters
    ----------
    given : str or Path
        The YAML, or its file.
    where : str
        Where it stands, for messages.
    expected : str
        What would be right.

    Returns
    -------
    object
        Mappings, lists, text, numbers, dates, true, false or null.

    Raises
    ------
    InputError
        If it cannot be read or is no YAML, or longer than `MAX_YAML_BYTES`, of more than
        `MOST_NODES` values, all aliases followed, nested more deeply than `DEEPEST`, or has tags
        that make other things, or a whole number of more than `LONGEST_WHOLE` characters.
    """
    try:
        text = given if isinstance(given, str) else _text_of_file(given, where, expected)
        size = len(text)
        require(size <= MAX_YAML_BYTES, where, f"{size} characters", f"at most {MAX_YAML_BYTES}")
        _check_bounds(text, where)
        return yaml.safe_load(text)
    except InputError:
        raise
    except OSError as error:
        raise InputError(where, error.strerror, expected) from error
    except (yaml.YAMLError, ValueError, OverflowError, TypeError, AttributeError) as error:
        reason = " ".join(str(error).split("\n")[0].split())
        raise InputError(where, f"text that is no YAML ({reason})", expected) from error


def _text_of_file(path: Path, where: str, expected: str) -> str:
    regular = path.is_file()  # a pipe would wait for somebody who writes
    require(regular, where, "no file" if path.exists() else "no such file", expected)
    with path.open("rb") as file:
        return file.read(MAX_YAML_BYTES + 1).decode("utf-8-sig")


def _check_bounds(text: str, where: str) -> None:
    """Count values without making any: an alias counts as all that it stands for."""
    sizes: dict[str | None, int] = {}
    within: list[tuple[str | None, int]] = []
    count = 0
    for event in yaml.parse(text, yaml.SafeLoader):
        if isinstance(event, yaml.AliasEvent):
            endless = any(event.anchor == anchor for anchor, _ in within)
            count += MOST_NODES + 1 if endless else sizes.get(event.anchor or "", 1)
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, before = within.pop()
            if anchor:
                sizes[anchor] = count - before
        elif isinstance(event, yaml.NodeEvent):
            if isinstance(event, yaml.CollectionStartEvent):
                within.append((event.anchor, count))
            elif event.anchor:
                sizes[event.anchor] = 1
            if isinstance(event, yaml.ScalarEvent) and len(event.value) > LONGEST_WHOLE:
                plain = event.implicit[0] and _WHOLE.fullmatch(event.value)  # no quoted text
                if plain or event.tag == _INT:
                    raise yaml.YAMLError(f"a whole number of {len(event.value)} characters")
            count += 1
        most = f"at most {MOST_NODES} values, each alias counted as what it stands for"
        require(count <= MOST_NODES, where, "too many values", most)
        most = f"at most {DEEPEST} within one another"
        require(len(within) <= DEEPEST, where, "too many nested lists or mappings", most)
