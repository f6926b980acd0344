"""An experiment's runs in one file, which has the same bytes wherever it is made."""

import gzip
import hashlib
import io
import os
import tarfile
from contextlib import suppress
from pathlib import Path
from typing import IO, NamedTuple

from gapath.errors import InputError, one_of, require
from gapath.pipelines.reading.tags import TAGS, read_said, text_of
from gapath.store.durable import named, new_file, open_regular, part_of, publish
from gapath.store.records import MANIFEST, Manifest, RunRecord, is_run, read_record
from gapath.store.status import STATUS, Status, contents

ENDING = ".tar.gz"


class Packed(NamedTuple):
    """What was packed.

    Parameters
    ----------
    runs : list of RunRecord
        The runs.
    left_out : list of RunRecord
        Those that cannot be used.
    """

    runs: list[RunRecord]
    left_out: list[RunRecord]


def pack(outputs: Path, experiment: str, file: Path) -> Packed:
    """Pack the runs of an experiment that can be used, and what is said of them.

    Names are sorted, times, owners and permissions are the same for all, so that the bytes depend
    on the runs alone, and on the version of zlib.

    Parameters
    ----------
    outputs : Path
        The folder that holds ``<experiment>/<key>/``.
    experiment : str
        Its name.
    file : Path
        Where to; it is there whole or not at all.

    Returns
    -------
    Packed
        What was packed.

    Raises
    ------
    InputError
        If there is no such experiment, no run of it can be used, a file of a run is not as its
        manifest says, or the archive is there already or cannot be written.
    """
    require(outputs.is_dir(), outputs, "no such folder", "a folder with run folders")
    with named(outputs):
        names = sorted(path.name for path in outputs.iterdir() if path.is_dir())
    require(experiment in names, "EXPERIMENT", experiment, one_of(experiment, names))
    require(file.name.endswith(ENDING), "FILE", file, f"a name that ends in {ENDING}")
    require(not os.path.lexists(file), "FILE", file, "a file that is not there yet")
    place = outputs / experiment
    with named(place):
        folders = sorted(path for path in place.iterdir() if path.is_dir())
    runs = [read_record(path) for path in folders if is_run(path) and not path.is_symlink()]
    packed = Packed([r for r in runs if not r.fault], [r for r in runs if r.fault])
    require(bool(packed.runs), place, "no run that can be used", "a finished run")
    keys = {run.folder.name for run in packed.runs}
    said = {key: said for key, said in read_said(place).items() if key in keys}
    part = part_of(file)
    try:
        with named(file), new_file(part) as raw:
            zipped = gzip.GzipFile("", "wb", 6, raw, mtime=0)
            with zipped, tarfile.open(fileobj=zipped, mode="w", format=tarfile.PAX_FORMAT) as tar:
                for run in packed.runs:
                    _add_run(tar, run)
                if said:
                    _add(tar, f"{experiment}/{TAGS}", io.BytesIO(text_of(said)))
            raw.flush()
            os.fsync(raw.fileno())
        publish(part, file)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise
    return packed


def _add_run(tar: tarfile.TarFile, run: RunRecord) -> None:
    """Add the files of a run, as its manifest and status say that they are."""
    folder = run.folder
    status, manifest = contents(folder, STATUS), contents(folder, MANIFEST)
    found = hashlib.sha256(manifest).hexdigest()
    known = Manifest.read(folder, Status.read(folder).manifest or found)
    for name, entry in sorted(known.files.items()):
        with open_regular(folder / name) as raw:
            digest = _add(tar, f"{run.name}/{name}", raw)
        right = f"{entry.sha256[:12]}, as {MANIFEST} says"
        require(digest == entry.sha256, folder / name, f"SHA-256 {digest[:12]}", right)
    for name, data in ((MANIFEST, manifest), (STATUS, status)):
        _add(tar, f"{run.name}/{name}", io.BytesIO(data))
    same = (contents(folder, STATUS), contents(folder, MANIFEST)) == (status, manifest)
    require(same, folder, "a run that was done again meanwhile", "one that is left alone")


def _add(tar: tarfile.TarFile, name: str, file: IO[bytes]) -> str:
    """Add a file that says nothing of who has it since when; gives its SHA-256."""
    entry = tarfile.TarInfo(name)
    entry.size = file.seek(0, io.SEEK_END)
    file.seek(0)
    hashed = _Hashed(file)
    try:
        tar.addfile(entry, hashed)
    except OSError as error:
        if error.errno is None:  # tarfile's own: it is shorter now
            raise InputError(name, "a file that changes", "one that is left alone") from error
        raise
    return hashed.digest.hexdigest()


class _Hashed:
    """A file that is hashed as it is read."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file, self.digest = file, hashlib.sha256()

    def read(self, size: int = -1, /) -> bytes:
        data = self._file.read(size)
        self.digest.update(data)
        return data
