"""The only import of numba-cuda, and what there is to compute with.

numba-cuda compiles whatever `gapath.kernels.jit.kernel` has made once more, for the GPU, where a
kernel calls it: one source for both. With ``NUMBA_ENABLE_CUDASIM=1`` its simulator runs instead, in
Python; it reads arrays that only Python understands, so it needs ``NUMBA_DISABLE_JIT=1``, too.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numba
import numpy as np
from numba import cuda as cuda
from numba import int32 as int32

from gapath.errors import InputError
from gapath.kernels.cuda.card import Card

numba.config.CUDA_LOW_OCCUPANCY_WARNINGS = 0  # type: ignore[attr-defined]  # few runs are no fault

_BLOCK = 128
_BLOCKS = 8  # for each multiprocessor


def jit(function: Callable[..., None]) -> Any:
    """Compile a kernel for the GPU when it is first launched."""
    return cuda.jit(function)


@lru_cache
def card() -> Card:
    """Find a GPU, and have it compute something.

    Returns
    -------
    Card
        It; half of the memory that is free now may be taken.

    Raises
    ------
    InputError
        If there is none that computes; says what is missing.
    """
    if numba.config.ENABLE_CUDASIM:  # type: ignore[attr-defined]
        return Card("simulator", 2, 4, 1 << 28)
    try:
        device = cuda.get_current_device()
        one = cuda.to_device(np.zeros(1, dtype=np.int64))
        _count[1, 1](one)
        if one.copy_to_host()[0] != 1:
            raise RuntimeError("it does not count to one")
        free, _ = cuda.current_context().get_memory_info()
        blocks = _BLOCKS * int(device.MULTIPROCESSOR_COUNT)
    except Exception as error:  # of the driver, the compiler, or what lies between them
        lines = [line for line in str(error).splitlines() if line.strip(" :")]
        said = next((line for line in lines if "driver init" not in line), type(error).__name__)
        good = f"cpu, or a GPU of NVIDIA's with its driver: {said}"
        raise InputError("device", "cuda", good) from error
    name = device.name.decode() if isinstance(device.name, bytes) else str(device.name)
    return Card(name, blocks, _BLOCK, int(free) // 2)


@jit
def _count(counter: Any) -> None:
    cuda.atomic.add(counter, 0, 1)
