"""Whether groups of trials differ: in success, and in what they spend.

Every pair of groups is tested, and Holm's correction taken over all pairs of one quantity; of three
or more groups it is asked first whether they differ at all.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from gapath.pipelines.numbers.comparing.expected import Expected, expected
from gapath.pipelines.numbers.comparing.groups import Groups, Overlap, Table, overlap
from gapath.pipelines.numbers.comparing.omnibus import Omnibus, blocks_differ, samples_differ
from gapath.pipelines.numbers.comparing.pairwise import (
    LEVEL,
    Difference,
    holm,
    more_often,
    more_often_by_problem,
    paired_amounts,
    paired_rates,
    signed_rank,
    unpaired_amounts,
    unpaired_rates,
)
from gapath.pipelines.numbers.statistics import median_interval, wilson

QUANTITIES = (
    "success",
    "evaluations",
    "expected_evaluations",
    "time",
    "expected_time",
    "cost",
)
"""What `compare` compares: how often trials succeed; the median that they spend, failures included;
the expected one until a success; the median cost of what they found."""

_ALL_PAIRS = 12
"""Up to so many groups all pairs have effects, of more groups those with the best one."""


class Estimate(NamedTuple):
    """A group's own number with its 95 % interval; None where it cannot be had, and why.

    `rank` is its mean rank, 1 for the best, in the blocks in which all groups stand.
    """

    group: str
    n: int
    value: float | None
    low: float | None = None
    high: float | None = None
    why: str = ""
    rank: float | None = None


class Pair(NamedTuple):
    """Two groups held against each other.

    `first` and `second` are their names, `pairs` how many pairs of trials were compared, 0 where
    all trials of both were, unpaired; `difference` is of
    `gapath.pipelines.numbers.comparing.pairwise`, `adjusted` its p-value after Holm; `apart`
    tells whether the two can be told apart.
    """

    first: str
    second: str
    pairs: int
    difference: Difference
    adjusted: float | None
    apart: bool

    def swapped(self) -> "Pair":
        """Give the same with the other group first."""
        return self._replace(
            first=self.second, second=self.first, difference=self.difference.swapped()
        )


@dataclass(frozen=True)
class Comparison:
    """What groups come to in one quantity.

    Parameters
    ----------
    quantity : str
        One of `QUANTITIES`.
    estimates : tuple of Estimate
        Of all groups, best first, those without a number last: by their number, but amounts of
        trials on several problems, which are not of one size, by rank if there is one.
    pairs : tuple of Pair
        All pairs of the groups that have a number, in the order of the groups.
    omnibus : Omnibus or None
        None for two groups, and for expected amounts.
    by_rank : bool
        Whether the groups stand in the order of their ranks, not of their numbers.
    """

    quantity: str
    estimates: tuple[Estimate, ...]
    pairs: tuple[Pair, ...]
    omnibus: Omnibus | None
    by_rank: bool = False

    @property
    def best(self) -> Estimate | None:
        """The best group; None where no group has a number."""
        first = self.estimates[0]
        return None if first.value is None else first

    def against_best(self) -> list[Pair]:
        """Give the pairs of the best group, which stands first, with each other, best first."""
        if self.best is None:
            return []
        name = self.best.group
        turned = {
            pair.second: pair for each in self.pairs if name in each[:2]
            for pair in [each if each.first == name else each.swapped()]
        }  # fmt: skip
        return [turned[each.group] for each in self.estimates if each.group in turned]


def compare(groups: Groups, quantity: str) -> Comparison:
    """Compare groups in one quantity.

    Parameters
    ----------
    groups : Groups
        Two or more, as `side_by_side` gives them.
    quantity : str
        One of `QUANTITIES`.

    Returns
    -------
    Comparison
        With reasons in words where a number cannot be had; the same for the same groups.
    """
    rate = quantity == "success"
    if not quantity.endswith("time"):
        groups = groups.without_copies()
    values = _values(groups, quantity)
    own, found = _estimated(groups, quantity, values)
    usable = [at for at, each in enumerate(own) if each.value is not None]
    count = overlap(values, groups.blocks)
    blocks = _blocks(values, usable, count) if found is None else None
    if blocks is not None:
        for at, rank in zip(usable, _mean_ranks(blocks, rate), strict=True):
            own[at] = own[at]._replace(rank=rank)
    by_rank = blocks is not None and not rate and groups.problems > 1
    order = _in_order(own, quantity, by_rank)
    omnibus = None
    if len(usable) > 2 and found is None:
        columns = [values[~np.isnan(values[:, at]), at] for at in usable]
        omnibus = samples_differ(columns, rate) if blocks is None else blocks_differ(blocks, rate)
    all_pairs = list(combinations(usable, 2))
    shown = [len(usable) <= _ALL_PAIRS or order[0] in pair for pair in all_pairs]
    if found is not None:
        differences = found.differences(all_pairs, shown)
    elif rate:
        differences = _rates(groups, count, all_pairs)
    else:
        differences = _amounts(values, count, all_pairs, shown, groups.problem)
    if not quantity.endswith("time"):  # which differs whatever is done
        differences = _of_chance(groups, all_pairs, differences)
    pairs = _judged(groups.names, count, all_pairs, list(differences), omnibus)
    return Comparison(quantity, tuple(own[at] for at in order), tuple(pairs), omnibus, by_rank)


def estimates(groups: Groups, quantity: str) -> list[Estimate]:
    """Give each group's own number, in the order of the groups.

    Parameters
    ----------
    groups : Groups
        One or more.
    quantity : str
        One of `QUANTITIES`.

    Returns
    -------
    list of Estimate
        Without ranks.
    """
    return _estimated(groups, quantity, _values(groups, quantity))[0]


def _values(groups: Groups, quantity: str) -> Table:
    if quantity == "success":
        return groups.success
    name = quantity.removeprefix("expected_")
    return groups.spent.get(name, np.full(groups.success.shape, np.nan))


def _estimated(
    groups: Groups, quantity: str, values: Table
) -> tuple[list[Estimate], Expected | None]:
    found = expected(values, groups.success) if quantity.startswith("expected_") else None
    places = range(len(groups.names))
    return [_estimate(groups, quantity, values, at, found) for at in places], found


def _in_order(estimates: Sequence[Estimate], quantity: str, by_rank: bool) -> list[int]:
    def badness(at: int) -> float:
        value, rank = estimates[at].value, estimates[at].rank
        if value is None:
            return math.inf
        if by_rank and rank is not None:
            return rank
        return -value if quantity == "success" else value

    return sorted(range(len(estimates)), key=badness)


def _blocks(values: Table, usable: Sequence[int], count: Overlap) -> Table | None:
    """Give the blocks in which all groups stand, if half of the smallest one's trials are there."""
    if len(usable) < 2:
        return None
    chosen = values[:, list(usable)]
    blocks: Table = chosen[~np.isnan(chosen).any(axis=1)]
    enough = count.pairs.any() and 2 * len(blocks) >= min(count.trials[list(usable)])
    return blocks if enough else None


def _mean_ranks(blocks: Table, rate: bool) -> list[float]:
    from scipy.stats import rankdata

    ranks = rankdata(-blocks if rate else blocks, axis=1).mean(axis=0)
    return [float(rank) for rank in ranks]


def _estimate(
    groups: Groups, quantity: str, values: Table, at: int, found: Expected | None
) -> Estimate:
    group = groups.names[at]
    known = values[:, at][~np.isnan(values[:, at])]
    n = len(known)
    if n == 0:
        none = quantity.removeprefix("expected_") not in (*groups.spent, "success")
        why = "no number, since this task has none" if none else "no trial succeeded"
        return Estimate(group, 0, None, why=why)
    if quantity.endswith("evaluations") and not known.any():
        return Estimate(group, n, None, why="no number, since without chance nothing is evaluated")
    if found is not None:
        return Estimate(group, n, *found.estimate(at))
    if quantity != "success":
        return Estimate(group, n, float(np.median(known)), *median_interval(known))
    rate = float(known.mean())
    if not groups.chance[at]:
        why = "no interval, since without chance all trials on a problem are one"
        return Estimate(group, n, rate, why=why)
    return Estimate(group, n, rate, *wilson(rate, n))


def _of_chance(
    groups: Groups, pairs: Sequence[tuple[int, int]], differences: Iterable[Difference]
) -> Iterator[Difference]:
    """Leave no test to pairs of groups that draw no random numbers."""
    why = "without chance in either what they do is no sample"
    for (i, j), found in zip(pairs, differences, strict=True):
        chance = groups.chance[i] or groups.chance[j]
        yield found if chance else found._replace(p=None, low=None, high=None, why=why)


def _rates(
    groups: Groups, count: Overlap, pairs: Sequence[tuple[int, int]]
) -> Iterator[Difference]:
    there = (~np.isnan(groups.success)).astype(float)
    yes = np.nan_to_num(groups.success)
    no = there - yes
    both, only, neither = (
        np.rint(first.T @ second).astype(int) for first, second in ((yes, yes), (yes, no), (no, no))
    )
    for i, j in pairs:
        if count.paired(i, j):
            table = both[i, j], only[i, j], only[j, i], neither[i, j]
            yield paired_rates(*map(int, table))
        else:
            succeeded = int(yes[:, i].sum()), int(yes[:, j].sum())
            yield unpaired_rates(succeeded, (int(count.trials[i]), int(count.trials[j])))


def _amounts(
    values: Table,
    count: Overlap,
    pairs: Sequence[tuple[int, int]],
    shown: Sequence[bool],
    problem: Table | None,
) -> Iterator[Difference]:
    known = _all_signed_ranks(values, count, pairs)
    for (i, j), show, p in zip(pairs, shown, known, strict=True):
        first, second = values[:, i], values[:, j]
        there = ~np.isnan(first), ~np.isnan(second)
        alone = first[there[0]], second[there[1]]
        if count.paired(i, j):
            common = there[0] & there[1]
            found = paired_amounts(first[common], second[common], show, p)
        else:
            found = unpaired_amounts(*alone, show)
        if show and problem is not None:
            which = problem[there[0], i], problem[there[1], j]
            found = found._replace(a12=more_often_by_problem(*alone, *which))
        elif show:
            found = found._replace(a12=more_often(*alone))
        yield found


def _all_signed_ranks(
    values: Table, count: Overlap, pairs: Sequence[tuple[int, int]]
) -> list[float | None]:
    """Test all pairs of groups with many pairs of trials at once: much faster than one by one."""
    found: list[float | None] = [None] * len(pairs)
    many = [at for at, pair in enumerate(pairs) if count.pairs[pair] > 50]
    step = max(1, 10**6 // max(1, len(values)))
    for start in range(0, len(many), step):
        part = np.array(many[start : start + step])
        first, second = np.array(pairs)[part].T
        # what is missing becomes a difference of 0, which the test leaves out
        differences = np.nan_to_num(values[:, first] - values[:, second])
        differ = differences.any(axis=0)
        if differ.any():
            ps = signed_rank(differences[:, differ])
            for at, p in zip(part[differ], ps, strict=True):
                found[at] = float(p)
    return found


def _judged(
    names: Sequence[str],
    count: Overlap,
    pairs: Sequence[tuple[int, int]],
    differences: Sequence[Difference],
    omnibus: Omnibus | None,
) -> Iterator[Pair]:
    adjusted = holm([found.p for found in differences])
    # Holm's correction holds by itself where it cannot be asked whether any two groups differ
    differ = omnibus is None or omnibus.p is None or omnibus.p < LEVEL
    for (i, j), found, p in zip(pairs, differences, adjusted, strict=True):
        paired = int(count.pairs[i, j]) if count.paired(i, j) else 0
        apart = p is not None and p < LEVEL and differ
        yield Pair(names[i], names[j], paired, found, p, apart)
