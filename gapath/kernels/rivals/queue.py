"""What waits for its turn: a radix heap as A* has it, of equal priorities the newest first."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.graph_search import (
    BUCKETS,
    DIGITS,
    LINK,
    LINK_BITS,
    NEXT,
    NONE,
    PRIORITY,
    Buckets,
    bucket_of,
    clear,
    lowest,
    mark,
    spread,
)
from gapath.kernels.jit import kernel

EMPTY = -1
"""Instead of what comes next."""

USED, SPARE, LAST = 0, 1, 2
"""Of a queue's marks: items made so far, the first of those to be used again, and the last
priority taken."""


@kernel(inner=True)
def empty_buckets() -> Buckets:
    """Make buckets without items."""
    return Buckets(
        np.zeros(BUCKETS // 64, dtype=np.uint64),
        np.empty(BUCKETS, dtype=np.int64),
        np.empty(BUCKETS, dtype=np.int64),
        np.empty(BUCKETS, dtype=np.int64),
    )


@kernel(inner=True)
def more(rows: NDArray[np.int64], factor: int) -> NDArray[np.int64]:
    """Copy rows to where there is room for so many times as many."""
    copy = np.empty((factor * rows.shape[0], rows.shape[1]), dtype=np.int64)
    for i in range(rows.shape[0]):
        for j in range(rows.shape[1]):
            copy[i, j] = rows[i, j]
    return copy


@kernel(inner=True)
def is_full(items: NDArray[np.int64], marks: NDArray[np.int64]) -> bool:
    """Tell whether the next number needs `more` items."""
    return marks[SPARE] == NONE and marks[USED] == items.shape[0]


@kernel(inner=True)
def put(
    items: NDArray[np.int64],
    buckets: Buckets,
    marks: NDArray[np.int64],
    number: int,
    priority: int,
) -> None:
    """Put a number in.

    Parameters
    ----------
    items : (n, 2) int64
        PRIORITY and LINK of each item, not full; changed in place, as are the others.
    buckets : Buckets
        Where items are.
    marks : (3,) int64
        USED, at first 1, SPARE and LAST, at first 0.
    number, priority : int
        Both at least 0, the number below 2**31; the priority not below the last one taken.
    """
    item = marks[SPARE]
    if item != NONE:
        marks[SPARE] = items[item, LINK]
    else:
        item = marks[USED]
        marks[USED] = item + 1
    bucket = bucket_of(priority, marks[LAST])
    link = np.int64(number) << LINK_BITS
    if mark(buckets, bucket, priority):
        link |= buckets.firsts[bucket]
    items[item, PRIORITY], items[item, LINK] = priority, link
    buckets.firsts[bucket] = item


@kernel(inner=True)
def take(items: NDArray[np.int64], buckets: Buckets, marks: NDArray[np.int64]) -> int:
    """Take the number of the least priority, the newest of several.

    Parameters
    ----------
    items, buckets, marks : arrays
        As of `put`; changed in place.

    Returns
    -------
    int
        The number; EMPTY if there is none.
    """
    bucket = lowest(buckets)
    if bucket >= DIGITS:
        if bucket == BUCKETS:
            return np.int64(EMPTY)
        marks[LAST] = spread(items, buckets, bucket)
        bucket = np.uint64(marks[LAST] & (DIGITS - 1))
    item = buckets.firsts[bucket]
    link = items[item, LINK]
    if link & NEXT == NONE:
        clear(buckets, bucket)
    else:
        buckets.firsts[bucket] = link & NEXT
    items[item, LINK], marks[SPARE] = marks[SPARE], item
    return link >> LINK_BITS
