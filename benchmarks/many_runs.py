"""A folder of very many runs, made from a few real ones in about a minute."""

import hashlib
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measure import COMMAND, MAPS
from gapath.store.records import CONFIG, MANIFEST, TRIALS, FileEntry, Manifest
from gapath.store.rows import written
from gapath.store.status import STATUS, Status, as_json
from gapath.task import find_task, results

POPULATIONS = range(20, 140, 12)
"""Of GA 3; with each of the four maps of KG18's tests, 40 settings."""


@contextmanager
def many_runs(runs: int, trials: int) -> Iterator[Path]:
    """Make a folder of runs, as `gapath` leaves them but for logs, and remove it afterwards.

    Each of 40 settings is done once, truly, with so many trials. Its other runs, under other
    seeds, are made up: their rows are drawn from its rows, with replacement.

    Parameters
    ----------
    runs : int
        How many, of all settings together.
    trials : int
        Of each run.

    Yields
    ------
    Path
        The folder, ``<experiment>/<key>/`` in it.
    """
    from pyarrow import parquet

    with tempfile.TemporaryDirectory() as place:
        sweep = [f"map={','.join(MAPS)}", f"planner.population={','.join(map(str, POPULATIONS))}"]
        rest = ["planner=ga3", f"trials={trials}", "recorder=none", f"output={place}/real"]
        subprocess.run([COMMAND, "-m", *sweep, *rest], check=True, stdout=subprocess.DEVNULL)
        folders = sorted(Path(place).glob("real/*/*/"))
        real = [(folder, parquet.read_table(folder / TRIALS)) for folder in folders]
        for i in range(runs):
            seed, source = divmod(i, len(real))
            _write(*real[source], seed, Path(place) / "outputs")
        yield Path(place) / "outputs"


def _write(source: Path, table: Any, seed: int, outputs: Path) -> None:
    """Write a run folder like another, its rows drawn anew, under another seed."""
    known = Manifest.read(source)
    rows = _drawn(table, int(known.key, 16), seed) if seed else table
    config = (source / CONFIG).read_text("utf-8").replace("\nseed: 0\n", f"\nseed: {seed}\n")
    files = {CONFIG: config.encode(), TRIALS: written(rows)}
    task = find_task(known.task)
    manifest = replace(
        known,
        key=_hash(f"{known.key} {seed}".encode())[:16],
        setting=_hash(f"{known.setting} {seed}".encode())[:16],
        seed=seed,
        settings={**(known.settings or {}), "seed": seed},
        results=results(task, {name: rows[name].to_numpy() for name in rows.column_names}),
        files={name: FileEntry(_hash(data), len(data)) for name, data in files.items()},
    )
    text = as_json(asdict(manifest))
    files |= {
        MANIFEST: text,
        STATUS: replace(Status.read(source), manifest=_hash(text)).sealed(),
    }
    folder = outputs / known.experiment / manifest.key
    folder.mkdir(parents=True)
    for name, data in files.items():
        (folder / name).write_bytes(data)


def _drawn(table: Any, key: int, seed: int) -> Any:
    import pyarrow as pa

    count = len(table)
    drawn = table.take(np.random.default_rng([key, seed]).integers(count, size=count))
    columns = {
        "seed": pa.array(np.full(count, seed, dtype=np.uint64)),
        "trial": table["trial"],
    }
    for name, column in columns.items():
        drawn = drawn.set_column(table.column_names.index(name), name, column)
    return drawn


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
