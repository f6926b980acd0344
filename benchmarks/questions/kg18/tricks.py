"""What each thing that makes KG18's genetic algorithm fast is worth.

The same work "with" it and "without", in turn, on kg18_test4 (100 x 50 fields) with GA 3's
settings unless the row says otherwise; both give the same results, or this stops. Chromosomes to
evaluate are drawn anywhere on the map. What storing places and reading entries one by one is worth
against gathering them is in `fitness`, what all of it together is worth in `ga_run`.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import (
    Row,
    interleave,
    make_bspline_ga,
    make_problem,
    quartiles,
    ratios,
    repeat_fields,
)
from gapath.kernels.history.epochs import EPOCHS
from gapath.kernels.jit import kernel
from gapath.kernels.kg18.bspline import basis
from gapath.kernels.kg18.evaluation import evaluate, workspace
from gapath.kernels.kg18.lanes import (
    GENES,
    ONE_BY_ONE,
    SIDE_BY_SIDE,
    Way,
    chromosome_matrix,
    width,
)
from gapath.kernels.kg18.population import Mixing, rank_best, vary
from gapath.kernels.raster import COORDINATE_LIMIT
from gapath.kernels.rng import fill, probability_threshold, stream
from gapath.kernels.table import fill_table
from gapath.kernels.units import OBSTACLE, SCALE

POPULATION, CONTROL_POINTS = 100, 5
SELECTED = POPULATION // 4
CHILDREN = 1000
RUNS = 20
EPOCHS_A_CALL = 16

Work = Callable[[], Any]


def compare(what: str, unit: str, units: int, ours: Work, other: Work, rounds: int) -> Row:
    """Time two ways of doing the same; `units` of the unit's nanoseconds are done in a call."""
    times, results = interleave([{"with": ours, "without": other}] * (rounds + 1))
    if not all(np.array_equal(found["with"], found["without"]) for found in results):
        raise RuntimeError(f"{what}: another result without it")
    row: Row = {"what": what, "unit": unit}
    for name, sample in times.items():
        row[name] = quartiles([1000 * t / units for t in sample])
    return row | {"without / with": ratios(times["without"], times["with"])}


def evaluation(rounds: int) -> list[Row]:
    """Evaluate chromosomes side by side, and only those whose fitness is not known yet."""
    table = make_problem("kg18_test4").map.table
    splines, genes = basis(CONTROL_POINTS, 5, False), 2 * CONTROL_POINTS
    random, count = np.random.default_rng(0), EPOCHS_A_CALL * POPULATION
    rows = chromosome_matrix(count, genes)
    for axis, side in enumerate(table.shape[::-1]):
        rows[:, axis:genes:2] = random.integers(0, side, (len(rows), CONTROL_POINTS))
    memory = workspace(splines)
    known = np.empty(count, dtype=np.int64)
    evaluate(ONE_BY_ONE, table, rows, 0, count, splines, 0, known, memory)

    def run(way: Way, first: int) -> NDArray[np.int64]:
        keys = known.copy()
        keys[first:] = -1
        evaluate(way, table, rows, first, count, splines, 0, keys, memory)
        return keys

    everyone, offspring = partial(run, SIDE_BY_SIDE, 0), partial(run, SIDE_BY_SIDE, count // 4)
    one_by_one = partial(run, ONE_BY_ONE, 0)
    what = "chromosomes evaluated side by side, not one by one"
    again = "the selected quarter not evaluated again"
    return [
        compare(what, "ns a chromosome", count, everyone, one_by_one, rounds),
        compare(again, "ns an epoch", EPOCHS_A_CALL, offspring, everyone, rounds),
    ]


@kernel
def vary_many(
    way: Way,
    parents: NDArray[np.int32],
    words: NDArray[np.uint64],
    shift: int,
    threshold: np.uint64,
    changes: NDArray[np.int32],
    limits: NDArray[np.int32],
    children: NDArray[np.int32],
    genes: int,
) -> None:
    for i in range(children.shape[0]):
        a, b = i % SELECTED, 7 * i % SELECTED
        mixing = Mixing(0.8, 0.2, 0.55)
        vary(
            way,
            parents,
            a,
            b,
            mixing,
            words,
            i,
            shift,
            threshold,
            changes,
            limits,
            children,
            i,
            genes,
        )


def breeding(rounds: int) -> Row:
    """Cross and mutate genes side by side."""
    genes = 2 * CONTROL_POINTS
    random = np.random.default_rng(0)
    parents = random.integers(0, 50, (SELECTED, width(genes))).astype(np.int32)
    words = np.empty(CHILDREN + genes + GENES, dtype=np.uint64)
    fill(stream(0), words)
    changes, limits = (np.empty((2, width(genes)), dtype=np.int32) for _ in range(2))
    changes[0], changes[1] = 51, 25
    limits[0], limits[1] = -COORDINATE_LIMIT, COORDINATE_LIMIT
    threshold = probability_threshold(make_bspline_ga("ga3").mutation_probability)
    children = {
        way: np.zeros((CHILDREN, width(genes)), dtype=np.int32)
        for way in (SIDE_BY_SIDE, ONE_BY_ONE)
    }

    def run(way: Way) -> NDArray[np.int32]:
        vary_many(way, parents, words, 0, threshold, changes, limits, children[way], genes)
        return children[way][:, 2 : genes - 2]

    return compare(
        "genes crossed and mutated side by side, not one by one",
        "ns a child",
        CHILDREN,
        partial(run, SIDE_BY_SIDE),
        partial(run, ONE_BY_ONE),
        rounds,
    )


@kernel
def insert_all(keys: NDArray[np.int64], best: NDArray[np.int64]) -> None:
    for epoch in range(keys.shape[0]):
        rank_best(keys[epoch], best[epoch])


@kernel
def sort_all(keys: NDArray[np.int64], best: NDArray[np.int64]) -> None:
    for epoch in range(keys.shape[0]):
        order = np.argsort(keys[epoch], kind="mergesort")  # stable: ties go to the lower index
        for i in range(best.shape[1]):
            best[epoch, i] = order[i]


def ranking(rounds: int) -> Row:
    """Insert the fittest into a short list; the selected quarter leads, as in every epoch."""
    keys = np.random.default_rng(0).integers(0, 1 << 50, (EPOCHS_A_CALL, POPULATION))
    keys[:, :SELECTED] = np.sort(keys)[:, :SELECTED]

    def run(kernel: Callable[..., Any]) -> NDArray[np.int64]:
        best = np.empty((EPOCHS_A_CALL, SELECTED), dtype=np.int64)
        kernel(keys, best)
        return best

    what = "the fittest inserted into a list, not all sorted"
    ours, other = partial(run, insert_all), partial(run, sort_all)
    return compare(what, "ns an epoch", EPOCHS_A_CALL, ours, other, rounds)


def batch(rounds: int) -> Row:
    """Do many runs in one call of the kernel."""
    problem, planner = make_problem("kg18_test1"), make_bspline_ga("ga1")
    streams = np.array([stream(0, trial) for trial in range(RUNS)])
    history = np.empty((RUNS, planner.max_epochs), dtype=EPOCHS)
    chromosomes = np.empty((*history.shape, 2 * planner.control_points), dtype=np.int32)
    epochs = np.empty(RUNS, dtype=np.int64)
    query = planner.arguments(problem)

    def run(runs: int) -> NDArray[np.int64]:
        random = streams.copy()
        for first in range(0, RUNS, runs):
            part = slice(first, first + runs)
            kept = history[part], chromosomes[part], epochs[part]
            planner.evolve(*query, random[part], *kept)
        last = np.arange(RUNS), epochs - 1
        return np.column_stack([epochs, history["key"][last], chromosomes[last]])

    what = "GA 1 on map 1: twenty runs in a call, not one"
    return compare(what, "ns a run", RUNS, partial(run, RUNS), partial(run, 1), rounds)


def table(rounds: int) -> Row:
    """Build the map's table by a kernel."""
    weights = repeat_fields(make_problem("kg18_test4").map.weights, 10, 10)

    def by_kernel() -> NDArray[np.int32]:
        found = np.empty(weights.shape, dtype=np.int32)
        fill_table(weights.ravel(), found.ravel())
        return found

    def by_numpy() -> NDArray[np.int32]:
        found: NDArray[np.int32] = np.floor(weights * SCALE + 0.5).astype(np.int32)
        found[weights == 1.0] = OBSTACLE
        return found

    what = "1000 x 500 fields: the map's table built by a kernel, not by NumPy"
    return compare(what, "ns a field", weights.size, by_kernel, by_numpy, rounds)


def measure(quick: bool) -> list[Row]:
    rounds = 3 if quick else 200
    return [
        *evaluation(rounds),
        breeding(rounds),
        ranking(rounds),
        batch(rounds),
        table(rounds // 3),
    ]
