"""A run's first event as what an MCAP file holds beside its messages, and back.

Numbers are written so that they come back exactly; the arrays are attachments.
"""

import hashlib
import io
import json
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gapath.errors import require
from gapath.events import RunStarted
from gapath.grid import Field, GridMap
from gapath.problem import CornerCutting, Problem
from gapath.scenario.listed import Queries
from gapath.store.settings import of_text, text_of

LOG_VERSION = "5"
"""Raised whenever an older reader would misread a log."""

_READ = ("4", LOG_VERSION)  # a log of version 4 has no population, and is else the same

NAME = "gapath"
"""Name of the metadata record."""

QUERIES = "queries.npy"
"""Name of the attachment of a run over several pairs of start and target."""

OPTIMAL_PATH = "optimal_path.npy"
"""Name of the last attachment; the maps lie before it."""

_MAP = "map"  # the name of the map itself; those of `Problem.maps` are named after their settings
_NPY = ".npy"

_VERSION_OF = "version/"  # before the names of packages


def metadata(run: RunStarted) -> dict[str, str]:
    """Describe a run, all but its arrays.

    Parameters
    ----------
    run : RunStarted
        The run's first event.

    Returns
    -------
    dict of str to str
        Ends with ``sha256``, the digest of the other entries and all attachments.
    """
    problem = run.problem
    text = {
        "gapath_log_version": LOG_VERSION,
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
    for name, grid in _all_maps(problem).items():
        text |= _map_text(name, grid)
    text |= {_VERSION_OF + name: version for name, version in run.versions.items()}
    return text | {"sha256": _digest(text, attachments(run))}


def _all_maps(problem: Problem) -> dict[str, GridMap]:
    return {_MAP: problem.map, **problem.maps}


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


def attachments(run: RunStarted) -> dict[str, bytes]:
    """Give a run's arrays as ``.npy`` files, by name."""
    maps = _all_maps(run.problem).items()
    weights = {name + _NPY: _npy(grid.weights, "<f8") for name, grid in maps}
    queries = run.problem.queries
    listed = {} if queries is None else {QUERIES: _npy(_in_rows(queries), "<f8")}
    return weights | listed | {OPTIMAL_PATH: _npy(run.optimal_path, "<i4")}


def _in_rows(queries: Queries) -> NDArray[np.float64]:
    """Put queries into one array: number, bucket, start x, y, target x, y, length."""
    return np.column_stack(queries.columns)


def _queries(rows: NDArray[np.float64]) -> Queries:
    whole = rows[:, :6].astype(np.int32)
    return Queries(whole[:, 0], whole[:, 1], whole[:, 2:4], whole[:, 4:], rows[:, 6])


def run_started(text: Mapping[str, str], files: Mapping[str, bytes]) -> RunStarted:
    """Put a run's first event together again.

    Parameters
    ----------
    text : dict of str to str
        As `metadata` made it.
    files : dict of str to bytes
        As `attachments` made it.

    Returns
    -------
    RunStarted
        Equal to the one that was described.

    Raises
    ------
    InputError
        If the log has another version, or differs from what was written.
    Exception
        If an entry is missing or is no number: whatever Python or NumPy raise.
    """
    version = text.get("gapath_log_version")
    require(version in _READ, "gapath_log_version", version, " or ".join(_READ))
    written = dict(text)
    digest = written.pop("sha256")
    require(_digest(written, files) == digest, "sha256", digest, "the digest of what is there")
    return RunStarted(
        experiment=text["experiment"],
        method=text["method"],
        task=text["task"],
        problem=Problem(
            _grid_map(_MAP, text, files),
            _field(text["start"]),
            _field(text["target"]),
            CornerCutting[text["corner_cutting"]],
            {name: _grid_map(name, text, files) for name in json.loads(text["maps"])},
            queries=_queries(_array(files[QUERIES])) if QUERIES in files else None,
        ),
        seed=int(text["seed"]),
        trials=int(text["trials"]),
        settings=of_text(text["settings"]),
        versions={
            name.removeprefix(_VERSION_OF): version
            for name, version in text.items()
            if name.startswith(_VERSION_OF)
        },
        optimal_path=_array(files[OPTIMAL_PATH]),
        optimal_cost=float(text["optimal_cost"]),
    )


def _grid_map(name: str, text: Mapping[str, str], files: Mapping[str, bytes]) -> GridMap:
    x, y, yaw = map(float, text[f"{name}_origin"].split())
    start, target = text[f"{name}_start"], text[f"{name}_target"]
    return GridMap(
        name=text[f"{name}_name"],
        weights=_array(files[name + _NPY]),
        start=_field(start) if start else None,
        target=_field(target) if target else None,
        instance=int(text[f"{name}_instance"]),
        source=text[f"{name}_source"],
        resolution=float(text[f"{name}_resolution"]),
        origin=(x, y, yaw),
    )


def _numbers(values: Iterable[float]) -> str:
    return " ".join(map(repr, values))


def _field(text: str) -> Field:
    x, y = map(int, text.split())
    return x, y


def _npy(array: NDArray[np.generic], dtype: str) -> bytes:
    file = io.BytesIO()
    np.save(file, np.ascontiguousarray(array, dtype=dtype), allow_pickle=False)
    return file.getvalue()


def _array(file: bytes) -> NDArray[Any]:
    array: NDArray[Any] = np.load(io.BytesIO(file), allow_pickle=False)
    return array


def _digest(text: Mapping[str, str], files: Mapping[str, bytes]) -> str:
    sha = hashlib.sha256(json.dumps(text, sort_keys=True).encode())
    for name in sorted(files):
        sha.update(name.encode() + b"\0" + files[name])
    return sha.hexdigest()
