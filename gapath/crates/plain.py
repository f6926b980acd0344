"""Text of a run without the folders of the machine that it ran on."""

import math
import re
from collections.abc import Mapping
from typing import Any

_FOLDERS = re.compile(r"(?<![\w.~:/-])/(?=[^\s/])(?:[^\s'\"/=,:;()\[\]{}]+/)*")
"""What stands before a file's name in an absolute path."""


def without_folders(value: Any) -> Any:
    """Leave the folders out of absolute paths.

    Parameters
    ----------
    value : object
        Text, or mappings and lists of it; what else there is stays as it is.

    Returns
    -------
    object
        The same: ``map.path=/home/me/office.map`` becomes ``map.path=office.map``.
    """
    match value:
        case str():
            return _FOLDERS.sub("", value)
        case Mapping():
            return {without_folders(key): without_folders(item) for key, item in value.items()}
        case list() | tuple():
            return [without_folders(item) for item in value]
    return value


def as_value(value: object) -> str | int | float | bool:
    """Give a setting or a figure as JSON-LD has it, which knows no null, NaN or infinity."""
    if value is None:
        return "null"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value if isinstance(value, str | int | float | bool) else str(value)
