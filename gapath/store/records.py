"""What a run folder says of its run: manifest, status, settings; and which folders there are."""

import contextlib
import glob
import hashlib
import os
import stat
import time
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path

from gapath.discovery import kinds
from gapath.errors import InputError, did_you_mean, require
from gapath.store.durable import named, write_whole
from gapath.store.results import Results
from gapath.store.runfolder import BEFORE, LOCK, PROGRESS, WORK, RunFolder, is_locked
from gapath.store.settings import Flat, Value, read_settings
from gapath.store.shape import shaped
from gapath.store.status import STATUS, WHOLE, RunState, Status, as_json, contents, parsed

MANIFEST, CONFIG, TRIALS = "manifest.json", "config.yaml", "trials.parquet"
"""Names of files that every run folder has, beside `STATUS`."""


@dataclass(frozen=True)
class FileEntry:
    """A file of a run folder, as it was when the run was finished."""

    sha256: str
    bytes: int

    @classmethod
    def of(cls, folder: RunFolder, name: str) -> "FileEntry":
        """Describe a file; raises InputError if it is none, or has a name that no run's has."""
        _check_name(name, "recorder, file")
        with named(folder.path / name):
            return cls(folder.sha256(name), (folder.path / name).stat().st_size)


_NO_FILES = ("", ".", "..", STATUS, MANIFEST, LOCK, WORK, BEFORE, PROGRESS)


def _check_name(name: str, where: str) -> None:
    plain = not {"/", "\0"}.intersection(name) and name not in _NO_FILES
    require(plain, where, name, "the name of a file of its own within the folder")


@dataclass(frozen=True)
class Manifest:
    """What is run, and which files came of it: ``manifest.json``.

    Parameters
    ----------
    key : str
        Name of the folder: a hash of everything that the results depend on.
    setting : str
        A hash of what is tried, with whatever code and however often: of several runs that share
        it only the newest counts.
    experiment, task : str
        Their names.
    map : str
        Name of the map.
    map_instance : int
        Its number within a generated class.
    map_digest : str
        `gapath.grid.GridMap.digest`.
    start, target : str
        The fields "(x, y)" from which and to which; of several problems those of one.
    method : str
        Name of the planner or navigator for people: `preset`, and what differs from it.
    preset : str
        Name of its YAML.
    changes : mapping of str to str, int, float, bool or None
        Settings that differed from that YAML and from ``conf/config.yaml`` when it was run.
    seed, trials : int
        Trials 0 to trials - 1 use the random streams (seed, trial).
    command : str
        What does the same again.
    versions : mapping of str to str
        Versions of gapath and of what it stands on.
    map_inputs, method_inputs : mapping of str to str
        The files that the map and the method were made from: path -> SHA-256.
    late_inputs : mapping of str to str
        Those that were read only while trials ran: no part of what was tried, since a library may
        read them once a process, but the run is done anew where one has changed.
    files : mapping of str to FileEntry
        All files but the manifest and the status. Until the run is finished, those of an earlier
        one, which are in its place, or none.
    settings : mapping of str to str, int, float, bool or None
        The settings, flat. Who reads runs reads them here; ``config.yaml`` says the same to
        people, and is read for what earlier versions made: then None stands here.
    queries : str
        `gapath.scenario.listed.Queries.digest` of a run over several pairs of start and target,
        empty of others.
    results : Results
        What the trials of ``trials.parquet`` come to; None of earlier versions.
    provenance : mapping of str to mapping
        Where the run comes from (`gapath.store.provenance`), sections of values: nothing of it
        changes a key or a log. Empty if it was not to be said, None of earlier versions.
    """

    key: str
    setting: str
    experiment: str
    task: str
    map: str
    map_instance: int
    map_digest: str
    start: str
    target: str
    method: str
    preset: str
    changes: Mapping[str, Value]
    seed: int
    trials: int
    command: str
    versions: Mapping[str, str]
    map_inputs: Mapping[str, str]
    method_inputs: Mapping[str, str]
    late_inputs: Mapping[str, str]
    files: Mapping[str, FileEntry]
    settings: Mapping[str, Value] | None = None
    queries: str = ""
    results: Results | None = None
    provenance: Mapping[str, Flat] | None = None

    def write(self, folder: RunFolder) -> str:
        """Write it, whole; gives its SHA-256, for the status."""
        data = as_json(asdict(self))
        write_whole(folder.path / MANIFEST, data)
        return hashlib.sha256(data).hexdigest()

    @classmethod
    def read(cls, folder: Path, sha256: str = "", name: str = MANIFEST) -> "Manifest":
        """Read a folder's manifest.

        Parameters
        ----------
        folder : Path
            A run folder.
        sha256 : str
            What its status says of it.
        name : str
            The file's name.

        Returns
        -------
        Manifest
            What it says.

        Raises
        ------
        InputError
            If it cannot be read, is another, or something is missing, of another type or out of
            range.
        """
        data = contents(folder, name)
        same = sha256 in ("", hashlib.sha256(data).hexdigest())
        expected = f"the one of which {STATUS} speaks; the command that made it mends it"
        require(same, MANIFEST, "another manifest", expected)
        found: Manifest = shaped(cls, parsed(data, MANIFEST), MANIFEST)
        known, task, trials, seed = kinds("task"), found.task, found.trials, found.seed
        require(task in known, f"{MANIFEST}, task", task, f"one of {', '.join(known)}")
        good = 1 <= trials <= 10**6
        require(good, f"{MANIFEST}, trials", trials, "an integer from 1 to 10^6")
        require(0 <= seed < 2**64, f"{MANIFEST}, seed", seed, "an integer in [0, 2^64)")
        for name in found.files:
            _check_name(name, f"{MANIFEST}, files")
        return found


@dataclass(frozen=True)
class RunRecord:
    """A run folder, ``<outputs>/<experiment>/<key>/``, as it is found.

    Parameters
    ----------
    folder : Path
        The folder.
    status : Status
        How far it is.
    manifest : Manifest or None
        What was run; None if that cannot be read.
    fault : str
        Why the run cannot be used, empty if it can.
    """

    folder: Path
    status: Status
    manifest: Manifest | None
    fault: str

    @property
    def name(self) -> str:
        """The folder within the outputs: ``<experiment>/<key>``."""
        return f"{self.folder.parent.name}/{self.folder.name}"

    @property
    def state(self) -> RunState:
        """How far it is."""
        return self.status.state

    @property
    def date(self) -> str:
        """When it ended, else when it began."""
        return self.status.date

    @property
    def known(self) -> Manifest:
        """The manifest of a run that can be used."""
        assert self.manifest is not None, self.fault
        return self.manifest

    @cached_property
    def settings(self) -> Flat:
        """Its settings, flat; raises InputError if they cannot be read."""
        known = self.manifest.settings if self.manifest else None
        return read_settings(self.folder / CONFIG) if known is None else known


def read_record(folder: Path) -> RunRecord:
    """Read what a run folder says.

    Parameters
    ----------
    folder : Path
        A run folder.

    Returns
    -------
    RunRecord
        Its sizes of files are compared; hashing every log would take longer than reading it.
    """
    found, end = _read(folder), time.monotonic() + _PATIENCE
    while found.fault and found.state in WHOLE and time.monotonic() < end:
        # A run that is done again may be about to take its place, or have done so meanwhile.
        settled, before = not is_locked(folder / LOCK), found
        found = _read(folder)
        if settled and found == before:
            break
        time.sleep(0.002)
    return found


_PATIENCE = 1.0  # seconds


def _read(folder: Path) -> RunRecord:
    status = Status.read(folder)
    manifest, fault = None, ""
    try:
        manifest = Manifest.read(folder, status.manifest)
        require(TRIALS in manifest.files, f"{MANIFEST}, files", [*manifest.files], TRIALS)
        for name, entry in sorted(manifest.files.items()):
            size = _size(f"{folder}/{name}")
            if size != entry.bytes:
                raise InputError(name, size, f"{entry.bytes} bytes, as the manifest says")
    except InputError as error:
        fault = str(error)
    if status.state not in WHOLE:
        reason = status.message.splitlines()[-1] if status.message else ""
        fault = status.state + (f": {reason}" if reason else "")
    return RunRecord(folder, status, manifest, fault)


def is_run(folder: Path) -> bool:
    """Tell whether a folder is that of a run, whole or not."""
    return any((folder / mark).exists() for mark in (STATUS, MANIFEST, CONFIG, TRIALS))


def find_run(outputs: Path, given: str) -> Path:
    """Find the run that somebody names: everywhere where one is named.

    Parameters
    ----------
    outputs : Path
        The folder that holds ``<experiment>/<key>/``.
    given : str
        The run's folder, or a file in it; or its key, or so much of its beginning that no other
        run's begins alike, behind the name of its experiment or not.

    Returns
    -------
    Path
        Its folder; raises InputError if there is no such run, or more than one.
    """
    place, begin = Path(given), glob.escape(given)
    if given and place.exists():  # a file may lie in its run's folder for work in progress
        for folder in (place, place.parent, place.parent.parent):
            if is_run(folder):
                return folder
    require(not place.is_absolute(), given, "no run", "the folder of a run that is whole, or a key")
    require(outputs.is_dir(), outputs, "no such folder", "a folder with run folders")
    require(given != "", "key", given, "the beginning of a run's key")
    found = sorted(filter(is_run, outputs.glob(f"{begin}*" if "/" in given else f"*/{begin}*")))
    names = [f"{path.parent.name}/{path.name}" for path in found]
    if not found:
        keys = {path.name[: len(given)]: path.name for path in outputs.glob("*/*") if is_run(path)}
        right = f"a key that `gapath-report runs` lists{did_you_mean(given, keys)}"
        raise InputError(outputs, f"no run {given}...", right)
    require(len(found) == 1, "key", f"{given}, the beginning of {', '.join(names)}", "a longer one")
    return found[0]


def find_runs(outputs: Path) -> list[RunRecord]:
    """Find the run folders below a folder, sorted by experiment and key.

    Parameters
    ----------
    outputs : Path
        The folder that holds ``<experiment>/<key>/``.

    Returns
    -------
    list of RunRecord
        All of them, also those that cannot be used.

    Raises
    ------
    InputError
        If there is no such folder, or no run in it.
    """
    require(outputs.is_dir(), outputs, "no such folder", "a folder with run folders")
    try:
        folders = [path for folder in _folders(outputs) for path in _folders(folder)]
        runs = [run for run in map(read_record, folders) if run.manifest or is_run(run.folder)]
    except OSError as error:
        raise InputError(error.filename or outputs, error.strerror, "readable folders") from error
    right = "run folders <experiment>/<key>/; `gapath` makes them"
    if not runs and any(map(is_run, _folders(outputs))):
        right = f"the folder above, {outputs.resolve().parent}: these are runs of one experiment"
    require(bool(runs), outputs, "no runs", right)
    return runs


def _folders(place: Path) -> Iterator[Path]:
    """Give the folders within a folder, sorted; of one that must not be read, none."""
    with contextlib.suppress(PermissionError), os.scandir(place) as entries:
        for name in sorted(entry.name for entry in entries if entry.is_dir()):
            yield place / name


def _size(path: str) -> int | str:
    try:
        found = os.lstat(path)  # pathlib takes as long again
    except FileNotFoundError:
        return "no file"
    return found.st_size if stat.S_ISREG(found.st_mode) else "no file"
