"""Which trials of groups can be held against each other: those of problems that all groups have."""

from collections.abc import Sequence
from typing import NamedTuple

import pandas as pd

from gapath.pipelines.numbers.comparing.groups import PROBLEM
from gapath.pipelines.numbers.text import number

_FEW = 0.05
"""A group with less than this share of the usual number of trials is an accident."""


class Comparable(NamedTuple):
    """Trials that can be compared, the group of each, and sentences on what was left out."""

    trials: pd.DataFrame
    group: pd.Series
    said: tuple[str, ...]


def comparable(trials: pd.DataFrame, group: pd.Series, also: Sequence[str]) -> Comparable:
    """Leave out what would make the difference of groups one of their problems.

    Parameters
    ----------
    trials : DataFrame
        One row a trial of one task, as `read_trials` gives it.
    group : Series of ordered categories
        The group of each trial.
    also : sequence of str
        Settings that vary within groups, as columns.

    Returns
    -------
    Comparable
        Without groups of next to no trials, unless they draw no random numbers; and of problems,
        under each value of the settings in `also`, only those that all groups have, if there is
        one.
    """
    said = []
    sizes = group.value_counts()
    drawn = pd.Series(True, index=trials.index)
    if "evaluations" in trials:
        drawn = trials["evaluations"] > 0
    chance = drawn.groupby(group, observed=True).any()
    few = [name for name in sizes.index if chance[name] and sizes[name] < _FEW * sizes.median()]
    if few and len(sizes) - len(few) > 1:
        usual = number(float(sizes.median()))
        for name in sorted(few):
            n = "1 trial" if sizes[name] == 1 else f"{number(int(sizes[name]))} trials"
            said.append(f"{name} is left out: {n}, where others have {usual}.")
        trials, group = _kept(trials, group, ~group.isin(few))
    runs = trials.drop_duplicates("key").set_index("key")
    cell = runs.groupby([*PROBLEM, *also], dropna=False, sort=False).ngroup()
    of_group = group[trials.index.isin(trials.drop_duplicates("key").index)]
    there = pd.DataFrame({"cell": cell.to_numpy(), "group": of_group.to_numpy()}).drop_duplicates()
    counts = there["cell"].value_counts()
    shared = counts.index[counts == there["group"].nunique()]
    if len(shared) == 0:
        said.append("No problem is one of all groups: what each comes to is of its own problems.")
    elif len(shared) < len(counts):
        inside = trials["key"].map(cell).isin(shared)
        left = number(int((~inside).sum()))
        settings = "".join(f", {name}" for name in also)
        said.append(
            f"{left} trials are left out: not all groups have their problem (map, start, target, "
            f"instance{settings})."
        )
        trials, group = _kept(trials, group, inside)
    return Comparable(trials, group, tuple(said))


def _kept(
    trials: pd.DataFrame, group: pd.Series, where: pd.Series
) -> tuple[pd.DataFrame, pd.Series]:
    return trials[where], group[where].cat.remove_unused_categories()
