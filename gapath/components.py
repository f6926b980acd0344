"""A YAML's ``kind`` and settings become an object."""

import dataclasses
from typing import Any, get_type_hints

from omegaconf import DictConfig, ListConfig, OmegaConf
from omegaconf.errors import ConfigKeyError, OmegaConfBaseException

from gapath.discovery import kinds, load, yaml_values
from gapath.errors import InputError, one_of, require


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
    values = dict(values)
    kind = values.pop("kind", None)
    if kind not in kinds(group):
        raise InputError(f"{where}.kind", kind, one_of(kind, kinds(group)))
    target = load(group, str(kind))
    made = {
        name: with_planners(value, f"{where}.{name}")
        for name, value in checked(target, expanded(values), where).items()
    }
    try:
        return target(**made)
    except InputError as error:  # a component names its group; here it may stand elsewhere
        place = error.where
        if not place.startswith(f"{where}."):
            place = place.replace(f"{group}.", f"{where}.", 1)
        raise InputError(place, error.value, error.expected) from None


def expanded(value: Any) -> Any:
    """Write settings out: planners that stand among them, with all their values.

    A planner among settings is a mapping with ``base``, the name of a YAML in
    ``conf/planner``, and the values that replace the YAML's.

    Parameters
    ----------
    value : object
        Nested settings.

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
        return [expanded(item) for item in value]
    if not isinstance(value, dict):
        return value
    own = {key: expanded(item) for key, item in value.items() if key != "base"}
    return expanded(yaml_values("planner", value["base"])) | own if "base" in value else own


def with_planners(value: Any, where: str) -> Any:
    """Make the planners that a component's settings describe, see `expanded`.

    Parameters
    ----------
    value : object
        A setting.
    where : str
        Where it stands, for messages.

    Returns
    -------
    object
        The setting, every mapping with a ``kind`` in it replaced by a planner.
    """
    if isinstance(value, list):
        return [with_planners(item, f"{where}[{i}]") for i, item in enumerate(value)]
    if isinstance(value, dict) and "kind" in value:
        return build("planner", value, where)
    return value


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
    return target(**checked(target, values, where))


def checked(target: type[Any], values: object, where: str) -> dict[str, Any]:
    """Check names and types of a dataclass's fields, as `typed` does, without making it."""
    prefix = f"{where}." if where else ""
    names = [f.name for f in dataclasses.fields(target) if f.init]
    if not names:
        loose = values if isinstance(values, dict) else {}
        require(not loose, f"{prefix}{next(iter(loose), '')}", "an unknown name", "no settings")
        return {}
    try:
        hints = get_type_hints(target)
        schema = dataclasses.make_dataclass(target.__name__, [(n, hints[n]) for n in names])
        merged = OmegaConf.merge(OmegaConf.structured(schema), values)
        for name in names:
            require(not OmegaConf.is_missing(merged, name), prefix + name, "nothing", "a value")
        fields = OmegaConf.to_container(merged, resolve=True)
    except ConfigKeyError as error:
        raise InputError(
            f"{prefix}{error.key}", "an unknown name", one_of(error.key, names)
        ) from error
    except OmegaConfBaseException as error:
        name = error.full_key or str(error.key or "")
        raise InputError(prefix + name, _raw(values, name), _type_name(target, name)) from error
    assert isinstance(fields, dict)
    return {name: fields[name] for name in names}


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
