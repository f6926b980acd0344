"""What a file of JSON says becomes a dataclass, if all of it has the types that this names."""

from collections.abc import Mapping
from dataclasses import is_dataclass
from functools import lru_cache
from types import NoneType, UnionType
from typing import Any, NamedTuple, get_args, get_origin, get_type_hints

from gapath.errors import InputError, require


def shaped(kind: Any, content: Any, where: str) -> Any:
    """Make what a type hint asks for, without any conversion.

    Parameters
    ----------
    kind : type
        A dataclass, a Mapping from str, a plain type, several plain types, or one of these
        or None. Fields of dataclasses and items of mappings may be all of these.
    content : object
        As `json.loads` gives it; of a dataclass, more than its fields is left out.
    where : str
        Where it stands, for messages.

    Returns
    -------
    object
        Of that kind.

    Raises
    ------
    InputError
        If something is missing or of another type: names the place.
    """
    return _shaped(_hint(kind), content, where)


def _shaped(hint: "_Hint", content: Any, where: str) -> Any:
    if hint.shape is None or (content is None and NoneType in hint.plain):
        if type(content) not in hint.plain:
            right = ", ".join("null" if each is NoneType else each.__name__ for each in hint.plain)
            raise InputError(where, content, right)
        return content
    require(isinstance(content, dict), where, content, "a mapping")
    inner = hint.parts.get(_ITEMS)
    if inner is not None:
        types = set(map(type, content.values()))
        if inner.shape is None and types.issubset(inner.plain):
            return _texts(tuple(content.items())) if types == {str} else content
        return {n: _shaped(inner, item, f"{where}, {n}") for n, item in content.items()}
    made = {}
    for name, part in hint.parts.items():
        value = made[name] = content.get(name)
        if type(value) not in part.plain:
            made[name] = _shaped(part, value, f"{where}, {name}")
    return hint.shape(**made)


@lru_cache(maxsize=256)
def _texts(items: tuple[tuple[str, str], ...]) -> Mapping[str, str]:
    """Give one mapping for all that are equal: ten thousand manifests name the same packages."""
    return dict(items)


_ITEMS = ""


class _Hint(NamedTuple):
    """A type hint, taken apart: ten thousand manifests ask for the same."""

    shape: Any
    """Its dataclass or Mapping; None without one."""
    plain: tuple[type, ...]
    """Its plain types."""
    parts: "dict[str, _Hint]"
    """The dataclass's fields; of a Mapping, `_ITEMS`."""


@lru_cache
def _hint(kind: Any) -> _Hint:
    several = get_args(kind) if isinstance(kind, UnionType) else (kind,)
    shapes = [each for each in several if is_dataclass(each) or get_origin(each) is Mapping]
    shape = (shapes or [None])[0]
    parts = get_type_hints(shape) if is_dataclass(shape) else {}
    if get_origin(shape) is Mapping:
        parts = {_ITEMS: get_args(shape)[1]}
    plain = tuple(each for each in several if each not in shapes)
    return _Hint(shape, plain, {name: _hint(part) for name, part in parts.items()})
