"""How long a user waits for a first answer.

Wall seconds of whole processes. "uncached" begins with an empty `NUMBA_CACHE_DIR`; "cached"
finds the kernels that the last of these compiled, as every run but the first does, and takes turns
with the import. The targets: uncached 7 s, cached 1.2 s, the import 0.4 s.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from functools import partial

from benchmarks.measure import COMMAND, Calls, Row, interleave, quartiles, timed

SETTINGS = ("map=kg18_test3", "planner=ga3", "recorder=none", "force=true")


def _process(command: Sequence[str], cache: str) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
    subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL)


def measure(quick: bool) -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        run = [COMMAND, *SETTINGS, f"output={folder}/outputs"]
        caches = [f"{folder}/cache{i}" for i in range(1 if quick else 3)]
        uncached = [timed(partial(_process, run, cache))[0] for cache in caches]
        calls: Calls = {
            "gapath, cached": partial(_process, run, caches[-1]),
            "import gapath": partial(_process, [sys.executable, "-c", "import gapath"], caches[-1]),
        }
        times, _ = interleave([calls] * (1 + (2 if quick else 5)))
        times["gapath, uncached"] = uncached
    return [
        {"process": name, "seconds": quartiles([t / 1e6 for t in sample]), "rounds": len(sample)}
        for name, sample in times.items()
    ]
