"""M22's planner: image to path, its genetic algorithm and its collision test against rivals.

The ten scenes of the experiments, 800 x 600 with six obstacles; the settings of
``conf/planner/visibility_ga.yaml``. Each row is a piece of work; "rival / gapath" above 1 says
that gapath is the faster one.

- image to path: `Planner.plan`, and its stages; "genetic algorithm" has the check that a path
  exists, "rest" is the path on the map and its cost. The paper's 81.3 s are another machine's: an
  order of magnitude, no more. The target is 1000. With the library: our image work and graph,
  then geneticalgorithm2 6.9 with Table I's settings.
- a generation: our kernel, profile v69, and geneticalgorithm2 6.9, a hundred of each on the same
  target function: looked up in a NumPy array, as the library's users write one, or our compiled
  `path_length`. The target is 50.
- a line: `line_is_free` from Python, and the paper's test: draw the line into a copy of the
  image and compare all pixels (NumPy). Both find the same lines free, or this stops.
- search: the stage "genetic algorithm", and the shortest path that Dijkstra or A* find in the
  same graph.
"""

from functools import partial
from typing import Any

import numpy as np

from benchmarks.measure import (
    Calls,
    Row,
    interleave,
    make_planner,
    make_visibility_ga,
    quartiles,
    ratios,
)
from benchmarks.rivals.visibility_library import GA, looked_up, unavailable
from benchmarks.scene import Scene
from gapath.kernels.m22.evolution import path_length, run_evolution
from gapath.kernels.m22.graph import line_is_free
from gapath.kernels.raster import polyline
from gapath.kernels.rng import stream
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.planning.stages import Stages

MAPS = tuple(f"m22_scene{number:02d}" for number in range(1, 11))
PAPER_US = 81.3e6
GENERATIONS = 100
LIBRARY = "geneticalgorithm2"
COMPILED = "geneticalgorithm2, compiled target"


def compiled(lengths: Any, penalty: float) -> Any:
    """Give the target function of the library that our kernel has."""

    def target(chromosome: Any) -> float:
        length = path_length(lengths, chromosome.astype(np.int32), False)
        return length / SCALE if length >= 0 else penalty

    return target


TARGETS = {LIBRARY: looked_up, COMPILED: compiled}


def row(what: str, unit: str, ours: list[float], rival: str = "", times: Any = None) -> Row:
    """Make a row of the table; times in microseconds, a rival's also one of a paper, or text."""
    each = {"ms": 1e3, "us": 1.0}[unit]
    made: Row = {"work": what, "unit": unit, "gapath": quartiles([us / each for us in ours])}
    if not rival:
        return made
    if isinstance(times, str):
        return made | {"rival": rival, "its time": times}
    if isinstance(times, float):
        made |= {"rival": rival, "its time": times / each}
        times = [times] * len(ours)
    else:
        made |= {"rival": rival, "its time": quartiles([us / each for us in times])}
    return made | {"rival / gapath": ratios(times, ours)}


def measure(quick: bool) -> list[Row]:
    names = MAPS[:2] if quick else MAPS
    scenes = [Scene.of(name) for name in names]
    return [
        *time_plans(scenes, 1 if quick else 8),
        *time_generations(scenes[0], 5 if quick else GENERATIONS, 1 if quick else 20),
        time_lines(scenes[0], 20 if quick else 300, 1 if quick else 20),
    ]


def time_plans(scenes: list[Scene], seeds: int) -> list[Row]:
    """Time whole runs and their stages; every planner and library on the same scenes."""
    names = ("visibility_ga", "visibility_dijkstra", "visibility_astar")
    planners: dict[str, Any] = {name: make_planner(name) for name in names}
    why = unavailable()

    def rivals(scene: Scene, seed: int) -> Calls:
        calls: Calls = {
            name: partial(planner.plan, scene.problem, stream(seed))
            for name, planner in planners.items()
        }
        if not why:
            for name in TARGETS:
                calls[name] = partial(plan_with_library, planners[names[0]], scene, name, seed)
        return calls

    rounds = [(scene, seed) for scene in scenes for seed in range(seeds)]
    times, found = interleave([rivals(*each) for each in (rounds[0], *rounds)])
    whole = times["visibility_ga"]
    rows = [row("image to path", "ms", whole, "the paper", PAPER_US)]
    rows += [row("image to path", "ms", whole, name, why or times.get(name)) for name in TARGETS]

    stages = {
        name: [{key: 1e6 * s for key, s in plans[name].stages.items()} for plans in found]
        for name in planners
    }
    parts = stages["visibility_ga"]
    rows += [row(f"... {name}", "ms", [part[name] for part in parts]) for name in parts[0]]
    rest = [us - sum(part.values()) for us, part in zip(whole, parts, strict=True)]
    rows.append(row("... rest", "ms", rest))
    searches = [part["genetic algorithm"] for part in parts]
    for rival, name in (("Dijkstra", names[1]), ("A*", names[2])):
        rows.append(row("search", "us", searches, rival, [part["search"] for part in stages[name]]))
    return rows


def plan_with_library(planner: Any, scene: Scene, name: str, seed: int) -> Any:
    """Make the graph and let the library search it."""
    graph = planner.survey(scene.problem, Stages())
    target = TARGETS[name](graph.lengths, scene.penalty)
    return GA(target, len(graph.points), graph.obstacle_count).run(seed)


def time_generations(scene: Scene, generations: int, rounds: int) -> list[Row]:
    """Time a generation of the profile v69 and of the library."""
    planner = make_visibility_ga(ga2_profile="v69", max_epochs=generations, max_stagnation=None)
    settings = planner.kernel_settings(scene.problem, 1)
    without_stop = {"max_num_iteration": generations, "max_iteration_without_improv": None}
    why = unavailable()

    def rivals(seed: int) -> Calls:
        calls: Calls = {
            "gapath": partial(run_evolution, scene.lengths, scene.genes, settings, stream(seed))
        }
        if not why:
            for name, made in TARGETS.items():
                target = made(scene.lengths, scene.penalty)
                ga = GA(target, len(scene.lengths), scene.genes, **without_stop)
                calls[name] = partial(ga.run, seed)
        return calls

    times, found = interleave([rivals(seed) for seed in (0, *range(rounds))])
    for result in found:
        taken = [
            len(result["gapath"].epochs),
            *(result[name][1] for name in times if name in TARGETS),
        ]
        if set(taken) != {generations}:
            raise RuntimeError(f"generations differ: {taken}")
    each = {name: [us / generations for us in sample] for name, sample in times.items()}
    return [
        row("a generation", "us", each["gapath"], name, why or each.get(name)) for name in TARGETS
    ]


def drawn_and_compared(image: Any, line: Any) -> bool:
    """Test a line as the paper does: no pixel of the image differs from a copy with the line."""
    fields = polyline(line)
    copy = image.copy()
    copy[fields[:, 1], fields[:, 0]] = 0  # the floor is black
    return not np.bitwise_xor(image, copy).any()


def check_identical(ours: list[bool], theirs: list[bool]) -> None:
    """Raise RuntimeError unless both found the same lines free, some of them and not all."""
    if ours != theirs or len(set(ours)) < 2:
        raise RuntimeError(f"lines free: {sum(ours)} and {sum(theirs)} of {len(ours)}")


def time_lines(scene: Scene, lines: int, rounds: int) -> Row:
    """Time the collision test of a line, between random pixels of the grown picture."""
    planner = make_visibility_ga()
    grown = planner.survey(scene.problem, Stages()).obstacles
    table = np.where(grown, np.int32(OBSTACLE), np.int32(0))
    image = np.where(grown, np.uint8(255), np.uint8(0))
    rows, cols = grown.shape
    ends = np.random.default_rng(0).integers(0, (cols, rows), (lines, 2, 2)).astype(np.int32)
    numbers = ends.reshape(lines, 4).tolist()
    calls: Calls = {
        "gapath": lambda: [bool(line_is_free(table, a, b, c, d, 0)) for a, b, c, d in numbers],
        "XOR": lambda: [drawn_and_compared(image, line) for line in ends],
    }
    times, found = interleave([calls] * (1 + rounds))
    for result in found:
        check_identical(result["gapath"], result["XOR"])
    each = {name: [us / lines for us in sample] for name, sample in times.items()}
    return row("a line", "us", each["gapath"], "XOR of images", each["XOR"])
