"""Evolutions on a GPU, in its simulator and on the processor.

Started as a script it reads cases from standard input, and writes what they come to.
"""

import json
import sys

import numpy as np

from gapath.grid import GridMap
from gapath.kernels.kg18.bspline import fractions
from gapath.kernels.kg18.evolution import run_evolutions
from gapath.kernels.rng import stream
from gapath.planners.bspline_ga import Planner
from gapath.problem import CornerCutting, Problem

USUAL = {
    "population": 5,
    "control_points": 4,
    "min_epochs": 1,
    "max_epochs": 4,
    "way_points": 5,
    "sampling": "curve",
    "mixing": 0.8,
    "mutation_probability": 0.4,
    "line_jitter": 3,
    "line_jitter_probability": 0.5,
    "neighbourhood": 4,
    "margin": 0,
    "clip_to_map": False,
    "vln": 1e5,
}


def posed(rows, cols, obstacles, rule, seed):
    """Draw a problem: any weights, a share of obstacles, start and target free."""
    random = np.random.default_rng(seed)
    weights = random.choice([0.0, 0.25, 0.5, 0.7, 1 / 3, 0.99999], (rows, cols))
    weights[random.random((rows, cols)) < obstacles] = 1.0
    ends = [(int(random.integers(cols)), int(random.integers(rows))) for _ in range(2)]
    for x, y in ends:
        weights[y, x] = 0.5
    return Problem(GridMap("drawn", weights), *ends, CornerCutting[rule.upper()])


def asked(case):
    """Give the planner of a case, its problem and its streams."""
    ga = Planner(**(USUAL | case.get("settings", {})))
    shape = case.get("map", [9, 12])
    seed = case.get("seed", 0)
    problem = posed(*shape, case.get("obstacles", 0.2), case.get("rule", "allow"), seed)
    runs = case.get("runs", 3)
    return ga, problem, np.array([stream(seed, trial) for trial in range(runs)])


def by_processor(case):
    """Do a case's runs on the processor."""
    return processed(*asked(case))


def processed(ga, problem, streams):
    """Do runs on the processor: epochs, keys, best chromosomes, streams."""
    ends = run_evolutions(*ga.arguments(problem), streams, ga.evolve)
    epochs = [len(each.epochs) for each in ends]
    keys = [int(each.epochs["key"][-1]) for each in ends]
    best = [each.chromosomes[-1].tolist() for each in ends]
    return [epochs, keys, best, streams.tolist()]


def by_card(case):
    """Do the same on the GPU, or in the simulator; a case may limit what a launch takes."""
    from gapath.kernels.cuda import evolution
    from gapath.kernels.cuda.compiler import card

    limits = {name: case[name] for name in ("MOST_RUNS", "MOST_SHARED") if name in case}
    usual = {name: getattr(evolution, name) for name in limits}
    for name, value in limits.items():
        setattr(evolution, name, value)
    with_memory = card()._replace(**case.get("card", {}))
    found = launched(with_memory, *asked(case))
    for name, value in usual.items():
        setattr(evolution, name, value)
    return found


def launched(card, ga, problem, streams):
    """Do runs on a GPU: epochs, keys, best chromosomes, streams."""
    from gapath.kernels.cuda.evolution import outcomes

    whole = fractions(ga.control_points, ga.way_points, ga.sampling == "span")
    found = outcomes(card, *ga.arguments(problem)[:4], whole, streams)
    return [*(each.tolist() for each in found), streams.tolist()]


if __name__ == "__main__":
    json.dump([by_card(case) for case in json.load(sys.stdin)], sys.stdout)
