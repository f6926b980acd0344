"""The fitness of 100 000 random chromosomes: gapath against one by one, and against C.

Nanoseconds a chromosome on kg18_test4 (100 x 50 fields): five control points anywhere on the map,
five way points, all chromosomes in one call. All give the same keys, or this stops. A ratio
"gapath / rival" below 1 says that gapath is the faster one.

- "scalar kernel": gapath's own, one chromosome and one field after the other.
- "C, AVX-512 gathers", "plain C": the same work by hand (`benchmarks/rivals/fitness.c`), for this
  number of control and way points and small maps only, with the processor's vectors and without.
- "precomputed indices": C that adds up the same entries of the table at places known beforehand,
  which leaves out how the others find these places.
- "generic CPU", "Haswell": gapath's two kernels compiled for processors without AVX-512 (any of
  this architecture, and one with AVX2), in a process of its own each, but run on this one.
"""

import ctypes
import hashlib
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import Calls, Row, interleave, make_problem, quartiles, ratios
from gapath.kernels.kg18.bspline import Basis, basis, rasterise
from gapath.kernels.kg18.evaluation import evaluate, workspace
from gapath.kernels.kg18.lanes import ONE_BY_ONE, SIDE_BY_SIDE, Way, chromosome_matrix
from gapath.kernels.lines import KEY_BITS, ONE_OBSTACLE
from gapath.kernels.units import ALLOW, OBSTACLE_BITS

MAP = "kg18_test4"
CONTROL_POINTS, WAY_POINTS = 5, 5
SIDE = 255
"""Maps that `fitness.c` takes have at most so many fields a side."""

QUICK, FULL = (10_000, 3), (100_000, 50)
"""Chromosomes, and how many times they are evaluated."""

OURS, SCALAR, INDICES = "gapath", "scalar kernel", "precomputed indices"
IN_C = {"C, AVX-512 gathers": "gathers", "plain C": "plain", INDICES: "indices"}
"""Rivals in C, and the functions that they are."""
CPUS = {"generic": "generic CPU", "haswell": "Haswell"}
"""Processors as LLVM calls them, and as the rows do."""

SOURCE = Path(__file__).parents[2] / "rivals" / "fitness.c"
# Left to itself GCC 12 makes vectors of loops that run 25 times: plain C takes a fifth longer.
COMPILE = ("-std=gnu11", "-O3", "-march=native", "-fno-tree-vectorize", "-shared", "-fPIC")


class Work(NamedTuple):
    """What all have to evaluate."""

    table: NDArray[np.int32]
    chromosomes: NDArray[np.int32]
    """A chromosome a row, with room for whole vectors."""
    size: int
    """How many there are."""
    splines: Basis


def draw(table: NDArray[np.int32], count: int) -> Work:
    """Draw control points all over a map."""
    genes = 2 * CONTROL_POINTS
    chromosomes = chromosome_matrix(count, genes)
    random, (rows, cols) = np.random.default_rng(0), table.shape
    chromosomes[:count, 0:genes:2] = random.integers(0, cols, (count, CONTROL_POINTS))
    chromosomes[:count, 1:genes:2] = random.integers(0, rows, (count, CONTROL_POINTS))
    return Work(table, chromosomes, count, basis(CONTROL_POINTS, WAY_POINTS, False))


def by_kernels(work: Work) -> Calls:
    """Evaluate with gapath's kernels; each call gives the keys."""

    def prepare(way: Way) -> Callable[[], NDArray[np.int64]]:
        keys, memory = np.empty(work.size, dtype=np.int64), workspace(work.splines)

        def call() -> NDArray[np.int64]:
            evaluate(
                way, work.table, work.chromosomes, 0, work.size, work.splines, ALLOW, keys, memory
            )
            return keys

        return call

    return {OURS: prepare(SIDE_BY_SIDE), SCALAR: prepare(ONE_BY_ONE)}


def places(work: Work) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Find the places in the flattened table of all fields, and where each path's begin and end."""
    genes = work.chromosomes[: work.size, : 2 * CONTROL_POINTS]
    paths = [rasterise(chromosome, *work.splines) for chromosome in genes]
    x, y = np.concatenate(paths).T
    return y * np.int32(work.table.shape[1]) + x, np.cumsum([0, *map(len, paths)])


def compiled() -> ctypes.CDLL | str:
    """Compile `fitness.c`, or say why it cannot be."""
    compiler = shutil.which("cc")
    if compiler is None:
        return "skipped: no C compiler (cc)"
    with tempfile.TemporaryDirectory() as folder:
        library = str(Path(folder, "fitness.so"))
        command = [compiler, *COMPILE, "-o", library, str(SOURCE), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            return f"skipped: the C compiler ends with {done.returncode}"
        return ctypes.CDLL(library)


def in_c(
    library: ctypes.CDLL | str, rival: str, work: Work, *known: NDArray[Any]
) -> Callable[[], NDArray[np.int64]] | str:
    """Evaluate in C, or say why not.

    Parameters
    ----------
    library : CDLL or str
        What `compiled` gives.
    rival : str
        A key of `IN_C`.
    work : Work
        What to evaluate.
    *known
        The `places`.

    Returns
    -------
    callable
        Gives the keys, or for precomputed indices the sums of the entries.
    """
    if isinstance(library, str):
        return library
    function = getattr(library, IN_C[rival], None)
    if function is None:
        return "skipped: the processor has no AVX-512"
    result = np.empty(work.size, dtype=np.int64)
    if rival == INDICES:
        arguments: list[Any] = [work.table, *known, work.size, result]
    else:
        assert max(work.table.shape) <= SIDE
        (_, cols), (_, stride) = work.table.shape, work.chromosomes.shape
        genes = [work.chromosomes, stride, work.size]
        arguments = [work.table, cols, *genes, *work.splines, result]
    converted = [
        a.ctypes.data_as(ctypes.c_void_p) if isinstance(a, np.ndarray) else ctypes.c_int64(a)
        for a in arguments
    ]

    def call() -> NDArray[np.int64]:
        function(*converted)
        return result

    return call


def check_identical(found: dict[str, NDArray[np.int64]]) -> None:
    """Raise RuntimeError unless all rivals give gapath's keys, or sums of entries that fit them."""
    keys = found[OURS]
    sums = ((keys >> KEY_BITS) << OBSTACLE_BITS) + (keys & (ONE_OBSTACLE - 1))
    for rival, result in found.items():
        others = int((result != (sums if rival == INDICES else keys)).sum())
        if others:
            raise RuntimeError(f"{rival}: {others} of {len(keys)} keys are not gapath's")


def digest(keys: NDArray[np.int64]) -> str:
    """Give the SHA-256 of keys."""
    return hashlib.sha256(keys.tobytes()).hexdigest()


def time_calls(calls: Calls, rounds: int) -> dict[str, list[float]]:
    """Time rivals that give identical keys."""
    times, results = interleave([calls] * (1 + rounds))
    check_identical(results[-1])
    return times


def time_kernels(count: int, rounds: int) -> tuple[dict[str, list[float]], str]:
    """Time gapath's kernels; gives the digest of their keys, too."""
    calls = by_kernels(draw(make_problem(MAP).map.table, count))
    return time_calls(calls, rounds), digest(calls[OURS]())


def time_elsewhere(cpu: str, count: int, rounds: int) -> tuple[dict[str, list[float]], str]:
    """Do `time_kernels` in a process that compiles for another processor."""
    call = f"time_kernels({count}, {rounds})"
    code = f"import json; from {__name__} import time_kernels; print(json.dumps({call}))"
    # Unless told its features, numba adds those of the processor that is here.
    environment = {**os.environ, "NUMBA_CPU_NAME": cpu, "NUMBA_CPU_FEATURES": ""}
    process = subprocess.run(
        [sys.executable, "-c", code],
        env=environment,
        cwd=SOURCE.parents[2],  # benchmarks is not installed
        stdout=subprocess.PIPE,
        check=True,
    )
    times, keys = json.loads(process.stdout)
    return times, keys


def why_not(cpu: str, quick: bool) -> str | None:
    """Say why a processor's code is not timed here, if so."""
    if cpu != "generic" and platform.machine() not in ("x86_64", "AMD64"):
        return "skipped: the processor has another architecture"
    return "skipped: compiles for seconds, only in the full form" if quick else None


def rows_of(times: dict[str, list[float]], count: int) -> dict[str, Row]:
    """Make a row for each rival."""
    rows: dict[str, Row] = {}
    for rival, sample in times.items():
        rows[rival] = {"ns a chromosome": quartiles([1e3 * us / count for us in sample])}
        if rival != OURS:
            rows[rival]["gapath / rival"] = ratios(times[OURS], sample)
    return rows


def measure(quick: bool) -> list[Row]:
    count, rounds = QUICK if quick else FULL
    work = draw(make_problem(MAP).map.table, count)
    known, library = places(work), compiled()
    calls = by_kernels(work)
    rows: dict[str, Row] = {rival: {} for rival in (*calls, *IN_C)}  # in this order
    for rival in IN_C:
        call = in_c(library, rival, work, *known)
        if isinstance(call, str):
            rows[rival] = {"ns a chromosome": call}
        else:
            calls[rival] = call
    rows |= rows_of(time_calls(calls, rounds), count)
    for cpu, name in CPUS.items():
        found = _elsewhere(cpu, quick, count, rounds, digest(calls[OURS]()))
        rows |= {f"{rival}, {name}": row for rival, row in found.items()}
    fields = known[0].size / count
    return [{"rival": rival, "fields a chromosome": fields} | row for rival, row in rows.items()]


def _elsewhere(cpu: str, quick: bool, count: int, rounds: int, expected: str) -> dict[str, Row]:
    if why := why_not(cpu, quick):
        return {rival: {"ns a chromosome": why} for rival in (OURS, SCALAR)}
    times, keys = time_elsewhere(cpu, count, rounds)
    if keys != expected:
        raise RuntimeError(f"{CPUS[cpu]}: the keys are others than here")
    return rows_of(times, count)
