"""A run's first event as what an MCAP file holds beside its messages, and back.

Numbers are written so that they come back exactly; the arrays are attachments.
"""

import hashlib
import io
import json
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from gapath.errors import require
from gapath.events import RunStarted
from gapath.grid import Field, GridMap
from gapath.problem import CornerCutting, Problem
from gapath.store.settings import of_text, text_of

LOG_VERSION = "3"
"""Raised whenever an older reader would misread a log."""

NAME = "gapath"
"""Name of the metadata record."""

MAP, OPTIMAL_PATH = "map.npy", "optimal_path.npy"
"""Names of the attachments, in the order of the file."""

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
        Ends with ``sha256``, the digest of the other entries and both attachments.
    """
    problem, grid = run.problem, run.problem.map
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
        "map_name": grid.name,
        "map_source": grid.source,
        "map_instance": str(grid.instance),
        "map_resolution": repr(float(grid.resolution)),
        "map_origin": _numbers(map(float, grid.origin)),
        "map_start": _numbers(grid.start or ()),
        "map_target": _numbers(grid.target or ()),
        "settings": text_of(run.settings),
    } | {_VERSION_OF + name: version for name, version in run.versions.items()}
    return text | {"sha256": _digest(text, attachments(run))}


def attachments(run: RunStarted) -> dict[str, bytes]:
    """Give a run's arrays as ``.npy`` files, by name."""
    return {
        MAP: _npy(run.problem.map.weights, "<f8"),
        OPTIMAL_PATH: _npy(run.optimal_path, "<i4"),
    }


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
    require(version == LOG_VERSION, "gapath_log_version", version, LOG_VERSION)
    written = dict(text)
    digest = written.pop("sha256")
    require(_digest(written, files) == digest, "sha256", digest, "the digest of what is there")
    x, y, yaw = map(float, text["map_origin"].split())
    grid = GridMap(
        name=text["map_name"],
        weights=np.load(io.BytesIO(files[MAP]), allow_pickle=False),
        start=_field(text["map_start"]) if text["map_start"] else None,
        target=_field(text["map_target"]) if text["map_target"] else None,
        instance=int(text["map_instance"]),
        source=text["map_source"],
        resolution=float(text["map_resolution"]),
        origin=(x, y, yaw),
    )
    return RunStarted(
        experiment=text["experiment"],
        method=text["method"],
        task=text["task"],
        problem=Problem(
            grid,
            _field(text["start"]),
            _field(text["target"]),
            CornerCutting[text["corner_cutting"]],
        ),
        seed=int(text["seed"]),
        trials=int(text["trials"]),
        settings=of_text(text["settings"]),
        versions={
            name.removeprefix(_VERSION_OF): version
            for name, version in text.items()
            if name.startswith(_VERSION_OF)
        },
        optimal_path=np.load(io.BytesIO(files[OPTIMAL_PATH]), allow_pickle=False),
        optimal_cost=float(text["optimal_cost"]),
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


def _digest(text: Mapping[str, str], files: Mapping[str, bytes]) -> str:
    sha = hashlib.sha256(json.dumps(text, sort_keys=True).encode())
    for name in (MAP, OPTIMAL_PATH):
        sha.update(files[name])
    return sha.hexdigest()
