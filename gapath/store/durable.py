"""Files that are there whole or not at all, even after a crash."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from gapath.errors import InputError


@contextlib.contextmanager
def named(path: object) -> Iterator[None]:
    """Name the file that could not be written: what the system says of a full disk does not.

    Parameters
    ----------
    path : Path or str
        The file, or what writes it, unless the system names one.

    Raises
    ------
    InputError
        For an OSError.
    """
    try:
        yield
    except OSError as error:
        expected = "a place that can be written and has room; then run it again"
        raise InputError(error.filename or path, error.strerror or error, expected) from error


def part_of(path: Path) -> Path:
    """Give the name under which a file is written until it is whole."""
    return path.with_name(f"{path.name}.part")


def write_part(path: Path, data: bytes) -> None:
    """Write all of a file's content, durably, under its ``.part`` name.

    Parameters
    ----------
    path : Path
        The file's final name.
    data : bytes
        All of its content.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    with named(path), part_of(path).open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def publish(source: Path, target: Path) -> None:
    """Give a whole file its name, durably.

    Parameters
    ----------
    source : Path
        A file whose content is durable, on the same file system.
    target : Path
        Its name from now on; a file of that name is replaced.

    Raises
    ------
    InputError
        If it cannot be given.
    """
    with named(target):
        source.replace(target)
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def write_whole(path: Path, data: bytes) -> None:
    """Write a file so that it is there whole or not at all.

    Parameters
    ----------
    path : Path
        The file.
    data : bytes
        All of its content.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    write_part(path, data)
    publish(part_of(path), path)
