"""Random streams keyed by (seed, trial, call).

The generator is SFC64 (Doty-Humphrey's PractRand), written as a kernel: 64-bit words,
equal to `numpy.random.SFC64` bit for bit. NumPy promises no stream of bounded integers
across versions, so those are drawn here: `(word * n) >> 32` on a 32-bit half of a word,
whose bias is below n / 2**32.
"""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from gapath.errors import InputError
from gapath.kernels.jit import kernel

Stream: TypeAlias = NDArray[np.uint64]
"""State of one stream, (4,) uint64: a, b, c and the counter. Kernels advance it."""

_U11, _U3, _U24, _U40, _U1 = (np.uint64(n) for n in (11, 3, 24, 40, 1))
_LOW = np.uint64(0xFFFFFFFF)
_U32 = np.uint64(32)


@kernel
def fill(stream: Stream, words: NDArray[np.uint64]) -> None:
    """Fill an array with the next words of a stream.

    Parameters
    ----------
    stream : (4,) uint64
        The state, advanced in place.
    words : (n,) uint64
        Overwritten with n words.
    """
    a, b, c, counter = stream[0], stream[1], stream[2], stream[3]
    for i in range(words.shape[0]):
        word = a + b + counter
        counter += _U1
        a = b ^ (b >> _U11)
        b = c + (c << _U3)
        c = ((c << _U24) | (c >> _U40)) + word
        words[i] = word
    stream[0], stream[1], stream[2], stream[3] = a, b, c, counter


@kernel
def high(word: np.uint64, n: int) -> int:
    """Draw an integer in [0, n) from the upper half of a word.

    Parameters
    ----------
    word : uint64
        A word of a stream.
    n : int
        Number of values, 1 <= n < 2**31.

    Returns
    -------
    int
        The drawn integer.
    """
    return np.int64(((word >> _U32) * np.uint64(n)) >> _U32)


@kernel
def low(word: np.uint64, n: int) -> int:
    """Draw an integer in [0, n) from the lower half of a word.

    Parameters
    ----------
    word : uint64
        A word of a stream.
    n : int
        Number of values, 1 <= n < 2**31.

    Returns
    -------
    int
        The drawn integer.
    """
    return np.int64(((word & _LOW) * np.uint64(n)) >> _U32)


@kernel
def happens(word: np.uint64, threshold: np.uint64) -> bool:
    """Tell whether an event of a given probability happens, by the upper half of a word.

    Parameters
    ----------
    word : uint64
        A word of a stream.
    threshold : uint64
        The probability as `probability_threshold` gives it.

    Returns
    -------
    bool
        True with that probability.
    """
    return (word >> _U32) < threshold


def probability_threshold(probability: float) -> np.uint64:
    """Turn a probability into the number that `happens` compares with.

    Parameters
    ----------
    probability : float
        In [0, 1].

    Returns
    -------
    uint64
        floor(probability * 2**32).
    """
    return np.uint64(int(probability * 2**32))


def stream(seed: int, trial: int = 0, call: int = 0) -> Stream:
    """Make the stream of one call of one trial.

    A stream depends on its three keys alone: not on how many trials run, nor in which
    order, nor on whether they are recorded. The keys are the generator's three seed
    words, mixed by twelve discarded words as its author prescribes.

    Parameters
    ----------
    seed, trial, call : int
        Each in [0, 2**64).

    Returns
    -------
    (4,) uint64
        The state before its first draw.

    Raises
    ------
    InputError
        If a key is out of range.
    """
    for name, key in (("seed", seed), ("trial", trial), ("call", call)):
        if not (isinstance(key, int | np.integer) and 0 <= key < 2**64):
            raise InputError(name, repr(key), "an integer in [0, 2**64)")
    state = np.array([seed, trial, call, 1], dtype=np.uint64)
    fill(state, np.empty(12, dtype=np.uint64))
    return state
