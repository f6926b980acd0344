"""What a run's trials come to, as sums: those of several runs can be added."""

import math
from collections.abc import Iterable, Mapping, Sequence
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

    @classmethod
    def pooled(cls, several: Sequence[Self]) -> Self:
        """Add the trials of several runs."""
        names = dict.fromkeys(name for each in several for name in each.sums)
        sums = {
            name: exact_sum(np.array([each.sums.get(name, 0.0) for each in several]))
            for name in names
        }
        counts = {name: sum(each.defined(name) for each in several) for name in names}
        return cls(
            sum(each.trials for each in several),
            sum(each.succeeded for each in several),
            sums,
            counts,
        )

    def defined(self, name: str) -> int:
        """Give in how many trials a column is defined."""
        return self.counts.get(name, self.trials if name in self.sums else 0)

    @property
    def drawn(self) -> bool:
        """Whether random numbers were drawn: who evaluates nothing does the same in each trial."""
        return self.sums.get(EVALUATIONS) != 0

    def figures(self) -> dict[str, float]:
        """Give what a trial comes to.

        Returns
        -------
        dict of str to float
            Of every column the mean over the trials where it is defined; success, the share of
            trials that succeeded; expected_evaluations and expected_seconds until one succeeds,
            those of failures counted, as of a run that is started again, and infinite where none
            did (the expected running time of Hansen et al., COCO). Missing where it is not
            defined: expected evaluations of a method that draws no random numbers.
        """
        means = {name: total / self.defined(name) for name, total in self.sums.items()
                 if self.defined(name)}  # fmt: skip
        figures = means | {"success": self.succeeded / self.trials}
        spent = {"expected_evaluations": [EVALUATIONS] if self.drawn else [],
                 "expected_seconds": SECONDS}  # fmt: skip
        for name, columns in spent.items():
            known = [column for column in columns if self.defined(column)]
            if known:
                effort = sum(self.sums[column] for column in known)
                figures[name] = effort / self.succeeded if self.succeeded else math.inf
        return figures


EVALUATIONS = "evaluations"
SECONDS = ("plan_time_s", "compute_time_s")
"""What a trial spends: columns of the rows, of the seconds each task has its own."""


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
