"""A YAML's ``kind`` and settings become an object."""

import copy
import dataclasses
import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any, cast, get_args, get_origin, get_type_hints

import numpy as np
from omegaconf import OmegaConf
from omegaconf.errors import ConfigKeyError, OmegaConfBaseException

from gapath.discovery import kinds, load, with_setting, yaml_names, yaml_values
from gapath.errors import InputError, Missing, one_of, require

EXACT = 2**53
"""Below it every whole number is both an int and a float."""


def build(group: str, values: dict[str, Any], where: str) -> Any:
    """Make a component from its settings.

    Parameters
    ----------
    group : str
        "map", "planner", "navigator" or "recorder".
    values : dict
        ``kind`` and the settings of that kind.
    where : str
        Where the values stand, for messages.

    Returns
    -------
    Reader, Planner, Navigator or Recorder
        An instance of the class that ``kind`` names.

    Raises
    ------
    InputError
        For an unknown kind, an unknown, missing or mistyped setting, or one out of range.
    """
    kind, settings = _kind_and_settings(group, values, where)
    made = {
        name: _for_planners(build, value, f"{where}.{name}") for name, value in settings.items()
    }
    try:
        return load(group, kind)(**made)
    except Missing:  # names the kind itself
        raise
    except InputError as error:  # a component names its group; here it may stand elsewhere
        place = error.where
        if not place.startswith(f"{where}."):
            place = place.replace(f"{group}.", f"{where}.", 1)
        raise InputError(place, error.value, error.expected) from None


def build_recorders(
    chosen: Mapping[str, dict[str, Any]], asked: bool
) -> tuple[dict[str, Any], list[str]]:
    """Make recorders; where nobody asked for them, those are left out whose extra is missing.

    Parameters
    ----------
    chosen : mapping of str to dict
        Name of each -> its settings.
    asked : bool
        Whether somebody chose them, or they are the usual ones.

    Returns
    -------
    made : dict of str to Recorder
        The recorders by name.
    left_out : list of str
        What of each other one is missing, and how to install it.

    Raises
    ------
    InputError
        As `build`.
    """
    made, left_out = {}, []
    for name, values in chosen.items():
        try:
            made[name] = build("recorder", values, f"recorder.{name}")
        except Missing as error:
            if asked:
                raise
            left_out.append(str(error))
    return made, left_out


def normalised(group: str, values: dict[str, Any], where: str) -> dict[str, Any]:
    """Give a component's settings as data, in one way: what means the same is equal.

    Parameters
    ----------
    group : str
        "map", "planner", "navigator" or "recorder".
    values : dict
        ``kind`` and the settings of that kind, however loose: "0" or 0.0 for a 0.
    where : str
        Where the values stand, for messages.

    Returns
    -------
    dict
        ``kind`` and every setting with its type, planners among them written out (`expanded`).

    Raises
    ------
    InputError
        For an unknown kind, or an unknown, missing or mistyped setting.
    """
    kind, settings = _kind_and_settings(group, values, where)
    return {"kind": kind} | {
        name: _for_planners(normalised, value, f"{where}.{name}")
        for name, value in settings.items()
    }


def _kind_and_settings(
    group: str, values: dict[str, Any], where: str
) -> tuple[str, dict[str, Any]]:
    require(isinstance(values, dict), where, values, "kind and its settings")
    values = dict(values)
    kind = values.pop("kind", None)
    if kind not in kinds(group):
        raise InputError(f"{where}.kind", kind, one_of(kind, kinds(group)))
    target, values = load(group, str(kind)), expanded(values, where)
    try:
        return str(kind), checked(target, values, where)
    except InputError as error:
        name = error.where.removeprefix(f"{where}.")
        own = name in (field.name for field in dataclasses.fields(target))
        others = "" if own else with_setting(group, name)
        if not others:
            raise
        right = f"{error.expected}; it is a setting of {others}"
        raise InputError(error.where, error.value, right) from None


def expanded(value: Any, where: str) -> Any:
    """Write settings out: planners that stand among them, with all their values.

    A planner among settings is a mapping with ``base``, the name of a YAML in
    ``conf/planner``, and the values that replace the YAML's.

    Parameters
    ----------
    value : object
        Nested settings.
    where : str
        Where they stand, for messages.

    Returns
    -------
    object
        The settings, every such mapping replaced by the planner's ``kind`` and settings: whoever
        reads them later asks no YAML.

    Raises
    ------
    InputError
        If there is no such YAML.
    """
    if isinstance(value, list):
        return [expanded(item, f"{where}[{i}]") for i, item in enumerate(value)]
    if not isinstance(value, dict):
        return value
    own = {key: expanded(item, f"{where}.{key}") for key, item in value.items() if key != "base"}
    if "base" not in value:
        return own
    name, names = value["base"], yaml_names("planner")
    if name not in names:
        raise InputError(f"{where}.base", name, one_of(name, names))
    return expanded(yaml_values("planner", name), where) | own


def _for_planners(make: Callable[[str, dict[str, Any], str], Any], value: Any, where: str) -> Any:
    """Replace every mapping with a ``kind`` in a component's settings by what is made of it."""
    if isinstance(value, list):
        return [_for_planners(make, item, f"{where}[{i}]") for i, item in enumerate(value)]
    if isinstance(value, dict) and "kind" in value:
        return make("planner", value, where)
    return value


def typed(target: type[Any], values: object, where: str) -> Any:
    """Make a dataclass from loose values, checking names and types.

    Parameters
    ----------
    target : type
        A dataclass without defaults; its fields may be such dataclasses.
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
    fields, hints = checked(target, values, where), get_type_hints(target)
    prefix = f"{where}." if where else ""
    for name in fields:
        if dataclasses.is_dataclass(hints[name]):
            fields[name] = typed(cast(type[Any], hints[name]), fields[name], prefix + name)
    return target(**fields)


def checked(target: type[Any], values: object, where: str) -> dict[str, Any]:
    """Give what `typed` would make a dataclass of: every field, with its type, as plain data.

    A whole number is an int where the field is, and a float where that is one: 1.0 and "1" are 1,
    -0.0 is 0.0. What was checked already, as most of a sweep's jobs, is not checked again.
    """
    return copy.deepcopy(_checked(target, _Given(values), where))  # type: ignore[arg-type]


class _Given:
    """Plain data that is equal if it is written alike: 1, 1.0 and "1" are three things."""

    def __init__(self, values: object) -> None:
        self.values, self.text = values, repr(values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Given) and self.text == other.text

    def __hash__(self) -> int:
        return hash(self.text)


@lru_cache(maxsize=1024)
def _checked(target: type[Any], given: _Given, where: str) -> dict[str, Any]:
    values = given.values
    prefix = f"{where}." if where else ""
    names = [f.name for f in dataclasses.fields(target) if f.init]
    if not isinstance(values, dict):
        raise InputError(where, values, f"settings: {', '.join(names)}")
    if not names:
        require(not values, f"{prefix}{next(iter(values), '')}", "an unknown name", "no settings")
        return {}
    try:
        hints = get_type_hints(target)
        inner = [n for n in names if dataclasses.is_dataclass(hints[n])]
        types = [(n, Any if n in inner else hints[n]) for n in names]
        schema = dataclasses.make_dataclass(target.__name__, types)
        for name, value in values.items():
            _check_kind(target, hints.get(name), value, f"{prefix}{name}")
        loose = {name: _whole(hints.get(name), value) for name, value in values.items()}
        merged = OmegaConf.merge(OmegaConf.structured(schema), loose)
        for name in names:
            require(not OmegaConf.is_missing(merged, name), prefix + name, "nothing", "a value")
        fields = OmegaConf.to_container(merged, resolve=True)
    except ConfigKeyError as error:
        raise InputError(
            f"{prefix}{error.key}", "an unknown name", one_of(error.key, names)
        ) from error
    except OmegaConfBaseException as error:
        name = error.full_key or str(error.key or "")
        shown = repr(values.get(name.split(".")[0].split("[")[0]))
        raise InputError(prefix + name, shown, _type_name(target, name)) from error
    assert isinstance(fields, dict)
    return {
        name: checked(hints[name], fields[name], prefix + name)
        if name in inner
        else _without_sign_of_zero(fields[name])
        for name in names
    }


def _without_sign_of_zero(value: Any) -> Any:
    """Give 0.0 for -0.0, also in lists: they are equal, but are not written alike."""
    if isinstance(value, list):
        return [_without_sign_of_zero(item) for item in value]
    return 0.0 if isinstance(value, float) and value == 0 else value


def _check_kind(target: type[Any], hint: Any, value: Any, where: str) -> None:
    """Raise InputError for what OmegaConf takes, or refuses without a name.

    To it 2 is true, a list within one of numbers is none of its business, and of a mapping in
    place of a list it names a key.
    """
    allowed = get_args(hint) or (hint,)
    if bool in allowed:
        good = isinstance(value, bool | list | dict | None) or str(value).lower() in _TRUTHS
        require(good, where, repr(value), "true or false")
    lists = [kind for kind in (hint, *allowed) if get_origin(kind) is list]
    if lists and not {Any, dict} & {*allowed, *get_args(lists[0])}:
        inner = value if isinstance(value, list) else ()
        good = not isinstance(value, dict) and not any(isinstance(v, list | dict) for v in inner)
        require(good, where, repr(value), _type_name(target, where.rpartition(".")[2]))


_TRUTHS = ("0", "1", "false", "true", "no", "yes", "off", "on", "n", "y")


def _whole(hint: Any, value: Any) -> Any:
    """Give a whole number the type that a field has, an int or a float, also in quotes.

    OmegaConf does so for text where a field is a number only, not where it may be a word.
    """
    if isinstance(value, np.generic):  # of an array or a table
        value = value.item()
    allowed = get_args(hint) or (hint,)
    if isinstance(value, list):
        items = next(
            (get_args(kind)[0] for kind in (hint, *allowed) if get_origin(kind) is list), None
        )
        return [_whole(items, item) for item in value]
    if isinstance(value, str) and str in allowed and {int, float} & {*allowed}:
        try:
            value = float(value) if math.isfinite(float(value)) else value
        except ValueError:
            return value
    if float not in allowed and int in allowed and isinstance(value, float):
        return int(value) if value.is_integer() and abs(value) < EXACT else value
    if int not in allowed and float in allowed and type(value) is int and abs(value) < EXACT:
        return float(value)
    return value


def _type_name(target: type[Any], name: str) -> str:
    types = {f.name: f.type for f in dataclasses.fields(target)}
    wanted = types.get(name.split(".")[0].split("[")[0], "another value")
    text = wanted.__name__ if isinstance(wanted, type) else str(wanted)
    return f"a value of type {text.replace('typing.', '')}"
