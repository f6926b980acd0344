"""Hypothesis strategies shared by the tests."""

import numpy as np
from hypothesis import strategies as st

from gapath.grid import GridMap
from gapath.planners.bspline_ga import Planner
from gapath.problem import CornerCutting, Problem

RULES = [rule.name.lower() for rule in CornerCutting]


@st.composite
def weights(draw, most=24, least=2):
    """Small maps: any weights, some obstacles."""
    rows, cols = draw(st.integers(least, most)), draw(st.integers(least, most))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    values = random.choice([0.0, 0.25, 0.5, 0.7, 1 / 3, 0.999], (rows, cols))
    values[random.random((rows, cols)) < draw(st.sampled_from([0.0, 0.1, 0.3, 0.5]))] = 1.0
    return values


@st.composite
def problems(draw, most=24, least=2):
    """Problems on small maps; the target may be walled in."""
    values = draw(weights(most, least))
    rows, cols = values.shape
    places = st.tuples(st.integers(0, cols - 1), st.integers(0, rows - 1))
    start, target = draw(places), draw(places)
    values[start[1], start[0]] = values[target[1], target[0]] = draw(st.sampled_from([0.0, 0.5]))
    rule = draw(st.sampled_from(list(CornerCutting)))
    return Problem(GridMap("random", values), start, target, rule)


def planner(**values):
    """KG18's planner with the paper's values, but for those given."""
    settings = {
        "population": 30,
        "control_points": 4,
        "min_epochs": 1,
        "max_epochs": 500,
        "way_points": 5,
        "sampling": "curve",
        "mixing": 0.8,
        "mutation_probability": 0.4,
        "line_jitter": 12,
        "line_jitter_probability": 0.5,
        "neighbourhood": 12,
        "margin": 0,
        "clip_to_map": False,
        "vln": 100_000.0,
    }
    return Planner(**{**settings, **values})


@st.composite
def planners(draw):
    """KG18's planner with any reasonable settings."""
    epochs = draw(st.integers(1, 12))
    return planner(
        population=draw(st.integers(4, 24)),
        control_points=draw(st.integers(3, 7)),
        min_epochs=draw(st.integers(1, epochs)),
        max_epochs=epochs,
        way_points=draw(st.integers(2, 7)),
        sampling=draw(st.sampled_from(["curve", "span"])),
        mixing=draw(st.sampled_from([0.8, 0.5, 0.75, 1.0, 0.0, 0.333])),
        mutation_probability=draw(st.sampled_from([0.4, 0.0, 1.0, 0.1])),
        line_jitter=draw(st.integers(0, 15)),
        line_jitter_probability=draw(st.sampled_from([0.5, 0.0, 1.0])),
        neighbourhood=draw(st.sampled_from([0, 7, 15, 65536])),
        margin=draw(st.integers(0, 15)),
        clip_to_map=draw(st.booleans()),
    )
