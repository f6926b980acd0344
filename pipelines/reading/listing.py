"""The list of run folders, for people."""

from collections.abc import Iterable

from gapath.pipelines.reading.names import told_apart
from gapath.store.records import RunRecord


def listing(runs: Iterable[RunRecord]) -> list[dict[str, str]]:
    """Describe run folders for people.

    Parameters
    ----------
    runs : iterable of RunRecord
        The runs.

    Returns
    -------
    list of dict
        One a run: key, experiment, map, method (planner or navigator), trials, state, date and
        size; "?" where no manifest says it.
    """
    rows = []
    runs = list(runs)
    apart = {run.folder: run for run in told_apart([run for run in runs if not run.fault])}
    for run in (apart.get(run.folder, run) for run in runs):
        known = run.manifest
        instance = f" #{known.map_instance}" if known and known.map_instance else ""
        rows.append(
            {
                "key": run.folder.name,
                "experiment": run.folder.parent.name,
                "map": known.map + instance if known else "?",
                "method": known.method if known else "?",
                "trials": str(known.trials) if known else "?",
                "state": run.state,
                "date": run.date[:16].replace("T", " "),
                "size": size_text(run.bytes),
            }
        )
    return rows


def size_text(count: float) -> str:
    """Write a number of bytes for people."""
    for unit in ("B", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} {unit}"
        count /= 1000
    return f"{count:.1f} GB"
