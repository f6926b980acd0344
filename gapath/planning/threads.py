"""Trials on several threads: kernels run beside one another, results come in order."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

P = TypeVar("P")
T = TypeVar("T")

AHEAD = 16
"""So many pieces a thread may wait to be told: one keeps a few megabytes, or is a single trial."""


def in_order(work: Callable[[P], T], pieces: Iterable[P], threads: int) -> Iterator[T]:
    """Do pieces of work.

    Which thread takes which piece is left to chance, so fast and slow ones mix; a result may
    depend on its piece alone.

    Parameters
    ----------
    work : callable
        Does a piece.
    pieces : iterable
        What there is to do.
    threads : int
        How many threads work; with one it is the caller's own.

    Yields
    ------
    object
        The results, in the order of their pieces.
    """
    if threads == 1:
        yield from map(work, pieces)
        return
    pool = ThreadPoolExecutor(threads)
    try:
        waiting: deque[Future[T]] = deque()
        for piece in pieces:
            waiting.append(pool.submit(work, piece))
            if len(waiting) >= AHEAD * threads:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    finally:
        pool.shutdown(cancel_futures=True)
