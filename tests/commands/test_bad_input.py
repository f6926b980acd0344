"""Bad input by table: one line that names the field, exit code 2, and nothing written.

Settings are found, not listed: every value of every component's YAML, each with all that cannot
stand there, so that a new component is tested by being there.
"""

import copy
import math
from dataclasses import is_dataclass
from pathlib import Path
from typing import get_args, get_origin, get_type_hints

import pytest
import yaml

from gapath.components import build, expanded, typed
from gapath.discovery import kinds, load, yaml_names, yaml_values
from gapath.errors import InputError
from gapath.running.config import Root, conf_folder
from gapath.task import find_task

ODD = [-1, 0, 1e300, [], "\x1b[2J\n" + "x" * 10**5, "${x}"]
"""What must be refused by name, or taken; a huge number may be one that a setting takes."""

GROUPS = ("map", "planner", "navigator", "recorder")


def components():
    """Of each kind of each group one YAML: group, name and all values, written out."""
    for group in GROUPS:
        done = set()
        for name in yaml_names(group):
            values = expanded(yaml_values(group, name), group)
            values = {k: "a.map" if v == "???" else v for k, v in values.items()}
            if values["kind"] not in done:
                done.add(values["kind"])
                yield group, name, values
        assert done == set(kinds(group))


def leaves(group, values, path=()):
    """Places of settings, of those of planners within too, and the types that each may have."""
    hints = get_type_hints(load(group, values["kind"]))
    for name, value in values.items():
        planners = [((name,), value)]
        if isinstance(value, list):
            planners = [((name, i), item) for i, item in enumerate(value)]
        inner = [(place, item) for place, item in planners if isinstance(item, dict)]
        for place, item in inner[:1]:
            yield from leaves("planner", item, (*path, *place))
        if name in hints and not inner:
            yield (*path, name), types_of(hints[name])


def types_of(hint):
    return (hint,) if get_origin(hint) is list else get_args(hint) or (hint,)


def wrong_for(types):
    """What a setting of these types cannot be, in whatever range."""
    lists = any(get_origin(each) is list or each is list for each in types)
    wrong = [{"a": 1}, {}]
    wrong += [[1], [None], [math.nan], [[]]] if not lists else [[None], [math.nan], [[]], 5, "abc"]
    wrong += [None] if type(None) not in types else []
    if str not in types:
        wrong += ["abc", "1e400", "", math.nan, math.inf, -math.inf]
        wrong += [2.5, 10**30, -(10**30)] if float not in types else []
    return wrong


def with_value(values, path, value):
    changed = place = copy.deepcopy(values)
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = copy.deepcopy(value)
    return changed


def written(path):
    return "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in path)


def is_named(error, group, path):
    """Whether the message begins with the place, or with a part of it."""
    place, found = f"{group}{written(path)}", error.where.partition(",")[0]
    return found.startswith(place) or place.startswith(found)


def tried(group, values, path, value):
    """What is wrong with how a bad value is taken; None if nothing is."""
    try:
        build(group.partition(".")[0], with_value(values, path, value), group)
    except InputError as error:
        if "\n" in str(error) or len(str(error)) > 2000:
            return "no short line"
        return None if is_named(error, group, path) else f"names {error.where}"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return "taken"


@pytest.mark.parametrize(("group", "name", "values"), list(components()), ids=lambda v: str(v)[:20])
def test_what_cannot_be_a_setting_is_refused_by_name(group, name, values):
    wrong, count = [], 0
    where = f"recorder.{name}" if group == "recorder" else group
    for path, types in leaves(group, values):
        must = wrong_for(types)
        own = len(path) == 1  # a planner within has its own test
        for i, value in enumerate([*must, *ODD] if own else must[:1]):
            found = tried(where, values, path, value)
            count += 1
            # What is odd by itself may be a matter of two settings, and name the other.
            if found and (i < len(must) or not found.startswith(("taken", f"names {where}"))):
                wrong.append(f"{group}={name} {written(path)}={value!r:.40}: {found}")
    assert not wrong, "\n".join(wrong[:40])
    print(f"{group} {values['kind']}: {count} tried, 0 wrong")


def places(shape, values, path=()):
    """Places of the fields of a dataclass, of those of dataclasses within too, and their types."""
    for name, hint in get_type_hints(shape).items():
        if is_dataclass(hint):
            yield from places(hint, values[name], (*path, name))
        elif get_origin(hint) is not dict:
            yield (*path, name), types_of(hint)


PLAIN = yaml.safe_load(Path(conf_folder(), "config.yaml").read_text("utf-8"))
SHAPES = {"": Root} | {
    group: shape for task in kinds("task") for group, shape in find_task(task).shapes.items()
}


@pytest.mark.parametrize("group", SHAPES)
def test_what_cannot_be_a_setting_of_the_root_or_a_task_is_refused_by_name(group):
    shape = SHAPES[group]
    names = get_type_hints(shape)
    values = {k: v for k, v in (PLAIN[group] if group else PLAIN).items() if k in names}
    values |= {"map": {}, "recorder": {}, "name": "plan"} if not group else {}
    wrong, count = [], 0
    for path, types in places(shape, values):
        for value in wrong_for(types):
            if not group and value in (10**30, -(10**30)):
                continue  # `make_run` knows the ranges
            place = f"{group}{written(path)}".lstrip(".")
            try:
                typed(shape, with_value(values, path, value), group)
                wrong.append(f"{place}={value!r}: taken")
            except InputError as error:
                if "\n" in str(error) or not error.where.startswith(place):
                    wrong.append(f"{place}={value!r}: {error}")
        count += len(wrong_for(types))
    assert not wrong, "\n".join(wrong)
    print(f"{group or 'root'}: {count} tried, 0 wrong")


def test_the_table_is_long():
    count = sum(
        len(wrong_for(types))
        for group, _, values in components()
        for _, types in leaves(group, values)
    )
    assert count >= 1000
