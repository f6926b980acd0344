"""What every map reader starts from: a file, and a field that the user names."""

from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from gapath.errors import InputError, require
from gapath.grid import MAX_FIELDS, Field

MAX_FILE_BYTES = 4 * MAX_FIELDS + (1 << 20)
"""Bytes of the largest map file that is opened: four channels a field, and a header."""

MAX_TEXT_BYTES = MAX_FIELDS + (1 << 20)
"""Bytes of the largest text file: a character a field, a header, and ends of lines."""

ROWS = 256
"""Of a picture so many rows are looked at a time, where that takes more room than they have."""

T = TypeVar("T", bound=np.generic)


def read_bytes(path: str | Path, limit: int = MAX_FILE_BYTES) -> bytes:
    """Read a whole file.

    Parameters
    ----------
    path : str or Path
        The file, relative to the current folder.
    limit : int
        Bytes that it may have.

    Returns
    -------
    bytes
        Its content.

    Raises
    ------
    InputError
        If it is missing, not a regular file (a pipe would hang), empty, too large or
        unreadable.
    """
    require(str(path) != "", "map.path", "", "a file")
    try:
        require(Path(path).exists(), path, "no such file", "an existing file")
        require(Path(path).is_file(), path, "not a regular file", "a file")
        size = Path(path).stat().st_size
        require(0 < size <= limit, path, f"{size} bytes", f"between 1 and {limit} bytes")
        with Path(path).open("rb") as file:
            data = file.read(limit + 1)
        require(0 < len(data) <= limit, path, f"{len(data)} bytes", f"between 1 and {limit} bytes")
        return data
    except OSError as error:
        raise InputError(path, error.strerror, "a file that can be read") from error


def read_text(path: str | Path, limit: int = MAX_TEXT_BYTES) -> str:
    r"""Read a whole text file, without byte order mark, each line ended by ``\n``.

    Parameters
    ----------
    path : str or Path
        The file, relative to the current folder.
    limit : int
        Bytes that it may have.

    Returns
    -------
    str
        Its content.

    Raises
    ------
    InputError
        As `read_bytes`, and if it is not UTF-8.
    """
    try:
        text = read_bytes(path, limit).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        found = f"byte 0x{error.object[error.start]:02x} at position {error.start}"
        raise InputError(path, found, "text in UTF-8") from error
    return text.replace("\r\n", "\n")


def final(weights: NDArray[T]) -> NDArray[T]:
    """Let nobody change an array of one's own any more, so that a map need not copy it."""
    weights.setflags(write=False)
    return weights


def as_field(where: str, value: list[int] | None) -> Field | None:
    """Turn a setting such as ``map.start`` into a field.

    Parameters
    ----------
    where : str
        Name of the setting.
    value : list of int, optional
        What it was set to.

    Returns
    -------
    (x, y), optional
        The field, or None where nothing was set.

    Raises
    ------
    InputError
        If there are not two numbers.
    """
    if value is None:
        return None
    require(len(value) == 2, where, list(value), "two integers [x, y]")
    return value[0], value[1]
