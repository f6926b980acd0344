"""Files that are there whole or not at all, even after a crash."""

import os
from pathlib import Path


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
    """
    with part_of(path).open("wb") as file:
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
    """
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
    """
    write_part(path, data)
    publish(part_of(path), path)
