"""A log made by one Python is reproduced by every other, compiled or not.

`GAPATH_PYTHONS` names other interpreters that gapath is installed for, with `:` between them; at
length this one is tried alone, too: a checkout against its wheel, compiled against not.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from installed import copy_sources, install
from scale import rounds

HERE = Path(__file__).parent
OTHERS = list(filter(None, os.environ.get("GAPATH_PYTHONS", "").split(os.pathsep)))
COMPILED = {"compiled": "0", "not compiled": "1"}

MAKE = """
import json, sys
from logs_of_runs import PAPERS, RUNS, hashes, log_of
from pathlib import Path

import gapath
from gapath.store.keys import versions

logs = {name: log_of(name, Path(sys.argv[1]) / name) for name in RUNS | PAPERS}
told = {name: [str(log), log.parent.name, *hashes(log)] for name, log in logs.items()}
print(json.dumps([gapath.__file__, versions(), told]))
"""
VERIFY = (
    "import sys; from gapath.commands import log; sys.exit(log.main(['verify', *sys.argv[1:]]))"
)


def said_by(python, compiled, code, *words):
    """What a Python, with its environment, prints; its exit code must be 0."""
    command, environment = python
    given = [place.get("PYTHONPATH") for place in (environment, os.environ)]
    path = os.pathsep.join([*filter(None, given), str(HERE)])
    switches = {"NUMBA_DISABLE_JIT": compiled, "PYTHONPATH": path}
    process = subprocess.run(
        [command, "-W", "ignore", "-c", code, *map(str, words)],
        env=os.environ | environment | switches,
        cwd=HERE,  # which comes before everything else: not a checkout
        capture_output=True,
        text=True,
        check=False,
    )
    assert process.returncode == 0, process.stdout + process.stderr
    return process.stdout.splitlines()


@pytest.fixture
def wheel(tmp_path):
    """The package as pip installs it, in a folder."""
    return install(copy_sources(tmp_path / "source"), tmp_path / "site")


@pytest.mark.skipif(not OTHERS and rounds(True, False), reason="GAPATH_PYTHONS names none")
def test_a_log_of_one_python_is_reproduced_by_every_other(wheel, tmp_path):
    pythons = {"here": (sys.executable, {}), "wheel": (sys.executable, {"PYTHONPATH": str(wheel)})}
    pythons |= {command: (command, {}) for command in OTHERS}
    made = {}
    for name, python in pythons.items():
        for how, switch in COMPILED.items():
            folder = tmp_path / f"{len(made)}"
            made[name, how] = json.loads(said_by(python, switch, MAKE, folder)[-1])
    assert Path(made["wheel", "compiled"][0]).is_relative_to(wheel)

    ours, logs_of = made["here", "compiled"][2], {}
    for who, (_, versions, theirs) in made.items():
        for run, (_, key, log, rows) in theirs.items():
            assert [key, rows] == [ours[run][1], ours[run][3]], (who, run)
            assert logs_of.setdefault((str(versions), run), log) == log, (who, run)

    count, bytewise = 0, 0
    for name, python in pythons.items():
        for how, switch in COMPILED.items():
            logs = [
                log[0] for (_, other), (*_, told) in made.items() if other != how
                for log in told.values()
            ]  # fmt: skip
            lines = said_by(python, switch, VERIFY, "verify", *logs)
            assert [": reproduced, " in line for line in lines] == [True] * len(logs), name
            count += len(logs)
            bytewise += sum("reproduced, byte for byte" in line for line in lines)
    told = {versions["python"]: None for _, versions, _ in made.values()}
    print(
        f"Python {', '.join(told)}, and a wheel, each compiled and not: {len(ours)} runs each, "
        f"all keys and rows equal; {count} times reproduced by the others, compiled by what is "
        f"not and the other way round, {bytewise} of them byte for byte"
    )
