"""Vectors give what numbers one by one give on a processor that has few of them, too."""

import os
import subprocess
import sys

import numpy as np
import pytest

from gapath.kernels.jit import JIT
from gapath.kernels.kg18.bspline import basis
from gapath.kernels.kg18.evaluation import evaluate, workspace
from gapath.kernels.kg18.lanes import GENES, ONE_BY_ONE, SIDE_BY_SIDE, chromosome_matrix, width
from gapath.kernels.kg18.population import Mixing, vary
from gapath.kernels.raster import COORDINATE_LIMIT
from gapath.kernels.rng import probability_threshold
from gapath.kernels.units import ALLOW, FORBID, NO_DIAGONALS, OBSTACLE, ONE_SIDE

WAYS = (SIDE_BY_SIDE, ONE_BY_ONE)
RULES = (ALLOW, ONE_SIDE, FORBID, NO_DIAGONALS)
MAPS = ((50, 100), (500, 1000), (4000, 4000), (3, 4000), (1, 1))


def check_evaluations(random, rows, cols):
    """Evaluate genes on a map, some way outside it, and as far outside as they may lie."""
    table = random.integers(0, 65537, (rows, cols), dtype=np.int32)
    table[random.random((rows, cols)) < 0.1] = OBSTACLE
    for beyond, count in ((0, 400), (max(rows, cols), 200), (COORDINATE_LIMIT, 5)):
        for rule in RULES:
            k = int(random.integers(3, 10))
            chromosomes = chromosome_matrix(count, 2 * k)
            for axis, side in enumerate((cols, rows)):
                genes = random.integers(-beyond, side + beyond, (count, k))
                genes = genes.clip(-COORDINATE_LIMIT, COORDINATE_LIMIT)
                chromosomes[:count, axis : 2 * k : 2] = genes
            splines, found = basis(k, 5, False), []
            for way in WAYS:
                keys = np.empty(count, dtype=np.int64)
                memory = workspace(splines)
                evaluate(way, table, chromosomes, 0, count, splines, rule, keys, memory)
                found.append(keys.tolist())
            assert found[0] == found[1], (rows, cols, beyond, rule)


def check_variations(random, far):
    """Vary genes up to `far` off, with changes as large."""
    k = int(random.integers(3, 33))
    genes, columns = 2 * k, width(2 * k)
    parents = random.integers(-far, far + 1, (2, columns), dtype=np.int32)
    changes = random.integers(0, far + 1, (2, columns), dtype=np.int32)
    changes[0] += 1
    limits = np.sort(random.integers(-far, far + 1, (2, columns), dtype=np.int32), axis=0)
    words = random.integers(0, 2**64, genes + GENES, dtype=np.uint64)
    denominator = int(random.integers(1, 1000))
    share = int(random.integers(0, denominator + 1)) / denominator
    mixing = Mixing(share, 1 - share, 0.5 + 0.25 / denominator)
    threshold, shift = probability_threshold(random.random()), 32 * int(random.integers(2))
    found = []
    for way in WAYS:
        child = np.zeros((1, columns), dtype=np.int32)
        given = mixing, words, 0, shift, threshold, changes, limits, child, 0, genes
        vary(way, parents, 0, 1, *given)
        found.append(child[0, 2 : genes - 2].tolist())
    assert found[0] == found[1], (k, far, mixing)


def check_all():
    random = np.random.default_rng(0)
    for rows, cols in MAPS:
        check_evaluations(random, rows, cols)
    for far in (1, 100, COORDINATE_LIMIT):
        for _ in range(500):
            check_variations(random, far)


@pytest.mark.skipif(not JIT, reason="vectors need the compiler")
def test_any_processor_of_this_architecture():
    environment = {**os.environ, "NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
    command = [sys.executable, __file__]
    process = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert process.returncode == 0, process.stderr


if __name__ == "__main__":
    check_all()
