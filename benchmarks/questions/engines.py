"""What a job of a sweep costs, by who does the jobs.

Wall seconds of whole commands, each of whose jobs is one trial of A* that takes no time itself:
"start" and "a job" come of sweeps of few and of more jobs. "whole" is the same command once more,
all of whose runs are there already and are left out. joblib has two processes.
"""

import subprocess
import tempfile
from collections.abc import Sequence
from functools import partial
from importlib.util import find_spec

from benchmarks.measure import COMMAND, Calls, Row, interleave, quartiles

SETTINGS = ("-m", "map=kg18_test1", "planner=astar", "recorder=none")
ENGINES = {
    "basic": ((), "hydra", 24),
    "joblib": (
        ("hydra/launcher=joblib", "hydra.launcher.n_jobs=2"),
        "hydra_plugins.hydra_joblib_launcher",
        24,
    ),
    "submitit_local": (
        ("hydra/launcher=submitit_local",),
        "hydra_plugins.hydra_submitit_launcher",
        6,
    ),
}
"""What chooses an engine, the package that it needs, and the jobs of the larger sweep."""
FEW = 2
"""Jobs of the smaller sweep."""


def measure(quick: bool) -> list[Row]:
    rows: list[Row] = []
    rounds = 1 + (1 if quick else 3)
    with tempfile.TemporaryDirectory() as folder:
        for engine, (words, package, many) in ENGINES.items():
            if not _installed(package):
                rows.append({"engine": engine, "jobs": "skipped: not installed"})
                continue
            anew = ("force=true", *words)
            calls: Calls = {
                "few": partial(_sweep, f"{folder}/few", FEW, anew),
                "many": partial(_sweep, f"{folder}/many", many, anew),
                "whole": partial(_sweep, f"{folder}/many", many, words),
            }
            times, _ = interleave([calls] * rounds)
            pairs = list(zip(times["few"], times["many"], times["whole"], strict=True))
            jobs = [(more - few) / 1e6 / (many - FEW) for few, more, _ in pairs]
            starts = [few / 1e6 - FEW * job for (few, _, _), job in zip(pairs, jobs, strict=True)]
            rows.append(
                {
                    "engine": engine,
                    "jobs": many,
                    "start s": quartiles(starts),
                    "a job s": quartiles(jobs),
                    "whole s": quartiles([whole / 1e6 for _, _, whole in pairs]),
                }
            )
    return rows


def _installed(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ModuleNotFoundError:
        return False


def _sweep(output: str, jobs: int, words: Sequence[str]) -> None:
    command = [COMMAND, *SETTINGS, f"seed=range({jobs})", f"output={output}", *words]
    subprocess.run(command, check=True, capture_output=True)
