"""Which columns of runs a person wants to see, and how a run is called."""

from collections.abc import Iterable, Sequence

import pandas as pd

from gapath.pipelines.reading.frame import setting_columns
from gapath.store.status import WHOLE

_SHORT = 6
"""Fewest characters of a key."""

_COMMIT = r"^([0-9a-f]{8})[0-9a-f]{32}"
"""A commit, and so much of its name as tells it."""

METRICS = ("optimality_ratio", "evaluations", "plan_time_s", "length", "steps_ratio", "replans",
           "compute_time_s")  # fmt: skip
"""The results that a list shows, of those that its runs have."""


def short_keys(keys: Iterable[str]) -> dict[str, str]:
    """Shorten keys as far as each stays the beginning of no other.

    Parameters
    ----------
    keys : iterable of str
        All keys that there are.

    Returns
    -------
    dict of str to str
        Key -> its first six characters, or so many as it takes.
    """
    found = sorted(set(keys))
    ends = ["", *found, ""]
    lengths = [
        1 + max(_alike(key, other) for other in (ends[i], ends[i + 2]))
        for i, key in enumerate(found)
    ]
    return {key: key[: max(_SHORT, n)] for key, n in zip(found, lengths, strict=True)}


def _alike(key: str, other: str) -> int:
    pairs = enumerate(zip(key, other, strict=False))
    return next((i for i, (a, b) in pairs if a != b), min(len(key), len(other)))


def listed(frame: pd.DataFrame, keys: Iterable[str]) -> pd.DataFrame:
    """Choose the columns of a list of runs for people.

    Parameters
    ----------
    frame : DataFrame
        The runs to list, as `gapath.pipelines.reading.frame.run_frame` gives them, with `key` as
        a column.
    keys : iterable of str
        The keys of all runs that there are, from which those of the list are told apart.

    Returns
    -------
    DataFrame
        A row a run in the same order: its short key, experiment, map and method, the settings
        that vary among the runs and are not told by these names, success, trials, a few results,
        state and date.
    """
    known = frame[frame["preset"].notna()]
    settings = [name for name in setting_columns(frame) if _varies(known, name)]
    place = ["map", "map_instance", "start", "target"]
    place = ["map", *(name for name in place[1:] if _more(known, name, ["map"]))]
    of_map = [name for name in settings if name.startswith("map.")]
    shown = [name for name in of_map if _more(known, name, place)]
    tried = [name for name in settings if not name.startswith(("map.", "recorder."))]
    tried = [name for name in tried if _more(known, name, ["preset"])]
    method = ["preset", *tried] if tried else ["method"]
    if _more(known, "method", method):
        method.insert(1, "method")
    head = ["experiment", *(["task"] if _varies(known, "task") else []), *place, *shown, *method]
    head += ["seed"] if _varies(known, "seed") else []
    metrics = [name for name in METRICS if name in frame and frame[name].notna().any()]
    said = [name for name in ("superseded", "commit", "tags", "note") if frame[name].notna().any()]
    if (frame["gapath_commit"].notna() & (frame["gapath_commit"] != frame["commit"])).any():
        said.insert(said.index("commit") + 1 if "commit" in said else 0, "gapath_commit")
    tail = ["state", *said, "date"]
    short = short_keys(keys)
    rows = frame[[*head, "trials", "success", *metrics, *tail]].assign(
        **{
            name: frame[name].str.replace(_COMMIT, r"\1", regex=True)
            for name in said
            if name.endswith("commit")
        },
        date=frame["date"].str[:16].str.replace("T", " "),
        state=frame["state"].where(frame["fault"].isna() | ~frame["state"].isin(WHOLE), "unusable"),
    )
    if "superseded" in rows:
        rows = rows.assign(superseded=rows["superseded"].map(short))
    rows.insert(0, "key", frame["key"].map(short))
    return rows


def importance(rows: pd.DataFrame) -> dict[str, int]:
    """Tell how important the columns of a list are: all that it may do without."""
    names = ("experiment", "task", "map", "preset", "method", "seed", "state")
    same = [name for name in names if name in rows and not _varies(rows, name)]
    last = ["note", "gapath_commit", "commit", "date", "start", "target", "trials", "seed"]
    last += ["superseded", "map_instance", "tags"]
    best = ["task", "experiment", "state", "map", "method", "preset", "success"]
    settings = [name for name in rows if name not in ("key", *METRICS, *last, *best)]
    order = [*reversed(METRICS), *reversed(same), *last, *reversed(settings), *best]
    return {name: order.index(name) for name in rows if name != "key"}


def _varies(frame: pd.DataFrame, name: str) -> bool:
    return len(frame[name].drop_duplicates()) > 1


def _more(frame: pd.DataFrame, name: str, names: Sequence[str]) -> bool:
    """Tell whether a column says more than others do together."""
    return len(frame[[*names, name]].drop_duplicates()) > len(frame[[*names]].drop_duplicates())
