"""What people say of runs: tags and a note each, in a file outside of all that is hashed.

The file is an experiment's (``<outputs>/<experiment>/tags.json``), so that it goes where the runs
go. It is no part of a run: a run that is done again keeps what is said of it.
"""

import fcntl
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path

from gapath.errors import InputError, require
from gapath.store.durable import named, write_whole
from gapath.store.records import RunRecord
from gapath.store.shape import shaped
from gapath.store.status import as_json, contents, parsed

TAGS = "tags.json"

MOST_TAGS, LONGEST_TAG, LONGEST_NOTE = 20, 200, 2000
"""Tags of a run, and characters of a tag and of a note."""


@dataclass(frozen=True)
class Said:
    """What is said of a run.

    Parameters
    ----------
    tags : mapping of str to str
        Each tag, and when it was given.
    note : str
        Any text; empty for none.
    """

    tags: Mapping[str, str] = field(default_factory=dict)
    note: str = ""

    def check(self, where: str) -> None:
        """Raise InputError if it is more than may be said."""
        few = len(self.tags) <= MOST_TAGS
        require(few, where, f"{len(self.tags)} tags", f"at most {MOST_TAGS} of a run")
        for tag in self.tags:
            good = 1 <= len(tag) <= LONGEST_TAG and tag == tag.strip()
            require(good, where, repr(tag), f"a tag of 1 to {LONGEST_TAG} characters, no space "
                    "at its ends")  # fmt: skip
        size = len(self.note)
        right = f"at most {LONGEST_NOTE}"
        require(size <= LONGEST_NOTE, where, f"a note of {size} characters", right)


UNSAID = Said()


def read_said(experiment: Path) -> dict[str, Said]:
    """Read what is said of an experiment's runs.

    Parameters
    ----------
    experiment : Path
        The folder that holds its run folders.

    Returns
    -------
    dict of str to Said
        Name of a run folder -> what is said of it.

    Raises
    ------
    InputError
        If there is a file that cannot be read, or holds something else.
    """
    if not os.path.lexists(experiment / TAGS):
        return {}
    where = f"{experiment.name}/{TAGS}"
    try:
        data = contents(experiment, TAGS)
    except InputError as error:
        raise InputError(where, error.value, error.expected) from error
    found: dict[str, Said] = shaped(Mapping[str, Said], parsed(data, where), where)
    for said in found.values():
        said.check(where)
    return found


def said_of(runs: Iterable[RunRecord]) -> tuple[dict[str, Said], list[InputError]]:
    """Give what is said of runs.

    Parameters
    ----------
    runs : iterable of RunRecord
        The runs.

    Returns
    -------
    said : dict of str to Said
        `RunRecord.name` -> what is said of it, of those of which something is.
    faults : list of InputError
        Why an experiment's file cannot be used.
    """
    found: dict[str, Said] = {}
    faults = []
    for place in sorted({run.folder.parent for run in runs}):
        try:
            found |= {f"{place.name}/{key}": said for key, said in read_said(place).items()}
        except InputError as error:
            faults.append(error)
    return found, faults


def say(run: Path, change: Callable[[Said], Said]) -> Said:
    """Change what is said of a run, durably, while nobody else does.

    Parameters
    ----------
    run : Path
        Its folder.
    change : callable
        Takes what is said, gives what is to be.

    Returns
    -------
    Said
        What is said now.

    Raises
    ------
    InputError
        If that is too much, or the file cannot be read or written; it stays as it was.
    """
    with _turn(run.parent):
        every = read_said(run.parent)
        before = every.pop(run.name, UNSAID)
        now = change(before)
        now.check(TAGS)
        every |= {run.name: now} if now != UNSAID else {}
        if now != before:
            write_whole(run.parent / TAGS, text_of(every))
        return now


def text_of(said: Mapping[str, Said]) -> bytes:
    """Give what stands in the file."""
    return as_json({name: asdict(said[name]) for name in sorted(said)})


@contextmanager
def _turn(place: Path) -> Iterator[None]:
    """Wait for one's turn; the lock is the folder's, since the file is replaced by who writes."""
    with named(place):
        folder = os.open(place, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with named(place):
            fcntl.flock(folder, fcntl.LOCK_EX)
        yield
    finally:
        os.close(folder)
