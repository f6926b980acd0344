"""KG18's whole evolution on a GPU, a run a thread: what `gapath.kernels.kg18.evolution` comes to.

A thread does one epoch of its run after the other, and takes the next run when one has ended: in
each epoch all threads evaluate, wherever in their runs they are. Which thread does a run is left to
chance; nothing in a run depends on that. Of what a thread keeps its number is the last index, so
that threads side by side read places side by side.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gapath.errors import require
from gapath.kernels.cuda.card import Card
from gapath.kernels.cuda.compiler import cuda, int32, jit
from gapath.kernels.cuda.fitness import MOST_PARTS, fitness, way_rows
from gapath.kernels.kg18.evolution import Outcomes
from gapath.kernels.kg18.population import (
    InitialPopulation,
    changed,
    gene_limits,
    initial_changes,
    rank_best,
)
from gapath.kernels.lines import ONE_OBSTACLE, Ends
from gapath.kernels.rng import fill, high, low

MOST_RUNS = 1 << 18
"""Runs of one launch."""

MOST_SHARED = 48 << 10
"""Bytes of a map that a block reads from memory of its own."""


@lru_cache
def compiled(genes: int, shared: bool, whole: Callable[[int], int]) -> Any:
    """Give the kernel for chromosomes of a length.

    Parameters
    ----------
    genes : int
        2 k.
    shared : bool
        Read the map from a copy that each block makes.
    whole : type
        Whole numbers in which parents are mixed, int32 or int64.

    Returns
    -------
    callable
        The kernel, which is compiled when it is first launched.
    """
    inner, drawn = genes - 4, genes - 3
    two = whole(2)

    @jit
    def evolutions(
        flat: NDArray[np.int32],
        table: NDArray[np.int32],
        ends: NDArray[np.int32],
        rule: int,
        settings: NDArray[np.void],
        ways: NDArray[np.int32],
        limits: NDArray[np.int32],
        middle: NDArray[np.int32],
        first_changes: NDArray[np.int32],
        changes: NDArray[np.int32],
        streams: NDArray[np.uint64],
        counter: NDArray[np.int64],
        population: NDArray[np.int32],
        keys: NDArray[np.int64],
        best: NDArray[np.int32],
        epochs: NDArray[np.int64],
        ended: NDArray[np.int64],
        chromosomes: NDArray[np.int32],
    ) -> None:
        fields = flat
        if shared:
            fields = cuda.shared.array(0, int32)
            for f in range(cuda.threadIdx.x, flat.shape[0], cuda.blockDim.x):
                fields[f] = flat[f]
            cuda.syncthreads()
        lane = cuda.grid(1)
        setting = settings[0]
        size, selected = keys.shape[1], best.shape[0]
        numerator = whole(setting["mixing_numerator"])
        denominator = whole(setting["mixing_denominator"])
        rest = whole(denominator - numerator)
        row = cuda.local.array(genes, np.int32)
        words = cuda.local.array(drawn, np.uint64)
        stream = cuda.local.array(4, np.uint64)
        for g in range(2):
            row[g], row[genes - 2 + g] = ends[g], ends[2 + g]
        epoch, old = 0, 0
        run = cuda.atomic.add(counter, 0, 1)
        while run < streams.shape[0]:
            new = 1 - old
            if epoch == 0:
                for i in range(4):
                    stream[i] = streams[run, i]
            for i in range(size):
                if epoch > 0 and i < selected:
                    parent = best[i, lane]
                    for g in range(inner):
                        population[new, i, g, lane] = population[old, parent, g, lane]
                    keys[new, i, lane] = keys[old, parent, lane]
                    continue
                if epoch == 0:
                    fill(stream, words[1:])
                    part = 3 * i // size
                    shift, threshold = 0, setting["line_jitter_threshold"]
                    if part > 0:
                        shift, threshold = 32, np.uint64(1 << 32)
                    for g in range(2, genes - 2):
                        gene = np.int64(middle[part, g])
                        row[g] = changed(
                            gene, g, words[g - 1], shift, threshold, first_changes[part], limits
                        )
                else:
                    fill(stream, words)
                    a = best[high(words[0], selected), lane]
                    b = best[low(words[0], selected), lane]
                    if keys[old, a, lane] >= keys[old, b, lane]:
                        a, b = b, a
                    threshold = setting["mutation_threshold"]
                    for g in range(2, genes - 2):
                        mixed = whole(numerator * population[old, a, g - 2, lane])
                        mixed = whole(mixed + whole(rest * population[old, b, g - 2, lane]))
                        mixed = whole(whole(two * mixed) + denominator)
                        gene = np.int64(mixed // whole(two * denominator))
                        row[g] = changed(gene, g, words[g - 1], 0, threshold, changes, limits)
                for g in range(inner):
                    population[new, i, g, lane] = row[g + 2]
                keys[new, i, lane] = fitness(table, fields, row, ways, rule)
            rank_best(keys[new, :, lane], best[:, lane])
            epoch += 1
            old = new
            fittest = best[0, lane]
            key = keys[new, fittest, lane]
            feasible = key < ONE_OBSTACLE and epoch >= setting["min_epochs"]
            if feasible or epoch == setting["max_epochs"]:
                epochs[run], ended[run] = epoch, key
                for g in range(2):
                    chromosomes[run, g], chromosomes[run, genes - 2 + g] = ends[g], ends[2 + g]
                for g in range(inner):
                    chromosomes[run, g + 2] = population[new, fittest, g, lane]
                for i in range(4):
                    streams[run, i] = stream[i]
                run = cuda.atomic.add(counter, 0, 1)
                epoch = 0

    return evolutions


def outcomes(
    card: Card,
    table: NDArray[np.int32],
    ends: tuple[int, int, int, int],
    rule: int,
    settings: NDArray[np.void],
    fractions: tuple[NDArray[np.int64], NDArray[np.int64]],
    streams: NDArray[np.uint64],
) -> Outcomes:
    """Run the genetic algorithm once for each stream, at most `MOST_RUNS` in a launch.

    Parameters
    ----------
    card : Card
        What computes.
    table, ends, rule, settings, streams
        As of `gapath.kernels.kg18.evolution.Evolve`.
    fractions
        `gapath.kernels.kg18.bspline.fractions`.

    Returns
    -------
    Outcomes
        What each run comes to.

    Raises
    ------
    InputError
        If one population does not fit the GPU's memory.
    """
    (rows, cols), setting = table.shape, settings[0]
    genes, size = 2 * fractions[0].shape[1], int(setting["population"])
    limits = np.zeros((2, genes), dtype=np.int32)
    gene_limits(limits, Ends(*ends), genes, rows, cols, setting["clip_to_map"])
    middle = np.zeros((3, genes), dtype=np.int32)
    first_changes = np.zeros((3, 2, genes), dtype=np.int32)
    ranges = (int(setting[name]) for name in InitialPopulation._fields)
    initial_changes(
        middle, first_changes, Ends(*ends), genes, rows, cols, InitialPopulation(*ranges)
    )
    half = min(rows, cols) // 2  # KG18 Sec. 3.7
    changes = np.repeat(np.array([[2 * half + 1], [half]], dtype=np.int32), genes, axis=1)
    given = (np.array(ends, dtype=np.int32), settings, way_rows(*fractions), limits, middle)
    ends_, settings_, *known = map(cuda.to_device, (*given, first_changes, changes))
    flat = cuda.to_device(table.reshape(-1))
    read = (flat, flat.reshape(rows, cols), ends_, rule, settings_, *known)

    threads, blocks = _threads(card, size, genes, len(streams))
    total = threads * blocks
    memory = (
        cuda.device_array((2, size, genes - 4, total), np.int32),
        cuda.device_array((2, size, total), np.int64),
        cuda.device_array((size // 4, total), np.int32),
    )
    shared = table.nbytes if table.nbytes <= MOST_SHARED else 0
    whole = np.int32 if setting["mixing_denominator"] <= MOST_PARTS else np.int64
    kernel = compiled(genes, shared > 0, whole)[blocks, threads, 0, shared]
    found = Outcomes(
        np.empty(len(streams), dtype=np.int64),
        np.empty(len(streams), dtype=np.int64),
        np.empty((len(streams), genes), dtype=np.int32),
    )
    for begin in range(0, len(streams), MOST_RUNS):
        piece = slice(begin, begin + MOST_RUNS)
        counter = cuda.to_device(np.zeros(1, dtype=np.int64))
        states = cuda.to_device(streams[piece])
        written = [cuda.device_array_like(each[piece]) for each in found]
        kernel(*read, states, counter, *memory, *written)
        streams[piece] = states.copy_to_host()
        epochs, keys, chromosomes = (each.copy_to_host() for each in written)
        found.epochs[piece], found.keys[piece] = epochs, keys
        found.chromosomes[piece] = chromosomes
    return found


def _threads(card: Card, size: int, genes: int, runs: int) -> tuple[int, int]:
    """Give threads a block, and blocks: as many as there are runs, if memory has room for them."""
    each = size * 2 * (4 * (genes - 4) + 8) + 4 * (size // 4)
    room = card.memory // each
    good = f"a population that fits {card.memory} bytes of the GPU's memory"
    require(room > 0, "planner.population", size, good)
    threads = min(card.threads, room, runs)
    return threads, min(card.blocks, room // threads, -(-runs // threads))
