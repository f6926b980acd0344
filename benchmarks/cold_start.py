"""How long a user waits for a first answer.

Wall seconds of whole processes, in turn. "cached" finds compiled kernels, as every run but
the first does; "uncached" begins with an empty `NUMBA_CACHE_DIR`. The target of the cached
run is 2 s.
"""

import os
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from benchmarks.measure import Calls, Row, interleave, quartiles, timed

COMMAND = str(Path(sysconfig.get_path("scripts")) / "gapath")
SETTINGS = ("map=kg18_test3", "planner=ga3", "recorder=none", "force=true")


def _process(command: Sequence[str], cache: str) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
    subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL)


def measure(quick: bool) -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        run = [COMMAND, *SETTINGS, f"output={folder}/outputs"]
        warm = f"{folder}/warm"
        calls: Calls = {
            "gapath, cached": partial(_process, run, warm),
            "import gapath": partial(_process, [sys.executable, "-c", "import gapath"], warm),
        }
        times, _ = interleave([calls] * (1 + (2 if quick else 5)))
        times["gapath, uncached"] = [
            timed(partial(_process, run, f"{folder}/empty{i}"))[0] for i in range(1 if quick else 3)
        ]
    return [
        {"process": name, "seconds": quartiles([t / 1e6 for t in sample]), "rounds": len(sample)}
        for name, sample in times.items()
    ]
