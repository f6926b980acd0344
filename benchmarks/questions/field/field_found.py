"""Whether planners find every path that there is, and claim nothing that is not so.

All problems of all real maps: MovingAI's scenarios, with corners cut and without; 50 pairs of
random free fields a ROS map; BARN's worlds; the squares of the University of Tulsa, corner to
corner. Then 30 instances of each class of reconstructed maps, 5 of each generated one at 300 x 200
fields, and 1000 small random maps, half of them of several weights, by all rules of corners. What
can be solved is told by a flood of the map. "missed": no path found where there is one; "not
proved": no proof that there is none where there is none. "false": a path that is none or costs
something else, or "infeasible" where there is a path.
"""

from collections import Counter
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np

import gapath
from benchmarks.field import contenders, unsuited, verdict
from benchmarks.measure import Row
from benchmarks.posed import (
    NO_DATA,
    evenly,
    random_problems,
    real_maps,
    scenario_problems,
    scenarios,
    solvable,
)
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.rng import fill, high, low, stream
from gapath.mapio import reconstructed
from gapath.mapio.generated.classes import CLASSES
from gapath.planning.planner import Planner
from gapath.problem import CornerCutting, Problem

PLANNERS = ("memetic", "memetic_quality")
RULES = (CornerCutting.ALLOW, CornerCutting.FORBID)
INSTANCES, GENERATED = 30, 5
PAIRS = 50
RANDOM = 1000
WEIGHTS = np.array([0.0, 0.25, 0.5, 0.7, 1 / 3, 0.999])


def movingai_problems(folder: Path) -> Iterator[Problem]:
    for (path, rows), rule in product(scenarios(folder), RULES):
        yield from scenario_problems(path, rows, rule)


def ros_problems(folder: Path) -> Iterator[Problem]:
    for number, path in enumerate(sorted(folder.rglob("*.yaml"))):
        try:
            grid = gapath.load_map(path)
        except InputError:  # one that names a picture that is not there
            continue
        for rule in RULES:
            yield from random_problems(grid, PAIRS, number, rule)


def barn_problems(folder: Path) -> Iterator[Problem]:
    return _own_ends(sorted(folder.glob("*.json")))


def tulsa_problems(folder: Path) -> Iterator[Problem]:
    return _own_ends(sorted(folder.glob("*.txt")))


def _own_ends(paths: list[Path]) -> Iterator[Problem]:
    """Pose the problems that files have themselves, if their ends are free."""
    for path in paths:
        grid = gapath.load_map(path)
        assert grid.start is not None and grid.target is not None
        if not any(grid.obstacles[y, x] for x, y in (grid.start, grid.target)):
            for rule in RULES:
                yield Problem(grid, grid.start, grid.target, rule)


REAL = {
    "movingai": movingai_problems,
    "ros": ros_problems,
    "barn": barn_problems,
    "tulsa": tulsa_problems,
}
"""Folders of real maps, and what is asked there."""


def class_problems(name: str, instances: int, **size: int) -> Iterator[Problem]:
    for instance in range(instances):
        grid = gapath.load_map(name, instance=instance, **size)
        assert grid.start is not None and grid.target is not None
        for rule in RULES:
            yield Problem(grid, grid.start, grid.target, rule)


def small_maps(count: int) -> Iterator[Problem]:
    """Draw maps of 2 to 40 fields a side, every other one uniform, up to half of it obstacles."""
    head = np.empty(4, dtype=np.uint64)
    for number in range(count):
        random = stream(0, number)
        fill(random, head)
        rows, cols = 2 + high(head[0], 39), 2 + low(head[0], 39)
        words = np.empty((rows, cols), dtype=np.uint64)
        fill(random, words.ravel())
        drawn = WEIGHTS[(words & np.uint64(0xFFFF)) % np.uint64(len(WEIGHTS))]
        weights = drawn if number % 2 else np.full((rows, cols), 0.5)
        share = np.uint64(high(head[1], 51))
        weights[(words >> np.uint64(32)) % np.uint64(100) < share] = 1.0
        start, target = ((high(word, cols), low(word, rows)) for word in head[2:])
        for x, y in (start, target):
            weights[y, x] = 0.5
        grid = GridMap(f"random {number}", weights)
        yield Problem(grid, start, target, CornerCutting(number % 4))


def sources(quick: bool) -> Iterator[tuple[str, list[Problem] | str]]:
    """Give the problems of each source, or why there are none."""
    folder = real_maps()
    for name, pose in REAL.items():
        there = folder is not None and (folder / name).is_dir()
        yield name, list(pose(folder / name)) if folder and there else NO_DATA
    for name in (*reconstructed.CLASSES, *reconstructed.UNKNOWN_CLASSES):
        yield name, list(class_problems(name, 1 if quick else INSTANCES))
    for name in CLASSES:
        few = class_problems(name, 1 if quick else GENERATED, width=300, height=200)
        yield name, list(few)
    yield "random maps", list(small_maps(RANDOM))


def measure(quick: bool) -> list[Row]:
    rows: list[Row] = []
    every: dict[str, Counter[str]] = {name: Counter() for name in PLANNERS}
    for source, problems in sources(quick):
        chosen = evenly(problems, 4) if quick and not isinstance(problems, str) else problems
        for name, planner in contenders(PLANNERS).items():
            row: Row = {"source": source, "planner": name}
            if isinstance(chosen, str) or isinstance(planner, str):
                rows.append(row | {"problems": chosen if isinstance(chosen, str) else planner})
            elif reason := unsuited(planner, chosen):
                rows.append(row | {"problems": reason})
            else:
                judged = judgements(planner, chosen)
                every[name] += judged
                rows.append(row | _row(judged))
    rows += [
        {"source": "all", "planner": n} | _row(judged) for n, judged in every.items() if judged
    ]
    return rows


def judgements(planner: Planner, problems: list[Problem]) -> Counter[str]:
    """Count what comes of the problems that can be solved, and of those that cannot."""
    counts: Counter[str] = Counter()
    for seed, problem in enumerate(problems):
        judged = verdict(problem, planner.plan(problem, stream(seed)))
        counts[f"{judged}, {'solvable' if solvable(problem) else 'not solvable'}"] += 1
    return counts


def _row(judged: Counter[str]) -> Row:
    found, proved = judged["found, solvable"], judged["proved, not solvable"]
    missed, unproved = judged["missed, solvable"], judged["missed, not solvable"]
    wrong = judged["false, solvable"] + judged["false, not solvable"]
    joined = sum(count for key, count in judged.items() if key.endswith(", solvable"))
    apart = judged.total() - joined
    row: Row = {"problems": judged.total(), "false": wrong}
    if joined:
        row |= {"solvable": joined, "found %": 100 * found / joined, "missed": missed}
    if apart:
        row |= {"not solvable": apart, "proved %": 100 * proved / apart, "not proved": unproved}
    return row
