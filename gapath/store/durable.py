"""Files that are there whole or not at all, even after a crash, and are nobody else's.

Folders of runs are shared, and the names in them can be foreseen: where a file is made, a link
that somebody planted under its name goes and is not followed, and what is read is a regular file,
not a device or a pipe.
"""

import contextlib
import errno
import os
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from io import FileIO
from pathlib import Path
from typing import IO

from gapath.errors import InputError

LAST: list[Callable[[], object]] = []
"""What a command does last that a signal ends, beside its other threads; nothing may be raised."""


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


def new_file(path: Path) -> IO[bytes]:
    """Make a file to be written.

    Parameters
    ----------
    path : Path
        Its name; what has it goes.

    Returns
    -------
    file
        Open for writing.

    Raises
    ------
    OSError
        If it cannot be made, or somebody else makes it meanwhile.
    """
    path.unlink(missing_ok=True)
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
    return os.fdopen(os.open(path, flags, 0o666), "wb")


def open_regular(path: str | Path, links: bool = False) -> FileIO:
    """Open a regular file to be read.

    Parameters
    ----------
    path : str or Path
        The file.
    links : bool
        Follow links.

    Returns
    -------
    file
        Open for reading, unbuffered.

    Raises
    ------
    OSError
        If it is another thing or cannot be read.
    """
    # Without O_NONBLOCK a pipe would wait for somebody who writes.
    flags = os.O_RDONLY | os.O_NONBLOCK | (0 if links else os.O_NOFOLLOW)
    try:
        file = os.fdopen(os.open(path, flags), "rb", buffering=0)
    except OSError as error:
        if error.errno == errno.ELOOP:
            error.strerror = "a link"
        raise
    if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        file.close()
        raise OSError(errno.EINVAL, "no regular file", str(path))
    return file


@contextlib.contextmanager
def scratch(place: Path | None = None) -> Iterator[Path]:
    """Make a folder that goes again, also where a signal ends a command.

    Parameters
    ----------
    place : Path, optional
        The folder that it is in, else the system's for such.

    Yields
    ------
    Path
        The folder.
    """
    with tempfile.TemporaryDirectory(dir=place) as folder:
        remove = partial(shutil.rmtree, folder, ignore_errors=True)
        LAST.append(remove)
        try:
            yield Path(folder)
        finally:
            LAST.remove(remove)


def make_folder(path: Path) -> None:
    """Make a folder, and those that it is to be in, durably; raises OSError if it cannot be."""
    if not path.is_dir():
        make_folder(path.parent)
        path.mkdir(exist_ok=True)
        sync_folder(path.parent)


def sync_folder(path: Path) -> None:
    """Make the names in a folder durable; raises OSError if they cannot be."""
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


@contextlib.contextmanager
def part_file(path: Path) -> Iterator[IO[bytes]]:
    """Make a file under its ``.part`` name, durably.

    Parameters
    ----------
    path : Path
        The file's final name.

    Yields
    ------
    file
        Open for writing; whoever writes says which file it was (`named`).

    Raises
    ------
    InputError
        If it cannot be made, or what was written is not on the disk.
    """
    with named(path):
        file = new_file(part_of(path))
    try:
        yield file
        with named(path):
            file.flush()
            os.fsync(file.fileno())
    finally:
        with contextlib.suppress(OSError):  # on a full disk its last bytes have no room, either
            file.close()


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
    with part_file(path) as file, named(path):
        file.write(data)


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
        sync_folder(target.parent)


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
