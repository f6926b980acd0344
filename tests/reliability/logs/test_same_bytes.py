"""The same bytes in every environment: logs as they are, rows but for their times.

Runs of every kind are done here and in processes of another hash seed, time zone, language and
processor; whatever differs is named. What golden hashes hold is in test_golden.
"""

import itertools
import json
import locale
import os
import subprocess
import sys
from pathlib import Path

import pytest
from logs_of_runs import RUNS, hashes, log_of
from scale import rounds

import gapath

HERE = Path(__file__).parent
ELSEWHERE = {"PYTHONHASHSEED": "1", "TZ": "Pacific/Kiritimati", "LC_ALL": "tr_TR.UTF-8"}
PLAIN = {"PYTHONHASHSEED": "0", "TZ": "UTC", "LC_ALL": "C"}
PROCESSORS = {
    "no compiler": {"NUMBA_DISABLE_JIT": "1"},
    "generic": {"NUMBA_CPU_NAME": "generic"},
    "haswell": {"NUMBA_CPU_NAME": "haswell"},
    "checked": {"NUMBA_BOUNDSCHECK": "1"},
    "numpy without vectors": {"NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR"},
}


def bytes_of(folder, which=RUNS, *more):
    """Hashes of the log and the rows of each run."""
    return {name: hashes(log_of(name, folder / name, *more)) for name in which}


def tell(folder):
    """What a process of its own does: obey the language, do the runs, print the hashes."""
    locale.setlocale(locale.LC_ALL, "")
    print(json.dumps([gapath.__file__, locale.setlocale(locale.LC_ALL), bytes_of(Path(folder))]))


def elsewhere(folder, environment):
    """What `tell` gives in an environment."""
    code = "import sys, test_same_bytes; test_same_bytes.tell(sys.argv[1])"
    process = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code, str(folder)],
        env=os.environ | {"PYTHONPATH": str(HERE.parent)} | environment,
        cwd=HERE,
        capture_output=True,
        text=True,
        check=False,
    )
    assert process.returncode == 0, process.stderr
    return json.loads(process.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    return bytes_of(tmp_path_factory.mktemp("here"))


@pytest.fixture(scope="module")
def turkish(tmp_path_factory):
    """A folder with a language of decimal commas and dotless i, where the system can make it."""
    folder = tmp_path_factory.mktemp("languages")
    try:
        subprocess.run(
            ["localedef", "-i", "tr_TR", "-f", "UTF-8", folder / "tr_TR.UTF-8"],
            check=True,
            capture_output=True,
        )
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("no localedef, or no tr_TR to make")
    return {"LOCPATH": str(folder)}


@pytest.mark.parametrize(
    ("how", "which"),
    [
        (["kernels=scalar"], ["plan"]),
        (["threads=2"], ["plan", "memetic", "visibility", "scenario"]),
        (["recorder=[mcap,rerun]", "recorder.rerun.trials=[0]"], RUNS),
    ],
)
def test_bytes_do_not_depend_on_how_a_run_is_done_or_recorded(how, which, here, tmp_path):
    assert bytes_of(tmp_path, which, *how) == {name: here[name] for name in which}


@pytest.mark.parametrize("processor", rounds(["no compiler"], PROCESSORS))
def test_bytes_do_not_depend_on_the_environment(processor, here, turkish, tmp_path):
    kept = PROCESSORS[processor]
    if "NUMBA_CPU_NAME" in kept or "NUMBA_BOUNDSCHECK" in kept:
        kept = kept | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    choices = [[PLAIN[key], ELSEWHERE[key]] for key in PLAIN]
    every = rounds([tuple(ELSEWHERE.values())], list(itertools.product(*choices)))
    for n, values in enumerate(every):
        environment = dict(zip(PLAIN, values, strict=True))
        _, language, hashes = elsewhere(tmp_path / str(n), turkish | kept | environment)
        assert environment["LC_ALL"] in language
        assert hashes == here, environment
    print(f"{len(every)} environments, {processor}: {len(RUNS)} runs each, all equal")
