"""What a file of JSON says becomes a dataclass, if all of it has the types that this names."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, get_args, get_origin, get_type_hints

from gapath.errors import require


def shaped(kind: Any, content: Any, where: str) -> Any:
    """Make what a type hint asks for, without any conversion.

    Parameters
    ----------
    kind : type
        A dataclass, a Mapping from str, a plain type, or several plain types. Fields of
        dataclasses and items of mappings may be all of these.
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
    if is_dataclass(kind) or get_origin(kind) is Mapping:
        require(isinstance(content, dict), where, content, "a mapping")
        if isinstance(kind, type):
            hints = get_type_hints(kind)
            names = [each.name for each in fields(kind)]
            return kind(**{n: shaped(hints[n], content.get(n), f"{where}, {n}") for n in names})
        inner = get_args(kind)[1]
        return {n: shaped(inner, item, f"{where}, {n}") for n, item in content.items()}
    kinds = get_args(kind) or (kind,)
    right = ", ".join("null" if each is type(None) else each.__name__ for each in kinds)
    require(type(content) in kinds, where, content, right)
    return content
