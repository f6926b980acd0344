"""What a crate says of its runs: ``ro-crate-metadata.json``, a Process Run Crate."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any, NamedTuple
from urllib.parse import quote

from gapath.crates.plain import as_value, without_folders
from gapath.crates.reading import PROFILE
from gapath.errors import require_extra
from gapath.store.records import CONFIG, FileEntry, Manifest, RunRecord
from gapath.store.settings import flatten

_VERSION = "1.1"
"""Of RO-Crate, that the profile asks for."""

_PROFILE_VERSION = "0.5"

_TERMS = "https://w3id.org/ro/terms/workflow-run/context"
"""Has ``environment`` and ``sha256``, which the context of RO-Crate 1.1 lacks."""

_COMPLETED = "http://schema.org/CompletedActionStatus"

_KINDS = {
    ".json": "application/json",
    ".yaml": "application/yaml",
    ".parquet": "application/vnd.apache.parquet",
    ".png": "image/png",
}
_BYTES = "application/octet-stream"

_FILES = {
    "metadata.yaml": "what makes the folder a bag of ROS 2",
    "run.mcap": "the log: the map, the settings, every event of every trial",
    "trials.parquet": "a row a trial",
    CONFIG: "the settings",
    "manifest.json": "what was run, with which versions, and the hashes of what came of it",
    "status.json": "when it ran, and how it ended",
}


class Packed(NamedTuple):
    """A run in a crate.

    Parameters
    ----------
    run : RunRecord
        The run, its manifest and status as the crate has them.
    files : mapping of str to FileEntry
        Its files: place in the crate -> what it holds.
    inputs : mapping of str to FileEntry
        The files that it was made from, as far as they are in the crate, likewise.
    missing : mapping of str to str
        Those that are not, since they are gone or changed: name -> SHA-256.
    """

    run: RunRecord
    files: Mapping[str, FileEntry]
    inputs: Mapping[str, FileEntry]
    missing: Mapping[str, str]


class Credits(NamedTuple):
    """What no run says of itself.

    Parameters
    ----------
    author : str
        Who made it; empty if that is not said.
    organization : (str, str) or None
        Name and address of the author's organization.
    licence : str
        Address of the licence; empty if none is given.
    """

    author: str = ""
    organization: tuple[str, str] | None = None
    licence: str = ""


def library() -> tuple[Any, Any]:
    """Give what of rocrate is used; raises InputError if it is not installed."""
    require_extra("crate", "crate")
    from rocrate.model import ContextEntity
    from rocrate.rocrate import ROCrate

    return ContextEntity, ROCrate


def describe(packed: Sequence[Packed], credit: Credits) -> bytes:
    """Describe runs as a crate.

    Parameters
    ----------
    packed : sequence of Packed
        Runs, at least one.
    credit : Credits
        Who made it, and what others may do with it.

    Returns
    -------
    bytes
        The content of ``ro-crate-metadata.json``.

    Raises
    ------
    InputError
        If the library that writes it is not installed.
    """
    graph = _Graph()
    agent = graph.credit(credit)
    actions = [graph.action(each, agent) for each in packed]
    runs = [each.run for each in packed]
    names = sorted({run.known.experiment for run in runs})
    count = f"{len(runs)} run{'s' * (len(runs) > 1)}"
    graph.root(
        name=f"{', '.join(names)}: {count} of gapath",
        description=f"{count} of path planning, with settings, maps, every step and the results. "
        f"Do them again and compare: gapath-log repeat DIR",
        datePublished=max(run.date for run in runs),
        mentions=actions,
    )
    return graph.written()


class _Graph:
    """The entities of a crate; each is there once, under a name that its content gives."""

    def __init__(self) -> None:
        self._kind, crate = library()
        self._crate = crate(version=_VERSION)
        self._crate.metadata.extra_contexts.append(_TERMS)
        self._known: dict[str, Any] = {}
        profile = self._put(
            PROFILE + _PROFILE_VERSION,
            "CreativeWork",
            name="Process Run Crate",
            version=_PROFILE_VERSION,
        )
        self.root(conformsTo=profile)

    def root(self, **properties: Any) -> None:
        """Say something of the crate as a whole."""
        for name, value in properties.items():
            self._crate.root_dataset[name] = _single(value)

    def written(self) -> bytes:
        """Give the file's content."""
        return b"".join(part for _, part in self._crate.metadata.stream()) + b"\n"

    def _put(self, name: str, kind: str, /, **properties: Any) -> Any:
        if name not in self._known:
            told = {key: _single(v) for key, v in properties.items() if v is not None}
            given = {"@type": kind, **told}
            self._known[name] = self._crate.add(self._kind(self._crate, name, properties=given))
        return self._known[name]

    def credit(self, given: Credits) -> Any:
        """Say whose it is; gives who did it, or None."""
        none = "No licence was given: the authors keep all rights."
        licence = (
            self._put(given.licence, "CreativeWork", name=given.licence)
            if given.licence
            else self._put("#no-licence", "CreativeWork", name="none", description=none)
        )
        self.root(license=licence)
        place = None
        if given.organization:
            name, url = given.organization
            place = self._put(url, "Organization", name=name, url=url)
            self.root(publisher=place)
        if not given.author:
            return place
        author = self._put("#author", "Person", name=given.author, affiliation=place)
        self.root(author=author)
        return author

    def action(self, packed: "Packed", agent: Any) -> Any:
        """Say what was done; gives the action."""
        run, known = packed.run, packed.run.known
        files = {place: self._file(place, entry) for place, entry in packed.files.items()}
        settings = [file for place, file in files.items() if PurePosixPath(place).name == CONFIG]
        inputs = [self._file(place, entry) for place, entry in packed.inputs.items()]
        inputs += [self._missing(name, sha) for name, sha in packed.missing.items()]
        trials = f"{known.trials} trial{'s' * (known.trials > 1)}"
        return self._put(
            f"#{quote(run.name)}",
            "CreateAction",
            name=f"{known.method} on {known.map}, {trials}, seed {known.seed}",
            description=known.command,
            startTime=run.status.started,
            endTime=run.date,
            actionStatus=_COMPLETED,
            agent=agent,
            instrument=self._software(known),
            object=[*settings, *inputs, self._map(known), *self._settings(run)],
            result=[*(f for f in files.values() if f not in settings), *self._figures(run)],
            environment=self._environment(known),
        )

    def _file(self, place: str, entry: FileEntry) -> Any:
        if place not in self._known:
            path = PurePosixPath(place)
            told = {
                "name": path.name,
                "description": _FILES.get(path.name),
                "contentSize": str(entry.bytes),
                "sha256": entry.sha256,
                "encodingFormat": _KINDS.get(path.suffix, _BYTES),
            }
            given = {key: value for key, value in told.items() if value is not None}
            file = self._crate.add_file(dest_path=quote(place), properties=given)
            self._known[place] = file
        return self._known[place]

    def _missing(self, name: str, sha256: str) -> Any:
        why = "Not in the crate: gone or changed since. The log has the maps that were read of it."
        plain = without_folders(name)
        return self._put(f"#{sha256}", "CreativeWork", name=plain, sha256=sha256, description=why)

    def _software(self, known: Manifest) -> Any:
        version, code = known.versions.get("gapath", ""), known.versions.get("code", "")
        return self._put(
            f"#gapath-{quote(version)}-{quote(code)}",
            "SoftwareApplication",
            name="gapath",
            softwareVersion=version,
            identifier=code,
            description="Genetic algorithms for mobile robot path planning. The identifier is a "
            "hash of its sources: gapath.store.keys.code_hash.",
        )

    def _map(self, known: Manifest) -> Any:
        told = f"instance {known.map_instance}; its weights are in the log, {known.map_digest}"
        return self._property("map", known.map, told)

    def _settings(self, run: RunRecord) -> list[Any]:
        return self._properties(run.settings, "setting")

    def _environment(self, known: Manifest) -> list[Any]:
        origin = flatten(known.provenance or {})
        return self._properties({**known.versions, **origin}, "environment")

    def _figures(self, run: RunRecord) -> list[Any]:
        found = run.known.results
        if found is None:
            return []
        told = {"trials": found.trials, "succeeded": found.succeeded}
        figures = [self._property(name, value) for name, value in told.items()]
        for name, total in found.sums.items():
            count = found.counts.get(name, found.trials)
            if count:
                over = f"mean over the {count} trials in which it is defined"
                figures.append(self._property(name, total / count, over))
        return figures

    def _properties(self, values: Mapping[str, object], what: str) -> list[Any]:
        return [self._property(name, value, what) for name, value in values.items()]

    def _property(self, name: str, value: object, told: str | None = None) -> Any:
        plain = as_value(without_folders(value))
        content = json.dumps([name, plain, told]).encode()
        return self._put(
            f"#{hashlib.sha256(content).hexdigest()[:16]}",
            "PropertyValue",
            name=name,
            value=plain,
            description=told,
        )


def _single(value: Any) -> Any:
    """Give a list of one as that one, as JSON-LD is written."""
    return value[0] if isinstance(value, list) and len(value) == 1 else value
