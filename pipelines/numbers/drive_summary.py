"""What groups of drives come to: rows of a table."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from gapath.events import Outcome
from gapath.pipelines.numbers.grouped import Groups
from gapath.pipelines.numbers.summary import rates
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


def summarise_drives(drives: pd.DataFrame, groups: Groups) -> dict[str, Any]:
    """Summarise drives of some settings, failures included.

    Steps / shortest exists only where the target was reached. A navigator that draws no
    random numbers does the same in each trial of a map, so its rates have no interval.

    Parameters
    ----------
    drives : DataFrame
        One row a drive.
    groups : Groups
        The setting of each.

    Returns
    -------
    dict
        n; for each outcome its count, rate and interval; never_left, how many returned without
        having gone anywhere; the mean number of planner calls by
        part; for steps, steps_ratio, replans and seconds the fields of `grouped.Spread`. A value
        a group each.
    """
    n, repeats = groups.sizes, _repeats(drives, groups)
    row: dict[str, Any] = {"n": n}
    for outcome in OUTCOMES:
        count = groups.counts(drives["outcome"] == outcome)
        of = rates(f"{outcome}_rate", count, n)
        row |= {outcome: count, f"{outcome}_rate": of[f"{outcome}_rate"]}
        for end in ("low", "high"):
            row[f"{outcome}_{end}"] = np.where(repeats, np.nan, of[f"{outcome}_rate_{end}"])
    stayed = (drives["outcome"] == RETURNED) & (drives["stands"] == drives["steps"])
    row["never_left"] = groups.counts(stayed)
    row |= {f"calls_{part}": groups.sums(drives[f"calls_{part}"]) / n for part in "abc"}
    for name, column in _SPREADS.items():
        spread = groups.spreads(drives[column])._asdict()
        row |= {f"{name}_{key}": values for key, values in spread.items()}
    return row


def rate(row: Mapping[Any, Any], outcome: str) -> str:
    """Write a rate in percent with its interval, and how many that returned never left."""
    interval = percent_range((row[f"{outcome}_low"], row[f"{outcome}_high"]))
    known = not np.isnan(row[f"{outcome}_low"])
    text = percent(row[f"{outcome}_rate"]) + (f" ({interval})" if known else "")
    never = outcome == RETURNED and row["never_left"]
    return text + (f"; {row['never_left']:.0f} never left" if never else "")


def _repeats(drives: pd.DataFrame, groups: Groups) -> Any:
    """Tell of which groups every trial of a map was the same drive, without a random number."""
    by = [groups.of, drives["map"], drives["map_instance"]]
    steps = drives["steps"].groupby(by, observed=True).nunique()
    maps = Groups(steps.index.get_level_values(0).to_numpy(), groups.count)
    same = maps.counts(steps != 1) == 0
    return same & (groups.counts(drives["evaluations"] != 0) == 0)
