"""Whether groups of trials differ: in success, and in what they spend.

Every pair of groups is tested, and Holm's correction taken over all pairs of one quantity; of three
or more groups it is asked first whether they differ at all.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.pipelines.numbers.expected import Expected, expected
from gapath.pipelines.numbers.groups import Groups, Overlap, Table, overlap
from gapath.pipelines.numbers.pairwise import (
    LEVEL,
    Difference,
    holm,
    more_often,
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
    """A group's own number with its 95 % interval; None where it cannot be had, and why."""

    group: str
    n: int
    value: float | None
    low: float | None = None
    high: float | None = None
    why: str = ""


class Pair(NamedTuple):
    """Two groups held against each other.

    `first` and `second` are their names, `pairs` how many pairs of trials were compared, 0 where
    all trials of both were, unpaired; `difference` is of `gapath.pipelines.numbers.pairwise`,
    `adjusted` its p-value after Holm; `apart` tells whether the two can be told apart.
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


class Omnibus(NamedTuple):
    """Whether three or more groups differ at all.

    `blocks` is in how many blocks all of them stand, 0 where their trials were taken unpaired;
    `ranks` are the groups' mean ranks in these, 1 for the least; None for what is not there.
    """

    test: str
    p: float | None
    blocks: int
    ranks: tuple[float, ...] | None
    why: str = ""


@dataclass(frozen=True)
class Comparison:
    """What groups come to in one quantity.

    Parameters
    ----------
    quantity : str
        One of `QUANTITIES`.
    estimates : tuple of Estimate
        Of all groups, best first, those without a number last.
    pairs : tuple of Pair
        All pairs of the groups that have a number, in the order of the groups.
    omnibus : Omnibus or None
        None for two groups, and for expected amounts.
    """

    quantity: str
    estimates: tuple[Estimate, ...]
    pairs: tuple[Pair, ...]
    omnibus: Omnibus | None

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
    name = quantity.removeprefix("expected_")
    if quantity == "success":
        values = groups.success
    elif name in groups.spent:
        values = groups.spent[name]
    else:
        none = (Estimate(group, 0, None, why="this task has none") for group in groups.names)
        return Comparison(quantity, tuple(none), (), None)
    found = expected(values, groups.success) if name != quantity else None
    estimates = [_estimate(groups, quantity, values, at, found) for at in range(len(groups.names))]
    usable = [at for at, each in enumerate(estimates) if each.value is not None]
    best = min(usable, key=lambda at: _badness(estimates[at], quantity), default=None)
    order = sorted(range(len(estimates)), key=lambda at: _badness(estimates[at], quantity))
    count = overlap(values, groups.blocks)
    omnibus = None
    if len(usable) > 2 and found is None:
        omnibus = _omnibus(values, usable, count, quantity == "success")
    pairs: tuple[Pair, ...] = ()
    if best is not None:
        all_pairs = list(combinations(usable, 2))
        shown = [len(usable) <= _ALL_PAIRS or best in pair for pair in all_pairs]
        if found is not None:
            differences = list(found.differences(all_pairs, shown))
        elif quantity == "success":
            differences = list(_rates(groups, count, all_pairs))
        else:
            differences = list(_amounts(values, count, all_pairs, shown))
        idle = [not groups.chance[i] and not groups.chance[j] for i, j in all_pairs]
        if name != "time":
            differences = [
                _without_chance(each) if still else each
                for each, still in zip(differences, idle, strict=True)
            ]
        pairs = tuple(_judged(groups.names, count, all_pairs, differences, omnibus))
    return Comparison(quantity, tuple(estimates[at] for at in order), pairs, omnibus)


def _badness(estimate: Estimate, quantity: str) -> float:
    if estimate.value is None:
        return math.inf
    return -estimate.value if quantity == "success" else estimate.value


def _estimate(
    groups: Groups, quantity: str, values: Table, at: int, found: Expected | None
) -> Estimate:
    group = groups.names[at]
    known = values[:, at][~np.isnan(values[:, at])]
    n = len(known)
    if n == 0:
        trials = np.count_nonzero(~np.isnan(groups.success[:, at]))
        return Estimate(group, 0, None, why="no trial succeeded" if trials else "no trials")
    if quantity.endswith("evaluations") and not known.any():
        return Estimate(group, n, None, why="draws no random numbers, so evaluates nothing")
    if found is not None:
        return Estimate(group, n, *found.estimate(at))
    if quantity != "success":
        return Estimate(group, n, float(np.median(known)), *median_interval(known))
    rate = float(known.mean())
    if not groups.chance[at]:
        why = "draws no random numbers: its trials are one and the same"
        return Estimate(group, n, rate, why=why)
    return Estimate(group, n, rate, *wilson(rate, n))


def _without_chance(found: Difference) -> Difference:
    why = "neither draws random numbers: what they do is no sample"
    return found._replace(p=None, low=None, high=None, why=why)


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
    values: Table, count: Overlap, pairs: Sequence[tuple[int, int]], shown: Sequence[bool]
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
        yield found._replace(a12=more_often(*alone)) if show else found


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
    differ = omnibus is None or (omnibus.p is not None and omnibus.p < LEVEL)
    for (i, j), found, p in zip(pairs, differences, adjusted, strict=True):
        paired = int(count.pairs[i, j]) if count.paired(i, j) else 0
        apart = p is not None and p < LEVEL and differ
        yield Pair(names[i], names[j], paired, found, p, apart)


def _omnibus(values: Table, usable: list[int], count: Overlap, rate: bool) -> Omnibus:
    """Ask whether groups differ at all: in blocks if half of the smallest group's have all."""
    chosen = values[:, usable]
    blocks = chosen[~np.isnan(chosen).any(axis=1)]
    in_blocks = count.pairs[np.ix_(usable, usable)].any()
    if in_blocks and 2 * len(blocks) >= min(count.trials[usable]):
        return _blocks_differ(blocks, rate)
    columns = [column[~np.isnan(column)] for column in chosen.T]
    return _samples_differ(columns, rate)


def _blocks_differ(blocks: NDArray[np.float64], rate: bool) -> Omnibus:
    from scipy.stats import friedmanchisquare, rankdata
    from statsmodels.stats.contingency_tables import cochrans_q

    n, test = len(blocks), "Cochran's Q" if rate else "Friedman"
    ranks = tuple(float(rank) for rank in rankdata(blocks, axis=1).mean(axis=0))
    if n < 2:
        return Omnibus(test, None, n, None, "one block only, too few for a test")
    if (blocks == blocks[:, :1]).all():
        return Omnibus(test, 1.0, n, ranks, "the same in all blocks")
    p = cochrans_q(blocks).pvalue if rate else friedmanchisquare(*blocks.T).pvalue
    return Omnibus(test, float(p), n, ranks)


def _samples_differ(columns: Sequence[NDArray[np.float64]], rate: bool) -> Omnibus:
    from scipy.stats import chi2_contingency, kruskal

    test = "chi-squared" if rate else "Kruskal-Wallis"
    if min(map(len, columns)) < 2:
        return Omnibus(test, None, 0, None, "a group of one trial only, too few for a test")
    everything = np.concatenate(columns)
    if (everything == everything[0]).all():
        return Omnibus(test, 1.0, 0, None, "the same in all trials")
    if rate:
        table = [[column.sum(), len(column) - column.sum()] for column in columns]
        return Omnibus(test, float(chi2_contingency(table).pvalue), 0, None)
    return Omnibus(test, float(kruskal(*columns).pvalue), 0, None)
