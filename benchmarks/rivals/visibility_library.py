"""The library that M22 used, geneticalgorithm2, on the target functions of gapath's scenes.

`GA` runs with Table I's settings whatever version is installed. As a program it needs NumPy and
the library, but not gapath, so that older versions can run in environments of their own::

    python -m benchmarks.rivals.visibility_library GRAPHS --export # with gapath: writes graphs
    PYTHON -m benchmarks.rivals.visibility_library GRAPHS > FILE # PYTHON: any with it

writes what ``tests/reference/geneticalgorithm2-VERSION.json`` holds, made on Python 3.11 with

- geneticalgorithm2==6.9.2 (OppOpPopInit 2.0.1), the one of the bench extra;
- geneticalgorithm2==6.7.7 (OppOpPopInit 2.0.1);
- geneticalgorithm2==6.4.1 OppOpPopInit==1.2.0 setuptools<81: the newest OppOpPopInit that has its
  signatures. It also needs `collections.Sequence`, which Python 3.10 removed, and gets it below.

From 6.7 on the library's integer mutation hands floats to `random.randint`: Python 3.12 and later
refuse them.
"""

import argparse
import collections
import collections.abc
import hashlib
import json
import sys
import warnings
from collections.abc import Callable
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

SCENES = ("m22_scene01", "m22_scene06", "m22_scene07")
"""Those of the ten whose best f differs most from run to run."""

SETTINGS = {
    "max_num_iteration": 200,
    "population_size": 100,
    "mutation_probability": 0.1,
    "elit_ratio": 0.01,
    "crossover_probability": 0.5,
    "parents_portion": 0.3,
    "crossover_type": "uniform",
    "selection_type": "roulette",
    "max_iteration_without_improv": 20,
}
"""M22 Table I, and conf/planner/visibility_ga.yaml for what it leaves open."""


def unavailable() -> str | None:
    """Say why the library cannot run here, if so."""
    if not find_spec("geneticalgorithm2"):
        return "skipped: the bench extra is not installed"
    if sys.version_info >= (3, 12):
        return "skipped: geneticalgorithm2 needs Python 3.11"
    return None


def looked_up(lengths: Any, penalty: float) -> Callable[[Any], float]:
    """Give the target function as users of the library write one: M22 eqs (6) to (8).

    Parameters
    ----------
    lengths : (n, n) int64
        In units of 1 / 65536 pixel, negative where a line is not free.
    penalty : float
        Pixels that a broken restriction counts.

    Returns
    -------
    callable
        Gives the length in pixels of the path by way of a row of indices.
    """
    start, end = 0, 1

    def target(chromosome: Any) -> float:
        total, at = 0, start
        for to in [*chromosome, end]:
            length = lengths[at, int(to)]
            if length < 0:
                return penalty
            total += length
            if to == end:
                break
            at = int(to)
        return total / 65536

    return target


class Counted:
    """A target function that counts its calls."""

    def __init__(self, target: Callable[[Any], float]):
        self.target, self.calls = target, 0

    def __call__(self, chromosome: Any) -> float:
        """Call the target function."""
        self.calls += 1
        return self.target(chromosome)


class GA:
    """The library's genetic algorithm on a target function."""

    def __init__(self, target: Callable[[Any], float], points: int, genes: int, **changed: Any):
        collections.Sequence = collections.abc.Sequence  # type: ignore[attr-defined]
        from geneticalgorithm2 import geneticalgorithm2

        version = metadata.version("geneticalgorithm2")
        self.new = tuple(map(int, version.split("."))) >= (6, 8)
        settings = SETTINGS | changed
        if self.new:
            del settings["crossover_probability"]  # said to have no meaning
        self.quiet = {"progress_bar_stream": None} if self.new else {"disable_progress_bar": True}

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # newer versions want the target elsewhere
            self.library = geneticalgorithm2(
                target,
                dimension=genes,
                variable_type="int",
                variable_boundaries=[[0, points - 1]] * genes,
                algorithm_parameters=settings,
            )

    def run(self, seed: int) -> tuple[float, int]:
        """Run once.

        Parameters
        ----------
        seed : int
            Seed of the library's random numbers.

        Returns
        -------
        f : float
            The best value.
        generations : int
            Populations that were ranked, the first one included.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python 3.11 of floats as bounds of integers
            self.library.run(no_plot=True, disable_printing=True, seed=seed, **self.quiet)
        report = self.library.report
        return float(report[-1]), len(report)


def export(folder: Path) -> None:
    """Write the graphs of the scenes."""
    from benchmarks.scene import Scene

    folder.mkdir(parents=True, exist_ok=True)
    for name in SCENES:
        scene = Scene.of(name)
        graph = {
            "genes": scene.genes,
            "penalty": scene.penalty,
            "lengths": scene.lengths.tolist(),
        }
        (folder / f"{name}.json").write_text(json.dumps(graph) + "\n", encoding="utf-8")


def digest(lengths: Any) -> str:
    """Give a graph's SHA-256."""
    return hashlib.sha256(lengths.astype("<i8").tobytes()).hexdigest()


def reference(folder: Path, seeds: int) -> dict[str, Any]:
    """Run the library on every exported graph, with seeds from 0 on."""
    scenes = {}
    for name in SCENES:
        graph = json.loads((folder / f"{name}.json").read_text("utf-8"))
        lengths = np.array(graph["lengths"], dtype=np.int64)
        target = Counted(looked_up(lengths, graph["penalty"]))
        ga = GA(target, len(lengths), graph["genes"])
        f, generations, evaluations = [], [], []
        for seed in range(seeds):
            before = target.calls
            best, ranked = ga.run(seed)
            f.append(round(best, 3))
            generations.append(ranked)
            evaluations.append(target.calls - before)
        scenes[name] = {
            "lengths_sha256": digest(lengths),
            "f": f,
            "generations": generations,
            "evaluations": evaluations,
        }
    packages = ("geneticalgorithm2", "OppOpPopInit", "numpy")
    return {name: metadata.version(name) for name in packages} | {
        "Python": ".".join(map(str, sys.version_info[:3])),
        "settings": SETTINGS,
        "scenes": scenes,
    }


def main() -> None:
    """Export graphs, or run the library on exported ones."""
    parser = argparse.ArgumentParser(prog="visibility_library", description="see the docstring")
    parser.add_argument("graphs", type=Path, help="folder of the graphs")
    parser.add_argument("--export", action="store_true", help="write the graphs, run nothing")
    parser.add_argument("--seeds", type=int, default=500, help="runs on each graph")
    given = parser.parse_args()
    if given.export:
        export(given.graphs)
    else:
        json.dump(reference(given.graphs, given.seeds), sys.stdout, separators=(",", ":"))
        print()


if __name__ == "__main__":
    main()
