"""KG18's algorithm jitted as one would write it from the paper: the kernel to beat.

Floating-point way points and DDA, a bounds test at every field, every individual evaluated
in every epoch, a full sort. It takes the same random words as `gapath.kernels.kg18.evolution`,
so epochs, chromosomes and costs must be identical.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.lines import KEY_BITS, ONE_OBSTACLE, Ends
from gapath.kernels.rng import Stream, fill, happens, high, low
from gapath.kernels.units import OBSTACLE

TIE = 1e-6
"""Lifts a DDA position that rounding left just below a tie; no other lies so near to one."""


@kernel
def clip(gene: int, side: int, clip_to_map: bool) -> int:
    return min(max(gene, 0), side - 1) if clip_to_map else gene


@kernel
def initialise(
    population: NDArray[np.int32],
    ends: Ends,
    sides: tuple[int, int],
    settings: np.void,
    words: NDArray[np.uint64],
) -> None:
    """Fill the initial population, one third each in three ways (Sec. 3.3)."""
    size, genes = population.shape
    start, target = (ends.start_x, ends.start_y), (ends.target_x, ends.target_y)
    reach = settings["neighbourhood"]
    w = 0
    for i in range(size):
        population[i, 0], population[i, 1] = start
        population[i, genes - 2], population[i, genes - 1] = target
        for g in range(2, genes - 2):
            axis, part = g % 2, 3 * i // size
            if part == 0:
                line = start[axis] + (g // 2) * (target[axis] - start[axis]) / (genes // 2 - 1)
                gene = np.int64(np.floor(line + 0.5 + TIE))
                if happens(words[w], settings["line_jitter_threshold"]):
                    gene += low(words[w], 2 * settings["line_jitter"] + 1) - settings["line_jitter"]
            elif part == 1:
                gene = start[axis] + high(words[w], 2 * reach + 1) - reach
            else:
                gene = settings["margin"] + high(words[w], sides[axis] - 2 * settings["margin"])
            population[i, g] = clip(gene, sides[axis], settings["clip_to_map"])
            w += 1


@kernel
def fitness(
    table: NDArray[np.int32], chromosome: NDArray[np.int32], basis: NDArray[np.float64]
) -> int:
    """Sum the weights of the path's fields, obstacles counted apart (eq. (5))."""
    rows, cols = table.shape
    obstacles, cost = 0, np.int64(0)
    x0 = y0 = 0.0
    for j in range(basis.shape[0]):
        bx = by = 0.0
        for i in range(basis.shape[1]):
            bx += basis[j, i] * chromosome[2 * i]
            by += basis[j, i] * chromosome[2 * i + 1]
        x1, y1 = np.floor(bx + 0.5), np.floor(by + 0.5)
        if j == 0:  # the start field counts once
            n, x, y, dx, dy = 1, x1, y1, 0.0, 0.0
        else:
            n = np.int64(max(abs(x1 - x0), abs(y1 - y0)))
            dx, dy = (x1 - x0) / max(n, 1), (y1 - y0) / max(n, 1)
            x, y = x0 + dx, y0 + dy
        for _ in range(n):
            field_x, field_y = np.int64(np.floor(x + 0.5 + TIE)), np.int64(np.floor(y + 0.5 + TIE))
            if 0 <= field_x < cols and 0 <= field_y < rows and table[field_y, field_x] < OBSTACLE:
                cost += table[field_y, field_x]
            else:
                obstacles += 1
            x, y = x + dx, y + dy
        x0, y0 = x1, y1
    return (obstacles << KEY_BITS) + cost


@kernel
def evolve(
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
    """Do what `gapath.kernels.kg18.evolution.evolve` does, by the rule ALLOW only."""
    for run in range(streams.shape[0]):
        epochs[run] = evolve_once(
            table, ends, settings, weights, streams[run], history[run], chromosomes[run]
        )


@kernel
def evolve_once(
    table: NDArray[np.int32],
    ends: tuple[int, int, int, int],
    settings: NDArray[np.void],
    weights: NDArray[np.float64],
    stream: Stream,
    history: NDArray[np.void],
    chromosomes: NDArray[np.int32],
) -> int:
    """Run the genetic algorithm once; give the epochs taken."""
    rows, cols = table.shape
    setting = settings[0]
    size, genes = setting["population"], chromosomes.shape[1]
    inner, selected = genes - 4, size // 4
    share = setting["mixing_numerator"] / setting["mixing_denominator"]
    half = min(rows, cols) // 2

    population = np.empty((size, genes), dtype=np.int32)
    keys = np.empty(size, dtype=np.int64)
    words = np.empty(size * inner, dtype=np.uint64)
    fill(stream, words)
    initialise(population, Ends(*ends), (cols, rows), setting, words)
    words = np.empty((size - selected) * (inner + 1), dtype=np.uint64)
    epoch = 0
    while True:
        for i in range(size):
            keys[i] = fitness(table, population[i], weights)
        order = np.argsort(keys, kind="mergesort")  # stable: ties go to the lower index
        history["key"][epoch] = keys[order[0]]
        history["obstacle_sum"][epoch] = (keys >> KEY_BITS).sum()
        history["cost_sum"][epoch] = (keys & (ONE_OBSTACLE - 1)).sum()
        chromosomes[epoch] = population[order[0]]
        epoch += 1
        feasible = keys[order[0]] < ONE_OBSTACLE
        if (feasible and epoch >= setting["min_epochs"]) or epoch == setting["max_epochs"]:
            break
        following = np.empty_like(population)
        following[:selected] = population[order[:selected]]
        fill(stream, words)
        w = 0
        for i in range(selected, size):
            a, b = order[high(words[w], selected)], order[low(words[w], selected)]
            w += 1
            if keys[a] >= keys[b]:
                a, b = b, a
            for g in range(genes):  # eq. (6), rounded to nearest
                mixed = share * population[a, g] + (1.0 - share) * population[b, g]
                gene = np.int64(np.floor(mixed + 0.5))
                if 2 <= g < genes - 2:
                    if happens(words[w], setting["mutation_threshold"]):
                        gene += low(words[w], 2 * half + 1) - half
                    w += 1
                    gene = clip(gene, (cols, rows)[g % 2], setting["clip_to_map"])
                following[i, g] = gene
        population = following
    return epoch
