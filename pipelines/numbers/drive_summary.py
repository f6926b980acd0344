"""What a group of drives comes to: one row of a table."""

import numpy as np
import pandas as pd

from gapath.events import Outcome
from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.numbers.summary import spread
from gapath.pipelines.numbers.text import percent, percent_range

OUTCOMES = tuple(outcome.name.lower() for outcome in Outcome)
RETURNED = Outcome.RETURNED.name.lower()

_SPREADS = {
    "steps": "steps",
    "steps_ratio": "steps_ratio",
    "replans": "replans",
    "seconds": "compute_time_s",
}
"""Each quantity's column in the rows of drives."""


def summarise_drives(drives: pd.DataFrame) -> dict[str, float]:
    """Summarise drives of one setting, failures included.

    Steps / shortest exists only where the target was reached. A navigator that draws no
    random numbers does the same in each trial of a map, so its rates have no interval.

    Parameters
    ----------
    drives : DataFrame
        One row a drive.

    Returns
    -------
    dict
        n; for each outcome its count, rate and interval; never_left, how many returned without
        having gone anywhere; the mean number of planner calls by
        part; for steps, steps_ratio, replans and seconds the fields of `summary.Spread`.
    """
    n = len(drives)
    row: dict[str, float] = {"n": n}
    for outcome in OUTCOMES:
        count = int((drives["outcome"] == outcome).sum())
        low, high = (np.nan, np.nan) if _repeats(drives) else wilson(count / n, n)
        row |= {outcome: count, f"{outcome}_rate": count / n}
        row |= {f"{outcome}_low": low, f"{outcome}_high": high}
    stayed = (drives["outcome"] == RETURNED) & (drives["stands"] == drives["steps"])
    row["never_left"] = int(stayed.sum())
    row |= {f"calls_{part}": drives[f"calls_{part}"].mean() for part in "abc"}
    for name, column in _SPREADS.items():
        row |= {f"{name}_{key}": value for key, value in spread(drives[column])._asdict().items()}
    return row


def rate(row: pd.Series, outcome: str) -> str:
    """Write a rate in percent with its interval, and how many that returned never left."""
    interval = percent_range((row[f"{outcome}_low"], row[f"{outcome}_high"]))
    known = not np.isnan(row[f"{outcome}_low"])
    text = percent(row[f"{outcome}_rate"]) + (f" ({interval})" if known else "")
    never = outcome == RETURNED and row["never_left"]
    return text + (f"; {row['never_left']:.0f} never left" if never else "")


def _repeats(drives: pd.DataFrame) -> bool:
    """Tell whether every trial of a map was the same drive, without a random number."""
    steps = drives.groupby(["map", "map_instance"])["steps"].nunique()
    return not drives["evaluations"].any() and bool((steps == 1).all())
