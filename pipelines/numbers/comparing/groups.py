"""Trials of groups side by side: of the same problem, with the same random numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Table = NDArray[np.float64]

PROBLEM = ("map_digest", "map_instance", "start", "target")
"""Columns that say what is planned or driven: a map's content, not its name."""

SPENT = {
    "evaluations": ("evaluations",),
    "time": ("plan_time_s", "compute_time_s"),
    "cost": ("cost",),
}
"""Each amount, and the columns of the tasks that have it."""


@dataclass(frozen=True)
class Groups:
    """Trials of two or more groups, a row a block: one problem, seed and number of a trial.

    Parameters
    ----------
    names : tuple of str
        The groups.
    success : (blocks, groups) float64
        1 where the trial succeeded, else 0; NaN where a group has no such trial.
    spent : mapping of str to (blocks, groups) float64
        The amounts of `SPENT` that the task has: of every trial, failures included, but the cost
        only of those that succeeded.
    chance : tuple of bool
        Whether a group draws random numbers: one that does not does the same in each trial.
    repeated : int
        Trials that were left out, since another has the same block and group.
    blocks : bool
        Whether rows are blocks: not where no two trials pair, so that they stand as they come.
    problems : int
        How many problems there are.
    problem : (blocks, groups) float64 or None
        The number of each trial's problem; None where all are one.
    copies : (blocks,) bool or None
        Blocks in which no group draws random numbers and that repeat an earlier one, but for
        times.
    """

    names: tuple[str, ...]
    success: Table
    spent: Mapping[str, Table]
    chance: tuple[bool, ...]
    repeated: int
    blocks: bool = True
    problems: int = 1
    problem: Table | None = None
    copies: NDArray[np.bool_] | None = None

    def without_copies(self) -> "Groups":
        """Give the blocks that tell something of their own, but for times."""
        if self.copies is None or not self.copies.any():
            return self
        kept = ~self.copies
        return replace(
            self,
            success=self.success[kept],
            spent={name: values[kept] for name, values in self.spent.items()},
            problem=None if self.problem is None else self.problem[kept],
            copies=None,
        )


class Overlap(NamedTuple):
    """How many trials each group has, and how many pairs any two of them make."""

    trials: NDArray[np.int64]
    pairs: NDArray[np.int64]

    def paired(self, i: int, j: int) -> bool:
        """Tell whether at least half of the smaller group's trials have a partner."""
        fewer = min(self.trials[i], self.trials[j])
        return bool(fewer > 0 and 2 * self.pairs[i, j] >= fewer)


def overlap(values: Table, blocks: bool) -> Overlap:
    """Count trials and pairs.

    Parameters
    ----------
    values : (blocks, groups) float64
        NaN where a group has nothing.
    blocks : bool
        Whether its rows are blocks.

    Returns
    -------
    Overlap
        The counts.
    """
    there = (~np.isnan(values)).astype(float)
    pairs = np.rint(there.T @ there).astype(np.int64)
    return Overlap(pairs.diagonal().copy(), pairs if blocks else np.zeros_like(pairs))


def side_by_side(
    trials: pd.DataFrame, success: str, group: pd.Series, also: Sequence[str] = ()
) -> Groups:
    """Lay the trials of groups side by side, in blocks.

    Parameters
    ----------
    trials : DataFrame
        One row a trial of one task, as `read_trials` gives it.
    success : str
        The task's column that says whether a trial succeeded.
    group : Series of ordered categories
        The group of each trial, its categories in the order of the groups.
    also : sequence of str
        Columns that must be equal within a block, besides the problem, the seed and the number of
        the trial: settings that vary and are not what is compared. They have one value a run.

    Returns
    -------
    Groups
        Two trials of a group in one block are one that was done twice: the last counts.
    """
    columns = [*PROBLEM, "seed", *also]
    runs = trials.drop_duplicates("key").set_index("key")
    # In order: intervals draw blocks by their place, and the order of runs is that of their keys.
    tried = runs.groupby(columns, dropna=False, sort=True).ngroup()
    frame = pd.DataFrame(
        {
            "run": trials["key"].map(tried).to_numpy(),
            "trial": trials["trial"].to_numpy(),
            "group": group.cat.codes.to_numpy(),
        },
        index=trials.index,
    )
    once = ~frame.duplicated(keep="last")
    frame, kept = frame[once], trials[once]
    block = frame.groupby(["run", "trial"], sort=True).ngroup().to_numpy()
    blocks = len(np.unique(block)) < len(block)
    if not blocks:  # a row for each trial would be much of nothing
        place = frame.sort_values(["run", "trial"], kind="stable").groupby("group").cumcount()
        block = place[frame.index].to_numpy()
    names = tuple(str(name) for name in group.cat.categories)
    shape = (int(block.max(initial=-1)) + 1, len(names))

    def table(values: pd.Series) -> Table:
        filled = np.full(shape, np.nan)
        filled[block, frame["group"].to_numpy()] = values.to_numpy(dtype=float)
        return filled

    found = kept[success].astype(float)
    spent = {
        name: table(kept[column].where(found == 1) if name == "cost" else kept[column])
        for name, columns in SPENT.items()
        for column in columns
        if column in kept
    }
    problem = runs.groupby(list(PROBLEM), sort=True).ngroup()
    drawn = _drawn(kept, success)
    copies = None
    if blocks:
        never = ~kept["key"].map(drawn).groupby(block).any()
        of_block = pd.DataFrame({"run": frame["run"].to_numpy()}).groupby(block)["run"].first()
        copies = (of_block.duplicated() & never).to_numpy()
    return Groups(
        names,
        table(found),
        spent,
        _chance(kept["key"].map(drawn), frame["group"], names),
        int((~once).sum()),
        blocks,
        int(problem.nunique()),
        table(kept["key"].map(problem)),
        copies,
    )


def _drawn(trials: pd.DataFrame, success: str) -> pd.Series:
    """Tell of each run whether it draws random numbers: it evaluates, or its trials differ."""
    runs = trials.groupby("key")
    if "evaluations" not in trials:
        return runs.size() > 0
    results = [name for name in (success, "cost") if name in trials]
    differ = runs[results].nunique(dropna=False).gt(1).any(axis=1)
    drawn: pd.Series = runs["evaluations"].any() | differ
    return drawn


def _chance(drawn: pd.Series, group: pd.Series, names: Sequence[str]) -> tuple[bool, ...]:
    """Tell which groups draw random numbers."""
    found = drawn.groupby(group).any()
    return tuple(bool(found.get(code, False)) for code in range(len(names)))
