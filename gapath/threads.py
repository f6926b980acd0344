"""Trials on several threads: kernels run beside one another, results come in order."""

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")

AHEAD = 16
"""So many trials a thread may wait to be told; a trial's history is up to a gigabyte."""


def in_order(work: Callable[[int], T], count: int, threads: int) -> Iterator[T]:
    """Do numbered pieces of work.

    Which thread takes which piece is left to chance, so fast and slow ones mix; a result may
    depend on its number alone.

    Parameters
    ----------
    work : callable
        Does the piece with a number.
    count : int
        Pieces 0 to count - 1.
    threads : int
        How many threads work; with one it is the caller's own.

    Yields
    ------
    object
        The results, in the order of their numbers.
    """
    if threads == 1:
        yield from map(work, range(count))
        return
    pool = ThreadPoolExecutor(threads)
    try:
        waiting: deque[Future[T]] = deque()
        for number in range(count):
            waiting.append(pool.submit(work, number))
            if len(waiting) >= AHEAD * threads:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    finally:
        pool.shutdown(cancel_futures=True)
