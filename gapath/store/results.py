"""What a run's trials come to, as sums: those of several runs can be added."""

import math
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Results:
    """What trials come to.

    Parameters
    ----------
    trials, succeeded : int
        How many there are, and how many succeeded.
    sums : mapping of str to float
        Numeric column of the trials -> its sum over those where it is defined, rounded once.
    counts : mapping of str to int
        The same columns, of those not defined in all trials -> in how many.
    """

    trials: int
    succeeded: int
    sums: Mapping[str, float]
    counts: Mapping[str, int]

    @classmethod
    def of(cls, success: ArrayLike, columns: Iterable[tuple[str, ArrayLike]]) -> Self:
        """Sum up trials.

        Parameters
        ----------
        success : (n,) bool
            Whether each trial succeeded.
        columns : iterable of (str, (n,) numbers)
            What came of each trial, by name; NaN where it is not defined. They are taken one
            after the other, so no two need be in memory.

        Returns
        -------
        Results
            The sums.
        """
        succeeded = np.asarray(success, dtype=bool)
        sums, counts = dict[str, float](), dict[str, int]()
        for name, values in columns:
            column = np.asarray(values, dtype=np.float64)
            known = column[~np.isnan(column)]
            sums[name] = exact_sum(known)
            if len(known) < len(succeeded):
                counts[name] = len(known)
        return cls(len(succeeded), int(np.count_nonzero(succeeded)), sums, counts)


def exact_sum(column: NDArray[np.float64]) -> float:
    """Add numbers and round once; infinite or NaN where there is no finite sum."""
    if np.isfinite(column).all():
        parts = (column[i : i + _PART].tolist() for i in range(0, len(column), _PART))
        with suppress(OverflowError):
            return math.fsum(chain.from_iterable(parts))
    with np.errstate(invalid="ignore", over="ignore"):
        return float(column.sum())


_PART = 1 << 14
"""Numbers that are objects of Python at once."""
