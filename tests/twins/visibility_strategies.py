"""Hypothesis strategies and helpers for tests of M22's planners."""

import numpy as np
from hypothesis import strategies as st

from gapath.components import build
from gapath.discovery import yaml_values
from gapath.grid import GridMap
from gapath.planners import inflated, visibility_ga, visibility_search
from gapath.problem import CornerCutting, Problem


def make(name, **values):
    """A planner of conf/planner with some values replaced."""
    return build("planner", yaml_values("planner", name) | values, "planner")


CLEARANCE = {
    "robot_radius": 1,
    "radius_unit": "pixels",
    "radius_tolerance": 0.1,
    "element": "reach",
    "threshold": "otsu",
}
GRAPH = {"keypoints": "axes", "corner_tolerance": 2.0, "push_out": True, "resize": False}
GENERATIONS = {
    "ga2_profile": "v64",
    "genes": "obstacles",
    "population": 30,
    "max_epochs": 40,
    "max_stagnation": 20,
    "mutation_probability": 0.1,
    "elite_portion": 0.01,
    "parents_portion": 0.3,
    "crossover_probability": 0.5,
}


def ga(**values):
    """M22's planner, small and for a small robot; the rest is Table I's."""
    return visibility_ga.Planner(**{**CLEARANCE, **GRAPH, **GENERATIONS, **values})


def search(informed=True, **values):
    return visibility_search.Planner(**{**CLEARANCE, **GRAPH, "informed": informed, **values})


def inflated_by(planner, **values):
    return inflated.Planner(**{**CLEARANCE, "planner": planner, **values})


def picture_of(text):
    """A picture of lines of text: # is an obstacle."""
    return np.array([[c == "#" for c in line] for line in text.split()], dtype=np.bool_)


def map_of(picture, **values):
    return GridMap("picture", np.where(picture, 1.0, 0.5), **values)


def draw_picture(random, rows, cols, count, most):
    """So many rectangles and discs, which may touch one another and the border."""
    picture = np.zeros((rows, cols), dtype=np.bool_)
    y, x = np.ogrid[:rows, :cols]
    for _ in range(count):
        u, v = random.integers(0, cols), random.integers(0, rows)
        w, h = random.integers(0, most + 1, 2)
        if random.random() < 0.5:
            picture |= (np.abs(x - u) <= w) & (np.abs(y - v) <= h)
        else:
            picture |= (x - u) ** 2 + (y - v) ** 2 <= w * w
    return picture


@st.composite
def pictures(draw, most=40, least=2):
    """Small pictures: none, a few or many obstacles, single pixels among them."""
    rows, cols = draw(st.integers(least, most)), draw(st.integers(least, most))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    if draw(st.booleans()):
        return random.random((rows, cols)) < draw(st.sampled_from([0.02, 0.1, 0.5]))
    return draw_picture(random, rows, cols, draw(st.integers(0, 6)), draw(st.integers(0, 6)))


@st.composite
def picture_problems(draw, most=40, least=2, rules=tuple(CornerCutting)):
    """Problems on small pictures: start and target are free, the robot may not fit there."""
    picture = draw(pictures(most, least))
    rows, cols = picture.shape
    places = st.tuples(st.integers(0, cols - 1), st.integers(0, rows - 1))
    start, target = draw(places), draw(places)
    picture[start[1], start[0]] = picture[target[1], target[0]] = False
    return Problem(map_of(picture), start, target, draw(st.sampled_from(rules)))
