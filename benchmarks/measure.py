"""How the benchmarks measure: interleaved, as medians with quartiles, beside a machine's name."""

import os
import platform
import random
import statistics
import subprocess
import sys
import sysconfig
import time
from collections.abc import Callable, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

import gapath
from gapath.components import build
from gapath.discovery import yaml_values
from gapath.planners import bspline_ga, visibility_ga
from gapath.planning.planner import Planner
from gapath.problem import Problem
from gapath.store.provenance.machine import processor

MAPS = ("kg18_test1", "kg18_test2", "kg18_test3", "kg18_test4")
SETTINGS = ("ga1", "ga2", "ga3")
COMMAND, REPORT = (
    str(Path(sysconfig.get_path("scripts")) / name) for name in ("gapath", "gapath-report")
)
"""The commands of this environment."""

PACKAGES = ("gapath", "numba", "numpy", "scipy", "scikit-image")

Row: TypeAlias = dict[str, Any]
"""A row of a table; a `Quartiles` becomes three columns of the CSV."""

Calls: TypeAlias = dict[str, Callable[[], Any]]
"""Rivals by name; calling one does the work that is timed."""


class Quartiles(NamedTuple):
    """Median and quartiles of a sample."""

    median: float
    lower: float
    upper: float


def quartiles(sample: Sequence[float]) -> Quartiles:
    """Summarise a sample of at least one value."""
    if len(sample) == 1:
        return Quartiles(sample[0], sample[0], sample[0])
    lower, median, upper = statistics.quantiles(sample, n=4, method="inclusive")
    return Quartiles(median, lower, upper)


def ratios(above: Sequence[float], below: Sequence[float]) -> Quartiles:
    """Summarise the ratios of times that were measured side by side."""
    return quartiles([a / b for a, b in zip(above, below, strict=True)])


class Spent(NamedTuple):
    """What a process spent: seconds on all cores, and the most memory that it held at once."""

    cpu_s: float
    peak_bytes: int


def spent(command: Sequence[str]) -> Spent:
    """Run a process to its end, its output thrown away; one that fails raises.

    It is the child of a small process: the system counts as a child's memory what its parent held
    when it was started.
    """
    run = [sys.executable, "-c", _IN_A_CHILD, *command]
    done = subprocess.run(run, check=True, capture_output=True, text=True)
    cpu, kilobytes = done.stdout.split()
    return Spent(float(cpu), 1024 * int(kilobytes))


_IN_A_CHILD = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime, used.ru_maxrss)
"""


def timed(call: Callable[[], Any]) -> tuple[float, Any]:
    """Give the wall time of a call in microseconds, and its result."""
    begin = time.perf_counter()
    result = call()
    return 1e6 * (time.perf_counter() - begin), result


def interleave(rounds: Sequence[Calls]) -> tuple[dict[str, list[float]], list[dict[str, Any]]]:
    """Time rivals in turn, so that whatever slows the machine slows all of them.

    Parameters
    ----------
    rounds : sequence of dict of str to callable
        The same rivals in every round, each timed once, in an order drawn for each round:
        what ran before decides what the caches hold. The first round warms up and is left out.

    Returns
    -------
    times : dict of str to list of float
        Microseconds, one value a round.
    results : list of dict of str to object
        The results of each round.
    """
    names = list(rounds[0])
    times: dict[str, list[float]] = {name: [] for name in names}
    results = []
    shuffle = random.Random(0).shuffle
    for calls in rounds:
        found = {}
        shuffle(names)
        for name in names:
            microseconds, found[name] = timed(calls[name])
            times[name].append(microseconds)
        results.append(found)
    return {name: sample[1:] for name, sample in times.items()}, results[1:]


def make_problem(map_name: str) -> Problem:
    """Pose the problem of one of gapath's own maps."""
    grid = gapath.load_map(map_name)
    assert grid.start is not None and grid.target is not None
    return Problem(grid, grid.start, grid.target)


def repeat_fields(weights: NDArray[np.float64], across: int, down: int) -> NDArray[np.float64]:
    """Make each field of a map a block of so many columns and rows."""
    return weights.repeat(down, axis=0).repeat(across, axis=1)


def make_planner(name: str, **settings: Any) -> Planner:
    """Make a planner of ``conf/planner``, some of its values replaced."""
    planner: Planner = build("planner", yaml_values("planner", name) | settings, "planner")
    return planner


def make_bspline_ga(name: str, **settings: Any) -> bspline_ga.Planner:
    """Make a planner of KG18, as `make_planner` does."""
    planner = make_planner(name, **settings)
    assert isinstance(planner, bspline_ga.Planner)
    return planner


def make_visibility_ga(**settings: Any) -> visibility_ga.Planner:
    """Make M22's planner, as `make_planner` does."""
    planner = make_planner("visibility_ga", **settings)
    assert isinstance(planner, visibility_ga.Planner)
    return planner


def machine() -> Row:
    """Describe what the numbers were measured on."""
    return {
        "CPU": processor(),
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else "unknown",
        "system": platform.system(),
        "Python": platform.python_version(),
        **{name: metadata.version(name) for name in PACKAGES},
    }
