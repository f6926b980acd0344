"""What a run's trials come to, as sums: those of several runs can be added."""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
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
    def of(cls, success: ArrayLike, columns: Mapping[str, ArrayLike]) -> Self:
        """Sum up trials.

        Parameters
        ----------
        success : (n,) bool
            Whether each trial succeeded.
        columns : mapping of str to (n,) numbers
            What came of each trial; NaN where it is not defined.

        Returns
        -------
        Results
            The sums.
        """
        succeeded = np.asarray(success, dtype=bool)
        values = {name: np.asarray(column, dtype=np.float64) for name, column in columns.items()}
        known = {name: column[~np.isnan(column)] for name, column in values.items()}
        return cls(
            len(succeeded),
            int(np.count_nonzero(succeeded)),
            {name: exact_sum(column) for name, column in known.items()},
            {name: len(known[name]) for name in known if len(known[name]) < len(succeeded)},
        )


def exact_sum(column: NDArray[np.float64]) -> float:
    """Add numbers and round once; infinite or NaN where there is no finite sum."""
    if np.isfinite(column).all():
        with suppress(OverflowError):
            return math.fsum(column.tolist())
    with np.errstate(invalid="ignore", over="ignore"):
        return float(column.sum())
