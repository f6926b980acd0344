"""Compiles the GPU's kernels without a GPU: python assembling.py MAJOR MINOR, the capability.

Writes as JSON how often each kernel's PTX has floats, calls, atomics and reads of shared memory.
"""

import json
import re
import sys
from types import SimpleNamespace

import evolving
import numba
import numba.cuda.dispatcher
import numpy as np

from gapath.kernels.cuda import evolution
from gapath.kernels.cuda.card import Card

SOUGHT = {
    "floats": r"\.f(16|32|64)\b",
    "calls": r"\bcall\b",
    "atomics": r"\batom\.",
    "shared": r"\bld\.shared\b",
}


class Launched(Exception):
    """Instead of a launch."""


class Launch:
    """Takes the place of a kernel, for the types of what it would be launched with."""

    def __getitem__(self, configuration):
        return self

    def __call__(self, *given):
        raise Launched(*given)


def signature(case):
    """The types of what `outcomes` launches a kernel with."""
    on_host = SimpleNamespace(
        to_device=np.array, device_array=np.empty, device_array_like=np.empty_like
    )
    usual = evolution.compiled, evolution.cuda
    evolution.compiled, evolution.cuda = lambda *kind: Launch(), on_host
    try:
        evolving.launched(Card("none", 1, 1, 1 << 20), *evolving.asked(case))
    except Launched as launched:
        return numba.void(*map(numba.typeof, launched.args))
    finally:
        evolution.compiled, evolution.cuda = usual


if __name__ == "__main__":
    capability = tuple(map(int, sys.argv[1:]))
    # what a kernel calls is compiled for the current GPU, which numba-cuda asks here
    card = SimpleNamespace(compute_capability=capability)
    numba.cuda.dispatcher.get_current_device = lambda: card
    found = {}
    for kind in ((True, np.int32), (False, np.int64)):
        kernel = evolution.compiled(8, *kind).py_func
        ptx, _ = evolution.cuda.compile(
            kernel, signature({}), cc=capability, output="ptx", device=False, abi="numba"
        )
        counts = {what: len(re.findall(pattern, ptx)) for what, pattern in SOUGHT.items()}
        found[str(kind[0])] = counts | {"target": re.search(r"\.target (\w+)", ptx)[1]}
    json.dump(found, sys.stdout)
