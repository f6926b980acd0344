"""KG18's whole evolution in one kernel (Secs 3.3-3.8).

What goes in and out are arrays and plain numbers: to unpack a NamedTuple of as many settings
takes numba longer than an epoch.
"""

from collections.abc import Mapping
from functools import partial
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.history.epochs import EPOCHS, History
from gapath.kernels.jit import JIT, kernel
from gapath.kernels.kg18.bspline import Basis
from gapath.kernels.kg18.evaluation import evaluate, workspace
from gapath.kernels.kg18.lanes import GENES, ONE_BY_ONE, SIDE_BY_SIDE, Way, chromosome_matrix
from gapath.kernels.kg18.population import (
    InitialPopulation,
    Mixing,
    gene_limits,
    initial_changes,
    initialise,
    rank_best,
    vary,
)
from gapath.kernels.lines import KEY_BITS, ONE_OBSTACLE, Ends
from gapath.kernels.rng import fill, high, low

SETTINGS = np.dtype(
    [
        ("population", np.int64),
        ("min_epochs", np.int64),
        ("max_epochs", np.int64),
        ("mixing_numerator", np.int64),
        ("mixing_denominator", np.int64),
        ("mutation_threshold", np.uint64),
        ("clip_to_map", np.bool_),
        ("line_jitter", np.int64),
        ("line_jitter_threshold", np.uint64),
        ("neighbourhood", np.int64),
        ("margin", np.int64),
    ],
    align=True,  # as a GPU reads them
)
"""Settings of the genetic algorithm, as the kernel takes them: an array of one row."""


class Evolve(Protocol):
    """Kernels of KG18's evolution, whatever runs them: all give the same, bit for bit."""

    def __call__(
        self,
        table: NDArray[np.int32],
        ends: tuple[int, int, int, int],
        rule: int,
        settings: NDArray[np.void],
        weights: NDArray[np.float64],
        rounding: NDArray[np.float64],
        streams: NDArray[np.uint64],
        history: NDArray[np.void],
        chromosomes: NDArray[np.int32],
        epochs: NDArray[np.int64],
        /,
    ) -> None:
        """Run the genetic algorithm, once for each stream.

        It returns nothing, because an interrupt that comes while numba makes Python objects
        of a result kills the process.

        Parameters
        ----------
        table : (rows, cols) int32
            `GridMap.table`.
        ends : (x, y, x, y)
            Start and target.
        rule : int
            Corner-cutting rule.
        settings : (1,) SETTINGS
            Settings; the population is at least 4.
        weights, rounding
            `gapath.kernels.kg18.bspline.Basis`.
        streams : (n, 4) uint64
            Random streams, one a run, advanced in place.
        history : (n, max_epochs) EPOCHS
            Overwritten.
        chromosomes : (n, max_epochs, 2 k) int32
            Overwritten with each epoch's best individual.
        epochs : (n,) int64
            Overwritten with the epochs taken.
        """


@kernel
def evolve(
    way: Way,
    table: NDArray[np.int32],
    ends: tuple[int, int, int, int],
    rule: int,
    settings: NDArray[np.void],
    weights: NDArray[np.float64],
    rounding: NDArray[np.float64],
    streams: NDArray[np.uint64],
    history: NDArray[np.void],
    chromosomes: NDArray[np.int32],
    epochs: NDArray[np.int64],
) -> None:
    """Run the genetic algorithm, once for each stream.

    Parameters
    ----------
    way : None or True
        `SIDE_BY_SIDE` or `ONE_BY_ONE`.
    table, ends, rule, settings, weights, rounding, streams, history, chromosomes, epochs
        As of `Evolve`.
    """
    rows, cols = table.shape
    setting = settings[0]
    size, genes = setting["population"], chromosomes.shape[2]
    selected = size // 4
    basis = Basis(weights, rounding)
    numerator, denominator = setting["mixing_numerator"], setting["mixing_denominator"]
    mixing = Mixing(
        numerator / denominator,
        (denominator - numerator) / denominator,
        0.5 + 0.25 / denominator,
    )
    initial = InitialPopulation(setting["line_jitter"], setting["neighbourhood"], setting["margin"])

    population, offspring = chromosome_matrix(size, genes), chromosome_matrix(size, genes)
    columns = population.shape[1]
    for i in range(size):
        for g in range(2):
            population[i, g] = offspring[i, g] = ends[g]
            population[i, genes - 2 + g] = offspring[i, genes - 2 + g] = ends[2 + g]
    keys = np.empty(size, dtype=np.int64)
    offspring_keys = np.empty(size, dtype=np.int64)
    best = np.empty(selected, dtype=np.int64)
    memory = workspace(basis)
    limits = np.empty((2, columns), dtype=np.int32)
    gene_limits(limits, Ends(*ends), genes, rows, cols, setting["clip_to_map"])
    middle = np.empty((3, columns), dtype=np.int32)
    first_changes = np.empty((3, 2, columns), dtype=np.int32)
    initial_changes(middle, first_changes, Ends(*ends), genes, rows, cols, initial)
    half = min(rows, cols) // 2  # KG18 Sec. 3.7: a gene changes by at most half the smaller side
    changes = np.empty((2, columns), dtype=np.int32)
    changes[0], changes[1] = 2 * half + 1, half
    first = np.empty(size * (genes - 4) + GENES, dtype=np.uint64)
    words = np.empty(genes - 3 + GENES, dtype=np.uint64)
    drawn = words[: genes - 3]  # one for the parents, one for each inner gene
    lower, word = np.int64(0), np.int64(1)  # no literals, for which `vary` would be compiled again

    for run in range(streams.shape[0]):
        stream = streams[run]
        fill(stream, first[:-GENES])
        initialise(
            way,
            population,
            size,
            limits,
            middle,
            first_changes,
            setting["line_jitter_threshold"],
            first,
        )
        evaluated = np.int64(0)  # individuals before this one carry their key over
        epoch = 0
        while True:
            evaluate(way, table, population, evaluated, size, basis, rule, keys, memory)
            rank_best(keys, best)

            obstacle_sum = np.int64(0)
            cost_sum = np.int64(0)
            for i in range(size):
                obstacle_sum += keys[i] >> KEY_BITS
                cost_sum += keys[i] & (ONE_OBSTACLE - 1)
            now = history[run, epoch]
            now["key"] = keys[best[0]]
            now["obstacle_sum"] = obstacle_sum
            now["cost_sum"] = cost_sum
            for g in range(genes):
                chromosomes[run, epoch, g] = population[best[0], g]
            epoch += 1

            # KG18 Sec. 3.8: a feasible path ends it, never before min_epochs
            feasible = keys[best[0]] < ONE_OBSTACLE
            if (feasible and epoch >= setting["min_epochs"]) or epoch == setting["max_epochs"]:
                break

            for i in range(selected):
                for g in range(columns):
                    offspring[i, g] = population[best[i], g]
                offspring_keys[i] = keys[best[i]]
            for i in range(selected, size):
                fill(stream, drawn)
                a, b = best[high(drawn[0], selected)], best[low(drawn[0], selected)]
                if keys[a] >= keys[b]:  # on equal fitness B dominates, eq. (6)
                    a, b = b, a
                vary(
                    way,
                    population,
                    a,
                    b,
                    mixing,
                    words,
                    word,
                    lower,
                    setting["mutation_threshold"],
                    changes,
                    limits,
                    offspring,
                    i,
                    genes,
                )
            population, offspring = offspring, population
            keys, offspring_keys = offspring_keys, keys
            evaluated = selected
        epochs[run] = epoch


class Outcomes(NamedTuple):
    """What n runs come to, without their histories."""

    epochs: NDArray[np.int64]
    """(n,) epochs taken."""
    keys: NDArray[np.int64]
    """(n,) the best individual's key."""
    chromosomes: NDArray[np.int32]
    """(n, 2 k) the best individual."""


VECTORS, SCALAR = "vectors", "scalar"

KERNELS: Mapping[str, Evolve] = {
    VECTORS: partial(evolve, SIDE_BY_SIDE),
    SCALAR: partial(evolve, ONE_BY_ONE),
}
"""By name; only the kernels that are called are compiled."""


def usable_kernels() -> tuple[str, ...]:
    """Name the `KERNELS` that run here, the default first: vectors need the compiler."""
    return tuple(KERNELS) if JIT else (SCALAR,)


def run_evolutions(
    table: NDArray[np.int32],
    ends: tuple[int, int, int, int],
    rule: int,
    settings: NDArray[np.void],
    weights: NDArray[np.float64],
    rounding: NDArray[np.float64],
    streams: NDArray[np.uint64],
    evolve: Evolve,
) -> list[History]:
    """Run the genetic algorithm once for each stream and cut each history to its epochs.

    Parameters
    ----------
    table, ends, rule, settings, weights, rounding, streams
        As of `Evolve`.
    evolve : Evolve
        The kernels.

    Returns
    -------
    list of History
        The last row of each is the answer.
    """
    runs, most = len(streams), int(settings["max_epochs"][0])
    history = np.empty((runs, most), dtype=EPOCHS)
    chromosomes = np.empty((runs, most, 2 * weights.shape[1]), dtype=np.int32)
    epochs = np.empty(runs, dtype=np.int64)
    given = table, ends, rule, settings, weights, rounding, streams
    evolve(*given, history, chromosomes, epochs)
    return [
        History(history[run, :taken], chromosomes[run, :taken])
        for run, taken in enumerate(epochs.tolist())
    ]


def evaluations(population: int, epochs: int) -> int:
    """Count the chromosomes evaluated: the selected quarter, copied, is not evaluated again."""
    return population + (epochs - 1) * (population - population // 4)
