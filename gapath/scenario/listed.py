"""The pairs of start and target that a run asks one after another."""

import hashlib
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Queries:
    """Several pairs of start and target on one map, as a scenario lists them.

    Parameters
    ----------
    numbers : (n,) int32
        The number of each among all that are listed: its row in a file, from 0.
    buckets : (n,) int32
        Class of difficulty; -1 where nobody gives one.
    starts, targets : (n, 2) int32
        Fields (x, y), which may be blocked.
    lengths : (n,) float64
        Octile length of a shortest path as the author gives it, in fields; NaN if nobody does.
    """

    numbers: NDArray[np.int32]
    buckets: NDArray[np.int32]
    starts: NDArray[np.int32]
    targets: NDArray[np.int32]
    lengths: NDArray[np.float64]

    def __len__(self) -> int:
        """Give how many there are."""
        return len(self.numbers)

    @property
    def columns(self) -> tuple[NDArray[Any], ...]:
        """Its arrays, in their order."""
        return tuple(getattr(self, each.name) for each in fields(self))

    def chosen(self, which: "slice | NDArray[np.bool_]") -> "Queries":
        """Give some of them."""
        return Queries(*(column[which] for column in self.columns))

    @property
    def digest(self) -> str:
        """SHA-256 of all of them."""
        whole = (np.ascontiguousarray(c, "<f8" if c.dtype.kind == "f" else "<i4")
                 for c in self.columns)  # fmt: skip
        return hashlib.sha256(b"".join(column.tobytes() for column in whole)).hexdigest()
