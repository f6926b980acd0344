"""A run's first event as what an MCAP file holds beside its messages, and back.

Numbers are written so that they come back exactly; the arrays are attachments.
"""

import hashlib
import io
import json
import math
import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from gapath.errors import InputError, require
from gapath.events import RunStarted
from gapath.grid import Field, GridMap
from gapath.problem import CornerCutting, Problem
from gapath.recorders.mcap.file.stored import Stored
from gapath.recorders.mcap.format import EARLIER, LOG_VERSION, LONGEST_STEP, Form, earlier
from gapath.scenario.listed import Queries
from gapath.store.settings import of_text, text_of

_OF_RECORDERS = ("recorder.", "recorder[")

LOST = "gapath_lost"
"""Name of the metadata record of a log that was saved and lacks something."""

NAME = "gapath"
"""Name of the metadata record."""

QUERIES = "queries.npy"
"""Name of the attachment of a run over several pairs of start and target."""

OPTIMAL_PATH = "optimal_path.npy"
"""Name of the last attachment; the maps lie before it."""

_MAP = "map"  # the name of the map itself; those of `Problem.maps` are named after their settings
_NPY = ".npy"

_VERSION_OF = "version/"  # before the names of packages


@dataclass(frozen=True)
class Lost:
    """What a log that was saved lacks before its last message.

    Parameters
    ----------
    messages : tuple of (int, int)
        First and last number of messages that are missing in between, in rising order.
    trials : frozenset of int
        The trials that lack something: readers leave them out.
    """

    messages: tuple[tuple[int, int], ...] = ()
    trials: frozenset[int] = frozenset()

    def has(self, number: int) -> bool:
        """Tell whether a message is one of these."""
        place = bisect_right(self.messages, (number, math.inf)) - 1
        return place >= 0 and number <= self.messages[place][1]

    @property
    def metadata(self) -> dict[str, dict[str, str]]:
        """The record that says so, if there is anything to say: name -> entries."""
        if not self.messages:
            return {}
        messages = " ".join(f"{first}-{last}" for first, last in self.messages)
        return {LOST: {"messages": messages, "trials": " ".join(map(str, sorted(self.trials)))}}

    @classmethod
    def of(cls, text: Mapping[str, str]) -> Self:
        """Read such a record's entries; raises InputError where they are others."""
        messages = _told(text, "messages", _ranges)
        ends = [number for pair in messages for number in pair]
        require(ends == sorted(ends) and len(ends) <= _MOST_LOST, LOST, ends[:9], "rising numbers")
        return cls(
            messages, _told(text, "trials", lambda trials: frozenset(map(int, trials.split())))
        )


NOTHING = Lost()
"""What most logs lack."""

_MOST_LOST = 2000


def metadata(run: RunStarted, form: Form) -> dict[str, str]:
    """Describe a run, all but its arrays.

    Parameters
    ----------
    run : RunStarted
        The run's first event.
    form : Form
        The log's.

    Returns
    -------
    dict of str to str
        Ends with ``sha256``, the digest of the other entries and all attachments.
    """
    problem = run.problem
    text = {
        "gapath_log_version": form.version,
        **({"step_ns": str(form.step_ns)} if form.is_bag else {}),
        "experiment": run.experiment,
        "method": run.method,
        "task": run.task,
        "seed": str(run.seed),
        "trials": str(run.trials),
        "start": _numbers(problem.start),
        "target": _numbers(problem.target),
        "corner_cutting": problem.corner_cutting.name,
        "optimal_cost": repr(float(run.optimal_cost)),
        "maps": json.dumps(list(problem.maps)),
        "settings": text_of(run.settings),
    }
    for name, grid in _all_maps(problem):
        text |= _map_text(name, grid)
    text |= {_VERSION_OF + name: version for name, version in run.versions.items()}
    return text | {"sha256": _digest(text, attachments(run))}


def _all_maps(problem: Problem) -> list[tuple[str, GridMap]]:
    return [(_MAP, problem.map), *problem.maps.items()]


def _map_text(name: str, grid: GridMap) -> dict[str, str]:
    """Describe a map, all but its weights."""
    return {
        f"{name}_name": grid.name,
        f"{name}_source": grid.source,
        f"{name}_instance": str(grid.instance),
        f"{name}_resolution": repr(float(grid.resolution)),
        f"{name}_origin": _numbers(map(float, grid.origin)),
        f"{name}_start": _numbers(grid.start or ()),
        f"{name}_target": _numbers(grid.target or ()),
    }


def attachments(run: RunStarted) -> list[Stored]:
    """Give a run's arrays as ``.npy`` files."""
    weights = [_npy(name + _NPY, grid.weights, "<f8") for name, grid in _all_maps(run.problem)]
    queries = run.problem.queries
    listed = [] if queries is None else [_npy(QUERIES, _in_rows(queries), "<f8")]
    return [*weights, *listed, _npy(OPTIMAL_PATH, run.optimal_path, "<i4")]


def _in_rows(queries: Queries) -> NDArray[np.float64]:
    """Put queries into one array: number, bucket, start x, y, target x, y, length."""
    return np.column_stack(queries.columns)


def _queries(rows: NDArray[np.float64]) -> Queries:
    whole = rows[:, :6].astype(np.int32)
    return Queries(whole[:, 0], whole[:, 1], whole[:, 2:4], whole[:, 4:], rows[:, 6])


def run_started(text: Mapping[str, str], files: Sequence[Stored]) -> RunStarted:
    """Put a run's first event together again.

    Parameters
    ----------
    text : dict of str to str
        As `metadata` made it.
    files : sequence of Stored
        As `attachments` made them.

    Returns
    -------
    RunStarted
        Equal to the one that was described.

    Raises
    ------
    InputError
        If the log has another version, differs from what was written, or an entry is missing or
        not what it must be.
    """
    version = form_of(text).version
    written, told = dict(text), partial(_told, text)
    digest = written.pop("sha256", None)
    require(_digest(written, files) == digest, "sha256", digest, "the digest of what is there")
    arrays, settings = _Arrays(files), told("settings", of_text)
    of_recorders = [name for name in settings if f"{name}.".startswith(_OF_RECORDERS)]
    good = version in ("4", "5") or not of_recorders
    require(good, "settings", of_recorders[:1], f"none of recorders in version {version}")
    return RunStarted(
        experiment=told("experiment"),
        method=told("method"),
        task=told("task"),
        problem=Problem(
            _grid_map(_MAP, told, arrays),
            told("start", _field),
            told("target", _field),
            told("corner_cutting", CornerCutting.__getitem__),
            {name: _grid_map(name, told, arrays) for name in told("maps", _names)},
            queries=_queries(arrays[QUERIES]) if QUERIES in arrays else None,
        ),
        seed=told("seed", int),
        trials=told("trials", int),
        settings=settings,
        versions=_versions(text),
        optimal_path=arrays[OPTIMAL_PATH],
        optimal_cost=told("optimal_cost", float),
    )


def form_of(text: Mapping[str, str]) -> Form:
    """Read from the metadata what form a log has; raises InputError where it is none."""
    version = text.get("gapath_log_version")
    known = (*EARLIER, LOG_VERSION)
    require(version in known, "gapath_log_version", version, f"one of {', '.join(known)}")
    if version != LOG_VERSION:
        return earlier(str(version))
    step_ns = _told(text, "step_ns", int)
    good = 1 <= step_ns <= LONGEST_STEP and text["step_ns"] == str(step_ns)
    require(good, "metadata, step_ns", step_ns, f"a whole number from 1 to {LONGEST_STEP}")
    return Form(LOG_VERSION, step_ns)


def _told(text: Mapping[str, str], name: str, read: Callable[[str], Any] = str) -> Any:
    """Read an entry; raises InputError that names it."""
    try:
        return read(text[name])
    except Exception as error:  # whatever Python raises at what is no such value
        found = repr(text[name]) if name in text else "nothing"
        raise InputError(f"metadata, {name}", found, "what gapath writes there") from error


class _Arrays:
    """The arrays that attachments hold, by name."""

    def __init__(self, files: Iterable[Stored]) -> None:
        self._files = {file.name: file for file in files}

    def __contains__(self, name: str) -> bool:
        return name in self._files

    def __getitem__(self, name: str) -> NDArray[Any]:
        try:
            array = _array(self._files[name])
        except Exception as error:  # whatever NumPy raises at what is no array
            raise InputError(f"attachment {name}", type(error).__name__, "an array") from error
        shape, kind = _SHAPES.get(name, (0, "f"))
        good = array.ndim == 2 and array.dtype.kind == kind and shape in (0, array.shape[1])
        require(good, f"attachment {name}", f"{array.dtype} {array.shape}", "another array")
        return array


def _array(file: Stored) -> NDArray[Any]:
    """Read an ``.npy`` file, whose head says no more than there is; no byte of it is copied."""
    (content,) = file.parts
    stream = io.BytesIO(content[: 1 << 16])
    assert np.lib.format.read_magic(stream) == (1, 0)
    shape, by_columns, dtype = np.lib.format.read_array_header_1_0(stream)
    begin = stream.tell()
    assert not by_columns and not dtype.hasobject
    assert dtype.itemsize * math.prod(shape) == file.size - begin
    array = np.frombuffer(content, dtype, offset=begin).reshape(shape)
    return array if array.flags.aligned else array.copy()


_SHAPES = {OPTIMAL_PATH: (2, "i"), QUERIES: (7, "f")}


def _grid_map(name: str, told: Callable[..., Any], arrays: _Arrays) -> GridMap:
    return GridMap(
        name=told(f"{name}_name"),
        weights=arrays[name + _NPY],
        start=told(f"{name}_start", _maybe_field),
        target=told(f"{name}_target", _maybe_field),
        instance=told(f"{name}_instance", int),
        source=told(f"{name}_source"),
        resolution=told(f"{name}_resolution", float),
        origin=told(f"{name}_origin", _pose),
    )


def _ranges(text: str) -> tuple[tuple[int, int], ...]:
    pairs = (pair.partition("-")[::2] for pair in text.split())
    return tuple((int(first), int(last)) for first, last in pairs)


def _names(text: str) -> list[str]:
    names: list[str] = json.loads(text)
    assert isinstance(names, list) and all(isinstance(name, str) for name in names)
    return names


def _versions(text: Mapping[str, str]) -> dict[str, str]:
    """Read versions, which are said beside what was found: names and words, no sentences."""
    found = {}
    for name in text:
        if name.startswith(_VERSION_OF):
            what = name.removeprefix(_VERSION_OF)
            require(_WORD.fullmatch(what) is not None, "metadata", name, "version/ and a name")
            found[what] = _told(text, name, _version)
    require(len(found) <= _MOST_VERSIONS, "metadata", f"{len(found)} versions", "fewer")
    return found


def _version(text: str) -> str:
    assert _WORD.fullmatch(text)
    return text


_WORD = re.compile(r"[\w.+!-]{1,99}", re.ASCII)
_MOST_VERSIONS = 100


def _pose(text: str) -> tuple[float, float, float]:
    x, y, yaw = map(float, text.split())
    return x, y, yaw


def _maybe_field(text: str) -> Field | None:
    return _field(text) if text else None


def _numbers(values: Iterable[float]) -> str:
    return " ".join(map(repr, values))


def _field(text: str) -> Field:
    x, y = map(int, text.split())
    return x, y


def _npy(name: str, array: NDArray[np.generic], dtype: str) -> Stored:
    """Store an array as NumPy would save it."""
    array, head = np.ascontiguousarray(array, dtype=dtype), io.BytesIO()
    np.lib.format.write_array_header_1_0(head, np.lib.format.header_data_from_array_1_0(array))
    return Stored(name, (head.getvalue(), array.reshape(-1).view(np.uint8).data))


def _digest(text: Mapping[str, str], files: Iterable[Stored]) -> str:
    sha = hashlib.sha256(json.dumps(text, sort_keys=True).encode())
    for file in sorted(files, key=lambda file: file.name):
        sha.update(file.name.encode() + b"\0")
        for part in file.parts:
            sha.update(part)
    return sha.hexdigest()
