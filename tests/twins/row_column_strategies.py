"""Hypothesis strategies and helpers for tests of S04's genotype."""

import numpy as np
from hypothesis import strategies as st

from gapath.kernels.s04.genotype import Chromosomes, flatten
from gapath.planners.row_column_ga import Planner

GENOTYPES = {"geisler": (False, 0), "hermanu": (True, 0), "sedighi": (True, 2)}
"""Whether the flag may be 1, and how many switches may change the mode."""


def planner(**values):
    """S04's planner, small; L and T are the paper's."""
    settings = {
        "column_wise": True,
        "switches": 2,
        "population": 20,
        "max_epochs": 10,
        "stop_when_feasible": False,
        "crossover_probability": 0.9,
        "mutation_probability": 0.01,
        "length_weight": 1.0,
        "turns_weight": 2.0,
        "vln": 100_000.0,
        "pad_to_square": False,
    }
    return Planner(**{**settings, **values})


@st.composite
def planners(draw):
    """S04's planner with any of the genotypes and any reasonable settings."""
    column_wise, switches = draw(st.sampled_from([*GENOTYPES.values(), (True, 1)]))
    length_weight = draw(st.sampled_from([1.0, 0.0, 0.3, 1e6]))
    return planner(
        column_wise=column_wise,
        switches=switches,
        population=draw(st.integers(2, 20)),
        max_epochs=draw(st.integers(1, 8)),
        stop_when_feasible=draw(st.booleans()),
        crossover_probability=draw(st.sampled_from([0.9, 0.0, 1.0, 0.5])),
        mutation_probability=draw(st.sampled_from([0.01, 0.0, 1.0, 0.2])),
        length_weight=length_weight,
        turns_weight=draw(st.sampled_from([2.0, 0.7] + [0.0] * (length_weight > 0))),
    )


def draw_chromosomes(random, size, n):
    """Any chromosomes, their switches often equal or without effect."""
    switch = random.integers(0, n, (2, size))
    switch[:, random.random(size) < 0.2] = n - 1
    equal = random.random(size) < 0.2
    switch[1, equal] = switch[0, equal]
    genes = (
        random.integers(0, 2, size),
        random.integers(0, n, (n, size)),
        random.integers(0, 2, (n - 1, size)),
        switch,
    )
    return Chromosomes(*(part.astype(np.int32) for part in genes))


def as_rows(chromosomes):
    """Chromosomes one by one, as planners give them."""
    n, size = chromosomes.location.shape
    rows = np.empty((size, 2 * n + 2), dtype=np.int32)
    for individual, row in enumerate(rows):
        flatten(chromosomes, individual, row)
    return rows
