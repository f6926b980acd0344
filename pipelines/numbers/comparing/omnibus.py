"""Whether three or more groups of trials differ at all."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.pipelines.numbers.comparing.groups import Table


class Omnibus(NamedTuple):
    """Whether three or more groups differ at all.

    `blocks` is in how many blocks all of them stand, 0 where their trials were taken unpaired.
    """

    test: str
    p: float | None
    blocks: int
    why: str = ""


def blocks_differ(blocks: Table, rate: bool) -> Omnibus:
    """Ask whether groups differ, of trials in blocks.

    Parameters
    ----------
    blocks : (n, groups) float64
        What each trial came to, a row a block.
    rate : bool
        Whether that is 0 or 1.

    Returns
    -------
    Omnibus
        Friedman's test (SciPy), of rates Cochran's Q (statsmodels).
    """
    from scipy.stats import friedmanchisquare
    from statsmodels.stats.contingency_tables import cochrans_q

    n, test = len(blocks), "Cochran's Q" if rate else "Friedman"
    if n < 2:
        return Omnibus(test, None, n, "one block only, too few for a test")
    if (blocks == blocks[:, :1]).all():
        return Omnibus(test, 1.0, n, "the same in all blocks")
    p = cochrans_q(blocks).pvalue if rate else friedmanchisquare(*blocks.T).pvalue
    return Omnibus(test, float(p), n)


def samples_differ(columns: Sequence[NDArray[np.float64]], rate: bool) -> Omnibus:
    """Ask whether groups differ, of trials that make no blocks.

    Parameters
    ----------
    columns : sequence of (n,) float64
        What each trial of each group came to.
    rate : bool
        Whether that is 0 or 1.

    Returns
    -------
    Omnibus
        The Kruskal-Wallis test, of rates the chi-squared test (SciPy).
    """
    from scipy.stats import chi2_contingency, kruskal

    test = "chi-squared" if rate else "Kruskal-Wallis"
    if min(map(len, columns)) < 2:
        return Omnibus(test, None, 0, "a group of one trial only, too few for a test")
    everything = np.concatenate(columns)
    if (everything == everything[0]).all():
        return Omnibus(test, 1.0, 0, "the same in all trials")
    if rate:
        table = [[column.sum(), len(column) - column.sum()] for column in columns]
        return Omnibus(test, float(chi2_contingency(table).pvalue), 0)
    return Omnibus(test, float(kruskal(*columns).pvalue), 0)
