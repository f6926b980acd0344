"""M22's genetic algorithm: whether it is that of the library geneticalgorithm2.

Our profiles against runs of the library that are kept in ``tests/reference``, on the same graphs
with the same settings: as many seeds, other random numbers. For the best f, generations and
evaluations: the two-sample Kolmogorov-Smirnov statistic and its p, which ties make too large
rather than too small, and Cliff's delta: how much more often ours is the larger one than the
smaller one, in [-1, 1]. Of comparisons that agree, one in a hundred has p below 1 %.
"""

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import ks_2samp, mannwhitneyu

from benchmarks.measure import Row, make_visibility_ga
from benchmarks.rivals.visibility_library import SCENES
from benchmarks.scene import Scene
from gapath.kernels.m22.evolution import run_evolution
from gapath.kernels.rng import stream
from gapath.kernels.units import SCALE

REFERENCE = Path(__file__).parents[3] / "tests" / "reference"
PROFILES = {"v64": "6.4.1", "v67": "6.7.7", "v69": "6.9.2"}
MEASURES = ("f", "generations", "evaluations")


def ours(scene: Scene, seeds: range, **settings: Any) -> dict[str, NDArray[Any]]:
    """Run our genetic algorithm.

    Parameters
    ----------
    scene : Scene
        The target function.
    seeds : range
        Seeds, a run each.
    settings
        Of conf/planner/visibility_ga.yaml, where others.

    Returns
    -------
    dict of str to (n,) array
        The `MEASURES` of each run, f in pixels.
    """
    planner = make_visibility_ga(**settings)
    kernel_settings = planner.kernel_settings(scene.problem, 1)
    runs = [run_evolution(scene.lengths, scene.genes, kernel_settings, stream(s)) for s in seeds]
    generations = np.array([len(run.epochs) for run in runs])
    born = planner.population - planner.parents
    return {
        "f": np.array([run.epochs["best"][-1] for run in runs]) / SCALE,
        "generations": generations,
        "evaluations": planner.population + born * (generations - 1),
    }


@cache
def reference(profile: str) -> dict[str, Any]:
    """Read the runs of the library's version that a profile is."""
    path = REFERENCE / f"geneticalgorithm2-{PROFILES[profile]}.json"
    found: dict[str, Any] = json.loads(path.read_text("utf-8"))
    return found


def compared(ours: Any, theirs: Any) -> Row:
    """Compare two samples; f to the thousandth of a pixel, as it is kept."""
    ours, theirs = np.round(ours, 3), np.asarray(theirs)
    test = ks_2samp(ours, theirs)
    above = mannwhitneyu(ours, theirs).statistic
    delta = 2 * above / (len(ours) * len(theirs)) - 1
    return {"KS": float(test.statistic), "p": float(test.pvalue), "delta": float(delta)}


def agreement(profile: str, name: str, **settings: Any) -> dict[str, Row]:
    """Compare a profile, or what it becomes with other settings, with its version on a scene.

    Parameters
    ----------
    profile : str
        A key of `PROFILES`.
    name : str
        One of `SCENES`.
    settings
        As of `ours`.

    Returns
    -------
    dict of str to dict
        For each of `MEASURES`: KS, p and delta.
    """
    theirs = reference(profile)["scenes"][name]
    seeds = range(len(theirs["f"]))
    found = ours(Scene.of(name), seeds, **{"ga2_profile": profile} | settings)
    return {measure: compared(found[measure], theirs[measure]) for measure in MEASURES}


def measure(quick: bool) -> list[Row]:
    table = []
    for profile, version in PROFILES.items():
        for name in SCENES:
            row: Row = {"library": version, "profile": profile, "scene": name}
            row["runs"] = len(reference(profile)["scenes"][name]["f"])
            for measure, found in agreement(profile, name).items():
                row |= {f"{measure}: {key}": value for key, value in found.items()}
            table.append(row)
    return table
